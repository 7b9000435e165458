//! Numbers as engineers write them: as many digits as the uncertainty allows, in a unit of fitting size.

use bench::safety::Proportion;
use bench::study::Parameter;

/// Slower than this whole revolutions a minute say too little.
const SLOW_RPM: f64 = 5.0;

/// What stands where a number is NaN or infinite.
pub const NOT_KNOWN: &str = "not known";

/// An estimate in pieces, all with the same unit and the digits that the uncertainty allows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Digits {
    /// The estimate.
    pub value: String,
    /// Half of the 95 % interval: `± 12`; where the interval is lopsided, its two arms: `+28 −12`.
    pub spread: String,
    /// The bounds of the interval, `2426 … 2450`.
    pub interval: String,
    /// Power of ten, if there is one, and unit: `Nm/rad`, `·10⁻⁵ Nm`.
    pub unit: String,
}

/// The estimate in pieces; `None` where it or its interval is not a finite number.
pub fn digits(parameter: &Parameter) -> Option<Digits> {
    let (value, (low, high)) = (parameter.value, parameter.interval);
    let half_width = (high - low) / 2.0;
    if !(value.is_finite() && half_width.is_finite() && half_width > 0.0) {
        return None;
    }
    let scale = Scale::fitting(value.abs().max(half_width), &parameter.unit);
    let decimals = decimals_for(half_width / scale.divisor);
    let digits = |number: f64| fixed(number / scale.divisor, decimals);
    let (below, above) = (value - low, high - value);
    let spread = match (above - below).abs() > 0.2 * half_width {
        true => format!("+{} −{}", digits(above), digits(below)),
        false => format!("± {}", digits(half_width)),
    };
    let interval = format!("{} … {}", digits(low), digits(high));
    Some(Digits { value: digits(value), spread, interval, unit: scale.suffix() })
}

/// The estimate with half of its 95 % interval, e.g. `2438 ± 12 Nm/rad`; with both arms where the interval is lopsided,
/// e.g. `2438 +52 −28 Nm/rad`.
pub fn parameter(parameter: &Parameter) -> String {
    match digits(parameter) {
        Some(Digits { value, spread, unit, .. }) => with_unit(format!("{value} {spread}"), &unit),
        None if is_fixed(parameter) => format!("{}, without uncertainty", measure(parameter.value, &parameter.unit)),
        None => plus_minus(parameter.value, f64::NAN, &parameter.unit),
    }
}

/// The bounds of the 95 % interval with their unit, e.g. `2426 … 2450 Nm/rad`.
pub fn interval(parameter: &Parameter) -> String {
    match digits(parameter) {
        Some(Digits { interval, unit, .. }) => with_unit(interval, &unit),
        None if is_fixed(parameter) => "–".to_owned(),
        None => NOT_KNOWN.to_owned(),
    }
}

/// Whether the parameter has no uncertainty at all: it was given to the estimate, or follows exactly from noise-free data.
fn is_fixed(parameter: &Parameter) -> bool {
    let (low, high) = parameter.interval;
    parameter.value.is_finite() && parameter.standard_error == 0.0 && low == high
}

/// A value with an uncertainty, the latter to two significant digits and the value to the same place:
/// `2438 ± 12 Nm/rad`, `1.021 ± 0.024 ms`, `(1.84 ± 0.31)·10⁻⁵ Nm`.
pub fn plus_minus(value: f64, uncertainty: f64, unit: &str) -> String {
    if !value.is_finite() {
        return NOT_KNOWN.to_owned();
    }
    if !(uncertainty.is_finite() && uncertainty > 0.0) {
        return format!("{}, uncertainty {NOT_KNOWN}", measure(value, unit));
    }
    let scale = Scale::fitting(value.abs().max(uncertainty), unit);
    let (value, uncertainty) = (value / scale.divisor, uncertainty / scale.divisor);
    let decimals = decimals_for(uncertainty);
    with_unit(format!("{} ± {}", fixed(value, decimals), fixed(uncertainty, decimals)), &scale.suffix())
}

/// A value to the decimal place to which a number with this uncertainty is written.
pub fn to_place_of(value: f64, uncertainty: f64) -> String {
    if value.is_finite() { fixed(value, decimals_for(uncertainty)) } else { NOT_KNOWN.to_owned() }
}

/// The middle of some values, of an even number the mean of both in the middle; NaN of none.
pub(crate) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match (sorted.len(), sorted.len() / 2) {
        (0, _) => f64::NAN,
        (count, middle) if count % 2 == 0 => 0.5 * (sorted[middle - 1] + sorted[middle]),
        (_, middle) => sorted[middle],
    }
}

/// A value without uncertainty, to four significant digits, with its unit.
pub fn measure(value: f64, unit: &str) -> String {
    significant_with_unit(value, 4, unit)
}

/// A value to `digits` significant digits, with its unit in a fitting size.
pub fn significant_with_unit(value: f64, digits: i32, unit: &str) -> String {
    if !value.is_finite() {
        return NOT_KNOWN.to_owned();
    }
    let scale = Scale::fitting(value.abs(), unit);
    let (number, suffix) = (significant(value / scale.divisor, digits), scale.suffix());
    if suffix.starts_with('·') { number + &suffix } else { with_unit(number, &suffix) }
}

