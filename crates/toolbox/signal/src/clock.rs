//! Check of the clock behind time stamps: sample time, jitter, gaps, stamps that run backwards.

use std::ops::Range;

use numerics::order::{lower_median, lower_median_streamed};
use serde::{Deserialize, Serialize};

use crate::error::{SignalError, check_at_least, check_finite};

/// Intervals longer than this many typical ones are gaps, or end in a late stamp.
const LONGEST: f64 = 1.5;
/// Stamps are early and late where intervals are shorter than this many typical ones.
const SHORTEST: f64 = 0.75;
/// The part of a stamp's departure by which the clock follows it.
const FOLLOWED: f64 = 0.125;
/// Samples over which early and late stamps average out.
const MANY: usize = 16;
/// The mean of the shorter intervals is off by less than this part where stamps are early and late; more are missing
/// samples.
const MOST_BIASED: f64 = 0.08;
/// After a gap, stamps that differ by more of a sample time from the clock before are of a clock started anew.
const ANOTHER_PHASE: f64 = 0.25;

/// A stretch without samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Gap {
    /// Indices of the samples on either side: the gap lies between `between.start` and `between.end`.
    pub between: Range<usize>,
    /// Time from one to the other, in seconds.
    pub duration_s: f64,
    /// Samples missing between them.
    pub missing: usize,
}

/// Result of the check of a series of time stamps.
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
    /// Returns true if the stamps rise, none is missing, and no interval departs from the sample time by more than this
    /// fraction of it.
    #[must_use]
    pub fn is_uniform(&self, tolerance: f64) -> bool {
        self.gaps.is_empty() && self.non_monotonic.is_empty() && self.worst_jitter_s <= tolerance * self.sample_time_s
    }
}

/// Examines time stamps, in seconds.
///
/// The typical interval is the lower median of the positive ones, and so one of them. An interval of zero or less is a
/// break in order; one of more than one and a half of the typical one is a gap, unless the stamp was only early or
/// late: where intervals are also much shorter than that, stamps are compared with a clock that follows them slowly.
/// The other intervals are regular, and their mean is the sample time. So stamps rounded to a step somewhat finer than
/// the sample time give the true sample time, not a multiple of that step; a step so coarse that stamps repeat biases
/// it upwards.
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
    let intervals = || work::checked(times_s.windows(2)).map(|w| w[1] - w[0]);
    let positive = || intervals().filter(|d| *d > 0.0);
    let typical = lower_median_streamed(positive).ok_or(SignalError::TooShort { needed: 2, got: 1 })?;
    let short = || positive().filter(|&d| d <= LONGEST * typical);
    let about_s = mean(short());
    let shaky_s = short().any(|d| d < SHORTEST * typical).then(|| over_many(times_s, about_s));
    // Each interval with its samples, worked out anew each time: a long clock would be in memory twice.
    let stepped = || {
        let mut step = match shaky_s {
            Some(sample_time_s) => Step::OfShakyStamps { clock_s: first(times_s, sample_time_s), sample_time_s },
            None => Step::OfEvenStamps { sample_time_s: about_s },
        };
        intervals().enumerate().map(move |(i, d)| (d, step.samples(times_s, typical, i)))
    };
    let regular = || stepped().filter(|(d, steps)| *d > 0.0 && *steps == 1).map(|(d, _)| d);
    let sample_time_s = mean(regular());
    let departure = |d: f64| (d - sample_time_s).abs();
    let gaps: Vec<Gap> = stepped()
        .enumerate()
        .filter(|(_, (_, steps))| *steps > 1)
        .map(|(i, (duration_s, steps))| Gap { between: i..i + 1, duration_s, missing: steps - 1 })
        .collect();
    Ok(ClockCheck {
        sample_time_s,
        jitter_s: mean(regular().map(|d| departure(d).powi(2))).sqrt(),
        worst_jitter_s: regular().map(departure).fold(0.0, f64::max),
        non_monotonic: (1..).zip(intervals()).filter(|(_, d)| *d <= 0.0).map(|(i, _)| i).collect(),
        missing_samples: gaps.iter().fold(0, |sum, gap| sum.saturating_add(gap.missing)),
        gaps,
    })
}

/// Number of the tick of a clock, (start, sample time) in s, that is closest to an instant.
#[must_use]
pub fn tick(time_s: f64, clock: (f64, f64)) -> f64 {
    ((time_s - clock.0) / clock.1).round()
}

