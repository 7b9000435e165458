//! What time stamps say about the clock behind them: sample time, jitter, gaps, stamps that run backwards.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::error::{SignalError, check_at_least, check_finite};

/// A stretch without samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Gap {
    /// Indices of the samples on either side: the gap lies between `between.start` and `between.end`.
    pub between: Range<usize>,
    /// Time from one to the other, in seconds.
    pub duration_s: f64,
    /// Samples missing between them.
    pub missing: usize,
}

/// What was found in a series of time stamps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClockCheck {
    /// The sample time, in seconds: the mean of the regular intervals.
    pub sample_time_s: f64,
    /// Standard deviation of the regular intervals, in seconds.
    pub jitter_s: f64,
    /// Largest departure of a regular interval from the sample time, in seconds.
    pub worst_jitter_s: f64,
    /// Where samples are missing, in time order.
    pub gaps: Vec<Gap>,
    /// Indices of stamps that are not later than the one before (repeated or running backwards).
    pub non_monotonic: Vec<usize>,
    /// Samples missing in all gaps together.
    pub missing_samples: usize,
}

impl ClockCheck {
    /// Whether the stamps rise, none is missing, and no interval departs from the sample time by more than this
    /// fraction of it.
    #[must_use]
    pub fn is_uniform(&self, tolerance: f64) -> bool {
        self.gaps.is_empty() && self.non_monotonic.is_empty() && self.worst_jitter_s <= tolerance * self.sample_time_s
    }
}

/// Examines time stamps, in seconds.
///
/// The typical interval is the median of the positive ones. An interval of more than one and a half of it is a gap, one
/// of zero or less a break in order; the others are regular, and their mean is the sample time. So stamps rounded to
/// a step somewhat finer than the sample time give the true sample time, not a multiple of that step; a step so
/// coarse that stamps repeat biases it upwards.
///
/// # Errors
/// [`SignalError::TooShort`] for fewer than two stamps, or none that rises; [`SignalError::NonFinite`].
///
/// # Example
/// ```
/// let check = signal::clock::check_clock(&[0.0, 0.1, 0.2, 0.5, 0.6])?;
/// assert!((check.sample_time_s - 0.1).abs() < 1e-12);
/// assert_eq!((check.gaps[0].between.clone(), check.gaps[0].missing), (2..3, 2));
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn check_clock(times_s: &[f64]) -> Result<ClockCheck, SignalError> {
    check_at_least(2, times_s.len())?;
    check_finite(times_s)?;
    let intervals = || times_s.windows(2).map(|w| w[1] - w[0]);
    let typical = median_positive(intervals()).ok_or(SignalError::TooShort { needed: 2, got: 1 })?;
    let is_gap = |d: f64| d > 1.5 * typical;
    let regular = || intervals().filter(|&d| d > 0.0 && !is_gap(d));
    let count = regular().count() as f64;
    let sample_time_s = regular().sum::<f64>() / count;
    let departure = |d: f64| (d - sample_time_s).abs();
    let gaps: Vec<Gap> = intervals()
        .enumerate()
        .filter(|(_, d)| is_gap(*d))
        .map(|(i, duration_s)| Gap {
            between: i..i + 1,
            duration_s,
            missing: ((duration_s / sample_time_s).round() as usize).saturating_sub(1),
        })
        .collect();
    Ok(ClockCheck {
        sample_time_s,
        jitter_s: (regular().map(|d| departure(d).powi(2)).sum::<f64>() / count).sqrt(),
        worst_jitter_s: regular().map(departure).fold(0.0, f64::max),
        non_monotonic: (1..).zip(intervals()).filter(|(_, d)| *d <= 0.0).map(|(i, _)| i).collect(),
        missing_samples: gaps.iter().map(|g| g.missing).sum(),
        gaps,
    })
}

/// The lower median, so that it is one of the intervals and at least one interval is regular.
fn median_positive(intervals: impl Iterator<Item = f64>) -> Option<f64> {
    let mut positive: Vec<f64> = intervals.filter(|d| *d > 0.0).collect();
    let middle = positive.len().checked_sub(1)? / 2;
    Some(*positive.select_nth_unstable_by(middle, f64::total_cmp).1)
}
