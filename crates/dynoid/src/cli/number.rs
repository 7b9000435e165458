//! Numbers on the command line.

/// A number that is finite.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    let number: Result<f64, _> = text.trim().parse();
    number.ok().filter(|number| number.is_finite()).ok_or_else(|| "give a number, such as 1.5".to_owned())
}

/// A number above zero.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|number| *number > 0.0).ok_or_else(|| "give a number above 0".to_owned())
}

/// A number that is zero or above.
pub(super) fn not_negative(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|number| *number >= 0.0).ok_or_else(|| "give a number that is 0 or above".to_owned())
}

/// A share of a whole.
pub(super) fn share(text: &str) -> Result<f64, String> {
    let inside = |number: &f64| *number > 0.0 && *number < 1.0;
    finite(text).ok().filter(inside).ok_or_else(|| "give a share between 0 and 1, such as 0.5".to_owned())
}

/// A count, or a number of samples.
pub(super) fn count(text: &str) -> Result<usize, String> {
    text.trim().parse().map_err(|_| "give a whole number, 0 or above".to_owned())
}