/// A value to `digits` significant digits; zeros behind the point that say nothing are dropped.
pub fn significant(value: f64, digits: i32) -> String {
    if !value.is_finite() {
        return NOT_KNOWN.to_owned();
    }
    let exponent = exponent_of(value).unwrap_or(0);
    let text = fixed(value, digits - 1 - exponent);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A share of one as a percentage, e.g. `0.4 %`; a share above zero is never written as zero.
pub fn share(share: f64) -> String {
    match share {
        s if !(100.0 * s).is_finite() => NOT_KNOWN.to_owned(),
        s if s > 0.0 && s < 0.001 => "less than 0.1 %".to_owned(),
        s => format!("{} %", fixed(100.0 * s, if s < 0.1 { 1 } else { 0 })),
    }
}

/// A share with its 95 % interval, e.g. `94 % (89 … 97 %)`.
pub fn proportion(of: &Proportion) -> String {
    let (low, high) = (share(of.lower), share(of.upper));
    format!("{} ({} … {high})", share(of.estimate), low.trim_end_matches(" %"))
}

/// A fit in per cent, one digit behind the point; two where a fit near 100 % would otherwise look perfect.
pub fn fit(fit_percent: f64) -> String {
    match fit_percent {
        f if !f.is_finite() => NOT_KNOWN.to_owned(),
        f if f >= 99.0 => format!("{} %", fixed(f, 2)),
        f => format!("{} %", fixed(f, 1)),
    }
}

/// A moment in a recording, e.g. `12.35 s`.
pub fn time(seconds: f64) -> String {
    if seconds.is_finite() { format!("{} s", fixed(seconds, 2)) } else { format!("a time {NOT_KNOWN}") }
}

/// A span of time, to three digits: `0.4 ms`, `12.3 s`, `12 min 5 s`.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if !s.is_finite() => NOT_KNOWN.to_owned(),
        s if s >= 120.0 => {
            let whole = s.round();
            format!("{} min {} s", fixed((whole / 60.0).floor(), 0), fixed(whole % 60.0, 0))
        }
        s => significant_with_unit(s, 3, "s"),
    }
}

/// A speed in revolutions per minute from rad/s.
pub fn rpm(rad_s: f64) -> String {
    let value = rad_s * 30.0 / std::f64::consts::PI;
    let decimals = if value != 0.0 && value.abs() < SLOW_RPM { 2 } else { 0 };
    if value.is_finite() { format!("{} rpm", fixed(value, decimals)) } else { NOT_KNOWN.to_owned() }
}

/// Several numbers with what they share: a unit behind them, or a power of ten behind brackets.
fn with_unit(numbers: String, suffix: &str) -> String {
    match suffix {
        "" => numbers,
        power if power.starts_with('·') => format!("({numbers}){power}"),
        unit => format!("{numbers} {unit}"),
    }
}

/// A unit of fitting size, or a power of ten, for one number and its uncertainty.
struct Scale {
    divisor: f64,
    power: Option<i32>,
    unit: String,
}

impl Scale {
    fn fitting(magnitude: f64, unit: &str) -> Self {
        let plain = |divisor: f64, unit: &str| Scale { divisor, power: None, unit: unit.to_owned() };
        match exponent_of(magnitude) {
            Some(_) if unit == "s" && magnitude < 2e-4 => plain(1e-6, "µs"),
            Some(_) if unit == "s" && magnitude < 0.2 => plain(1e-3, "ms"),
            Some(exponent) if !(-4..6).contains(&exponent) => {
                Scale { divisor: 10f64.powi(exponent), power: Some(exponent), unit: unit.to_owned() }
            }
            _ => plain(1.0, unit),
        }
    }

    /// What stands behind the number: a power of ten, a unit, both or nothing.
    fn suffix(&self) -> String {
        let unit = if self.unit == "1" { "" } else { &self.unit };
        match self.power {
            Some(power) => format!("·10{} {unit}", superscript(power)).trim_end().to_owned(),
            None => unit.to_owned(),
        }
    }
}

/// Decimals that show an uncertainty to two significant digits; negative left of the point.
fn decimals_for(uncertainty: f64) -> i32 {
    let rounded = format!("{uncertainty:.1e}").parse().unwrap_or(uncertainty);
    exponent_of(rounded).map_or(3, |exponent| 1 - exponent)
}

/// Floor of log10 of a magnitude; `None` for what is not finite, and for zero and all that is as good as zero.
fn exponent_of(value: f64) -> Option<i32> {
    let exponent = value.abs().log10().floor();
    (exponent.is_finite() && exponent > -300.0).then_some(exponent as i32)
}

/// The value rounded to a decimal place, with a true minus sign and never as minus zero.
fn fixed(value: f64, decimals: i32) -> String {
    let text = if decimals >= 0 {
        format!("{value:.*}", decimals.min(12) as usize)
    } else {
        let step = 10f64.powi(-decimals);
        format!("{:.0}", (value / step).round() * step)
    };
    match text.strip_prefix('-') {
        Some(digits) if digits.chars().all(|c| c == '0' || c == '.') => digits.to_owned(),
        Some(digits) => format!("−{digits}"),
        None => text,
    }
}

fn superscript(power: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    power
        .to_string()
        .chars()
        .map(|c| c.to_digit(10).and_then(|d| DIGITS.get(d as usize)).copied().unwrap_or('⁻'))
        .collect()
}
