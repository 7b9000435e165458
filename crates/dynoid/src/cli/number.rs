//! Numbers on the command line.

use std::ops::RangeInclusive;

/// Benches that an answer rests on: of 72 that all keep everything, the 95 % interval of the share begins at 95 %.
const BENCHES: RangeInclusive<u32> = 72..=100_000;

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

/// The seed of a random sequence.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| format!("give a whole number from 0 to {}", u64::MAX))
}

/// How many benches an answer rests on.
pub(super) fn benches(text: &str) -> Result<u32, String> {
    let number = text.trim().parse().ok().filter(|number| BENCHES.contains(number));
    number.ok_or_else(|| {
        format!(
            "give a whole number from {} to {}; with fewer benches, even all of them do not show that 95 % would keep everything",
            BENCHES.start(),
            BENCHES.end()
        )
    })
}
