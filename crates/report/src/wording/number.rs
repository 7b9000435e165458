//! Numbers as engineers write them: as many digits as the uncertainty allows, in a unit of fitting size.

use bench::study::Parameter;

/// What stands where a number is NaN or infinite.
pub const NOT_KNOWN: &str = "not known";

/// The estimate with half of its 95 % interval, e.g. `2438 ± 12 Nm/rad`; the whole interval where it is lopsided, e.g.
/// `2438 (2410 … 2490) Nm/rad`.
pub fn parameter(parameter: &Parameter) -> String {
    let (low, high) = parameter.interval;
    let (below, above) = (parameter.value - low, high - parameter.value);
    let lopsided = below.is_finite() && above.is_finite() && (above - below).abs() > 0.1 * (above + below).abs();
    if lopsided { with_interval(parameter) } else { plus_minus(parameter.value, (high - low) / 2.0, &parameter.unit) }
}

/// The bounds of the 95 % interval with their unit, e.g. `2426 … 2450 Nm/rad`.
pub fn interval(parameter: &Parameter) -> String {
    let (low, high) = parameter.interval;
    if !(low.is_finite() && high.is_finite()) {
        return NOT_KNOWN.to_owned();
    }
    let scale = Scale::fitting(low.abs().max(high.abs()), &parameter.unit);
    if low == high {
        return measure(low, &parameter.unit);
    }
    let decimals = decimals_for((high - low) / 2.0 / scale.divisor);
    scale.finish(format!("{} … {}", fixed(low / scale.divisor, decimals), fixed(high / scale.divisor, decimals)), true)
}

/// A value with an uncertainty, the latter to two significant digits and the value to the same place:
/// `2438 ± 12 Nm/rad`, `1.021 ± 0.024 ms`, `(1.84 ± 0.31)·10⁻⁵ Nm`. Without any uncertainty, as noise-free data give it,
/// the value is said to be exact.
pub fn plus_minus(value: f64, uncertainty: f64, unit: &str) -> String {
    if !value.is_finite() {
        return NOT_KNOWN.to_owned();
    }
    if uncertainty == 0.0 {
        return format!("{}, exact", measure(value, unit));
    }
    if !(uncertainty.is_finite() && uncertainty > 0.0) {
        return format!("{}, uncertainty {NOT_KNOWN}", measure(value, unit));
    }
    let scale = Scale::fitting(value.abs().max(uncertainty), unit);
    let (value, uncertainty) = (value / scale.divisor, uncertainty / scale.divisor);
    let decimals = decimals_for(uncertainty);
    scale.finish(format!("{} ± {}", fixed(value, decimals), fixed(uncertainty, decimals)), true)
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
    scale.finish(significant(value / scale.divisor, digits), false)
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
        s if !s.is_finite() => NOT_KNOWN.to_owned(),
        s if s > 0.0 && s < 0.001 => "less than 0.1 %".to_owned(),
        s => format!("{} %", fixed(100.0 * s, if s < 0.1 { 1 } else { 0 })),
    }
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
    if value.is_finite() { format!("{} rpm", fixed(value, 0)) } else { NOT_KNOWN.to_owned() }
}

fn with_interval(parameter: &Parameter) -> String {
    let (low, high) = parameter.interval;
    let scale = Scale::fitting(low.abs().max(high.abs()), &parameter.unit);
    let decimals = decimals_for((high - low) / 2.0 / scale.divisor);
    let digits = |value: f64| fixed(value / scale.divisor, decimals);
    scale.finish(format!("{} ({} … {})", digits(parameter.value), digits(low), digits(high)), false)
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

    fn finish(&self, digits: String, compound: bool) -> String {
        let number = match self.power {
            Some(power) if compound => format!("({digits})·10{}", superscript(power)),
            Some(power) => format!("{digits}·10{}", superscript(power)),
            None => digits,
        };
        match self.unit.as_str() {
            "" | "1" => number,
            unit => format!("{number} {unit}"),
        }
    }
}

/// Decimals that show an uncertainty to two significant digits; negative left of the point.
fn decimals_for(uncertainty: f64) -> i32 {
    let rounded = format!("{uncertainty:.1e}").parse().unwrap_or(uncertainty);
    exponent_of(rounded).map_or(3, |exponent| 1 - exponent)
}

/// Floor of log10 of a magnitude; `None` for zero and what is not finite.
fn exponent_of(value: f64) -> Option<i32> {
    let exponent = value.abs().log10().floor();
    exponent.is_finite().then_some(exponent as i32)
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
