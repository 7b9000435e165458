//! Runs of samples that are alike.

use std::ops::Range;

/// Runs of indices below `count`, each as long as it goes, at all of which `wanted` holds.
///
/// # Example
/// ```
/// let x = [0.0, 2.0, 3.0, 0.0, 1.0];
/// assert!(signal::runs(x.len(), |i| x[i] > 0.0).eq([1..3, 4..5]));
/// ```
pub fn runs(count: usize, wanted: impl Fn(usize) -> bool) -> impl Iterator<Item = Range<usize>> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let start = (at..count).find(|i| wanted(*i))?;
        at = (start..count).find(|i| !wanted(*i)).unwrap_or(count);
        Some(start..at)
    })
}