/// The clock, (start, sample time) in s, closest to time stamps in the sense of least squares, so that jitter of the
/// first and the last stamp does not move it. Each stamp belongs to the tick of a rough clock that is closest to it.
///
/// None where all stamps belong to one tick.
///
/// # Example
/// ```
/// let (start_s, sample_time_s) = signal::clock::fitted_clock(&[0.01, 0.1, 0.2, 0.3, 0.39], (0.01, 0.095)).unwrap();
/// assert!((start_s - 0.008).abs() < 1e-12 && (sample_time_s - 0.096).abs() < 1e-12);
/// ```
#[must_use]
pub fn fitted_clock(times_s: &[f64], rough: (f64, f64)) -> Option<(f64, f64)> {
    let count = times_s.len() as f64;
    let ticks = || times_s.iter().map(|&time| tick(time, rough));
    let (mean_tick, mean_time) = (ticks().sum::<f64>() / count, times_s.iter().map(|t| t / count).sum::<f64>());
    let spread: f64 = ticks().map(|tick| (tick - mean_tick).powi(2)).sum();
    let common: f64 = ticks().zip(times_s).map(|(tick, time)| (tick - mean_tick) * (time - mean_time)).sum();
    let sample_time_s = common / spread;
    (sample_time_s > 0.0).then_some((mean_time - mean_tick * sample_time_s, sample_time_s))
}

/// How many samples lie from each stamp to the next.
enum Step {
    /// No stamp is early or late by much.
    OfEvenStamps { sample_time_s: f64 },
    /// Stamps may be early or late by nearly half a sample time: each is compared with a clock that follows them with a
    /// first-order lag, and a sample counts as missing only if the next stamp says so too.
    OfShakyStamps { clock_s: f64, sample_time_s: f64 },
}

impl Step {
    /// Samples from stamp `i` to the next, asked in order; 1 to one that is not later.
    fn samples(&mut self, times_s: &[f64], typical: f64, i: usize) -> usize {
        let (before_s, after_s) = (times_s[i], times_s[i + 1]);
        match self {
            Self::OfEvenStamps { .. } if after_s - before_s <= LONGEST * typical => 1,
            Self::OfEvenStamps { sample_time_s } => (((after_s - before_s) / *sample_time_s).round() as usize).max(1),
            Self::OfShakyStamps { clock_s, .. } if after_s <= before_s => {
                *clock_s = after_s;
                1
            }
            Self::OfShakyStamps { clock_s, sample_time_s } => {
                let since = |t: f64| ((t - *clock_s) / *sample_time_s).round();
                let next = times_s.get(i + 2).filter(|t| **t > after_s).map_or(f64::INFINITY, |t| since(*t) - 1.0);
                let most = if after_s - before_s <= typical { 1.0 } else { next.max(1.0) };
                let step = since(after_s).clamp(1.0, most);
                let off_s = after_s - *clock_s - step * *sample_time_s;
                let begins_anew = step > 1.0 && off_s.abs() > ANOTHER_PHASE * *sample_time_s;
                *clock_s = if begins_anew { after_s } else { after_s - (1.0 - FOLLOWED) * off_s };
                step as usize
            }
        }
    }
}

/// The mean sample time over stretches of [`MANY`] in which none is missing, from what it is about.
fn over_many(times_s: &[f64], about_s: f64) -> f64 {
    let many = MANY.min(times_s.len() - 1);
    let stretches = || work::checked(times_s.windows(many + 1)).map(|w| (w[many] - w[0]) / many as f64);
    let Some(typical) = lower_median_streamed(|| stretches().filter(|d| *d > 0.0)) else { return about_s };
    let whole = || stretches().filter(|d| (d - typical).abs() < 0.5 * typical / many as f64);
    let found = mean(whole());
    if (found / about_s - 1.0).abs() < MOST_BIASED { found } else { about_s }
}

/// Where the clock stands at the first stamp: the median of what the first stamps say.
fn first(times_s: &[f64], sample_time_s: f64) -> f64 {
    let mut said: Vec<f64> = times_s.iter().take(8).enumerate().map(|(i, t)| t - i as f64 * sample_time_s).collect();
    let median = lower_median(&mut said).unwrap_or(times_s[0]);
    if (median - times_s[0]).abs() < 0.5 * sample_time_s { median } else { times_s[0] }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}
