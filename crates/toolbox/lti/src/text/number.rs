//! Numbers as text.

/// Significant digits of a number whose error is not known.
const DIGITS: i32 = 5;
/// Significant digits of a standard error.
const ERROR_DIGITS: i32 = 2;
/// Powers of ten between which numbers are written without an exponent.
const PLAIN: std::ops::Range<i32> = -4..6;

/// A number with five significant digits, trailing zeros dropped; with an exponent where it is very large or small.
///
/// # Example
/// ```
/// use lti::text::number;
/// assert_eq!([number(0.5), number(-1234.56), number(1.5e-7)], ["0.5", "−1234.6", "1.5e−7"]);
/// ```
#[must_use]
pub fn number(value: f64) -> String {
    let Some(power) = power_of_ten(value) else { return special(value) };
    if !PLAIN.contains(&power) {
        return exponential(value, (DIGITS - 1) as usize);
    }
    let decimals = (DIGITS - 1 - power).max(0) as usize;
    minus(trimmed(&format!("{value:.decimals$}")))
}

/// A number and its standard error, both down to the second digit of the error, joined by ` ± `. An error of zero is
/// that of a parameter that was held.
///
/// # Example
/// ```
/// use lti::text::with_error;
/// assert_eq!(with_error(1.499_43, 0.003_12), "1.4994 ± 0.0031");
/// assert_eq!(with_error(2.0, 0.0), "2 (fixed)");
/// ```
#[must_use]
pub fn with_error(value: f64, error: f64) -> String {
    let (value, error) = digits_of_both(value, error);
    error.map_or_else(|| format!("{value} (fixed)"), |error| format!("{value} ± {error}"))
}

/// A number to the second digit of its error, and that error; no error where it is zero.
pub(crate) fn digits_of_both(value: f64, error: f64) -> (String, Option<String>) {
    let Some(power) = power_of_ten(error) else {
        let error = if error == 0.0 { None } else { Some(special(error)) };
        return (number(value), error);
    };
    let last = power - ERROR_DIGITS + 1;
    let largest = power_of_ten(value).map_or(power, |p| p.max(power));
    if !PLAIN.contains(&largest) || largest - last > 12 {
        let digits = |v: f64| power_of_ten(v).map_or(0, |p| (p - last).clamp(0, 12)) as usize;
        return (exponential(value, digits(value)), Some(exponential(error, digits(error))));
    }
    let decimals = (-last).max(0) as usize;
    (minus(format!("{value:.decimals$}")), Some(format!("{error:.decimals$}")))
}

/// The exponent that scientific notation gives a number; `None` for zero and what is not finite.
fn power_of_ten(value: f64) -> Option<i32> {
    (value != 0.0 && value.is_finite()).then(|| value.abs().log10().floor() as i32)
}

fn special(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        v if v.is_nan() => "not known".to_owned(),
        v if v > 0.0 => "∞".to_owned(),
        _ => "−∞".to_owned(),
    }
}

fn exponential(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    minus(format!("{}e{exponent}", trimmed(mantissa)))
}

/// Without zeros at the end of its decimals.
fn trimmed(text: &str) -> String {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text.to_owned() }
}

fn minus(text: impl Into<String>) -> String {
    text.into().replace('-', "−")
}
