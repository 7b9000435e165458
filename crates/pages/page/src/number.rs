//! Numbers as engineers write them: as many digits as the uncertainty allows, in a unit of fitting size.

/// Slower than this whole revolutions a minute say too little.
const SLOW_RPM: f64 = 5.0;

/// Text where a number is NaN or infinite.
pub const NOT_KNOWN: &str = "not known";

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
pub fn share_within(estimate: f64, (low, high): (f64, f64)) -> String {
    let (low, high) = (share(low), share(high));
    format!("{} ({} … {high})", share(estimate), low.trim_end_matches(" %"))
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
pub(crate) fn with_unit(numbers: String, suffix: &str) -> String {
    match suffix {
        "" => numbers,
        power if power.starts_with('·') => format!("({numbers}){power}"),
        unit => format!("{numbers} {unit}"),
    }
}

/// A unit of fitting size, or a power of ten, for one number and its uncertainty.
pub(crate) struct Scale {
    pub(crate) divisor: f64,
    power: Option<i32>,
    unit: String,
}

impl Scale {
    pub(crate) fn fitting(magnitude: f64, unit: &str) -> Self {
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

    /// The text after the number: a power of ten, a unit, both or nothing.
    pub(crate) fn suffix(&self) -> String {
        let unit = if self.unit == "1" { "" } else { &self.unit };
        match self.power {
            Some(power) => format!("·10{} {unit}", superscript(power)).trim_end().to_owned(),
            None => unit.to_owned(),
        }
    }
}

/// Decimals that show an uncertainty to two significant digits; negative left of the point.
pub(crate) fn decimals_for(uncertainty: f64) -> i32 {
    let rounded = format!("{uncertainty:.1e}").parse().unwrap_or(uncertainty);
    exponent_of(rounded).map_or(3, |exponent| 1 - exponent)
}

/// Floor of log10 of a magnitude; `None` for what is not finite, and for zero and all that is as good as zero.
fn exponent_of(value: f64) -> Option<i32> {
    let exponent = value.abs().log10().floor();
    (exponent.is_finite() && exponent > -300.0).then_some(exponent as i32)
}

/// The value rounded to a decimal place, with a true minus sign and never as minus zero.
pub(crate) fn fixed(value: f64, decimals: i32) -> String {
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
