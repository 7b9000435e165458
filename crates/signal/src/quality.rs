//! Damage visible in the samples alone: gaps of NaN, no variation, clipping, spikes.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::error::{SignalError, check_range};

/// What counts as damage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct QualityOptions {
    /// Shortest run at the smallest or largest value that counts as clipped; at least two.
    pub clip_run: usize,
    /// Samples on each side whose median a spike is held against; at least one.
    pub spike_half_window: usize,
    /// A spike departs from the local median by more than this many (robust) standard deviations of such departures.
    pub spike_threshold: f64,
    /// If more than this fraction of the samples would be spikes, the signal is like that, and only what is far beyond
    /// the rest is reported.
    pub spike_max_fraction: f64,
}

impl Default for QualityOptions {
    /// Runs of 5; medians over 7 samples; 10 standard deviations; at most 1 % of the samples.
    fn default() -> Self {
        Self { clip_run: 5, spike_half_window: 3, spike_threshold: 10.0, spike_max_fraction: 0.01 }
    }
}

/// What was found; every range is of sample indices, half open, in order.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Quality {
    /// Runs of NaN or infinite samples.
    pub non_finite: Vec<Range<usize>>,
    /// Whether all finite samples are equal (or there is none). Then nothing below is reported.
    pub constant: bool,
    /// Runs at the smallest value. A signal held at levels (a command) shows them too: it is for the caller to know.
    pub clipped_low: Vec<Range<usize>>,
    /// Runs at the largest value.
    pub clipped_high: Vec<Range<usize>>,
    /// Samples that stand out from their neighbours and are no step.
    pub spikes: Vec<usize>,
}

impl Quality {
    /// Whether nothing was found.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        !self.constant
            && self.non_finite.is_empty()
            && self.clipped_low.is_empty()
            && self.clipped_high.is_empty()
            && self.spikes.is_empty()
    }
}

/// Looks for damage in a series of samples.
///
/// # Errors
/// [`SignalError::Parameter`] for options outside their range.
///
/// # Example
/// ```
/// use signal::quality::{QualityOptions, check_quality};
/// let mut x: Vec<f64> = (0..100).map(|i| (0.3 * i as f64).sin()).collect();
/// x[40] = 25.0;
/// x[70] = f64::NAN;
/// let found = check_quality(&x, &QualityOptions::default())?;
/// assert_eq!((found.spikes, found.non_finite), (vec![40], vec![70..71]));
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// Spikes: Hampel, F. R. (1974), J. Am. Stat. Assoc. 69, 383–393 (median and median absolute deviation).
pub fn check_quality(x: &[f64], options: &QualityOptions) -> Result<Quality, SignalError> {
    check_range("clip_run", options.clip_run as f64, 2.0, f64::INFINITY)?;
    check_range("spike_half_window", options.spike_half_window as f64, 1.0, f64::INFINITY)?;
    check_range("spike_threshold", options.spike_threshold, 0.0, f64::INFINITY)?;
    check_range("spike_max_fraction", options.spike_max_fraction, 0.0, 1.0)?;
    let finite = || x.iter().copied().filter(|v| v.is_finite());
    let low = finite().fold(f64::INFINITY, f64::min);
    let high = finite().fold(f64::NEG_INFINITY, f64::max);
    let constant = low >= high;
    let runs_at = |level: f64| {
        if constant { vec![] } else { runs(x, options.clip_run, |v| v == level) }
    };
    Ok(Quality {
        non_finite: runs(x, 1, |v| !v.is_finite()),
        constant,
        clipped_low: runs_at(low),
        clipped_high: runs_at(high),
        spikes: if constant { vec![] } else { spikes(x, options) },
    })
}

/// Runs of at least `shortest` samples that are all `wanted`.
fn runs(x: &[f64], shortest: usize, wanted: impl Fn(f64) -> bool) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = 0;
    for end in 0..=x.len() {
        if end < x.len() && wanted(x[end]) {
            continue;
        }
        if end - start >= shortest {
            found.push(start..end);
        }
        start = end + 1;
    }
    found
}

/// A spike among many edges departs this many times as far as they do.
const FAR_BEYOND: f64 = 20.0;

fn spikes(x: &[f64], options: &QualityOptions) -> Vec<usize> {
    let departures = departures(x, options.spike_half_window);
    let sizes = || departures.iter().map(|d| d.abs()).filter(|d| d.is_finite());
    let deviation = 1.4826 * median(&mut sizes().collect::<Vec<f64>>());
    // Held signals depart nowhere but at spikes: there the plain deviation has to serve.
    let threshold = if deviation > 0.0 { options.spike_threshold * deviation } else { 3.0 * standard_deviation(x) };
    let found: Vec<usize> = (0..x.len()).filter(|&i| departures[i].abs() > threshold).collect();
    let most = (options.spike_max_fraction * x.len() as f64).max(1.0) as usize;
    if found.len() <= most {
        return found;
    }
    // Edges depart too, all of about the same size: what is far beyond all but a few of the departures is no edge.
    let mut largest: Vec<f64> = sizes().collect();
    let (_, usual, _) = largest.select_nth_unstable_by(most, |a, b| b.total_cmp(a));
    let beyond = FAR_BEYOND * *usual;
    found.into_iter().filter(|&i| departures[i].abs() > beyond).collect()
}

/// Each sample less the median of its window; NaN where it is not finite. The window shrinks, symmetrically, at the ends.
fn departures(x: &[f64], half_window: usize) -> Vec<f64> {
    let mut window = Vec::with_capacity(2 * half_window + 1);
    let departure = |i: usize| {
        if !x[i].is_finite() {
            return f64::NAN;
        }
        let half = half_window.min(i).min(x.len() - 1 - i);
        window.clear();
        window.extend(x[i - half..=i + half].iter().copied().filter(|v| v.is_finite()));
        x[i] - median(&mut window)
    };
    (0..x.len()).map(departure).collect()
}

/// The lower median, zero of nothing.
fn median(values: &mut [f64]) -> f64 {
    match values.len().checked_sub(1) {
        Some(last) => *values.select_nth_unstable_by(last / 2, f64::total_cmp).1,
        None => 0.0,
    }
}

fn standard_deviation(x: &[f64]) -> f64 {
    let finite: Vec<f64> = x.iter().copied().filter(|v| v.is_finite()).collect();
    let mean = crate::series::mean(&finite).unwrap_or(0.0);
    (finite.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / finite.len().max(1) as f64).sqrt()
}
