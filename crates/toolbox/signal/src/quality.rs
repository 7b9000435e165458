//! Damage visible in the samples alone: gaps of NaN, no variation, clipping, spikes.

use std::ops::Range;

use numerics::order::{lower_median, lower_median_streamed, select, select_streamed};
use serde::{Deserialize, Serialize};

use crate::error::{SignalError, check_range};
use crate::runs;

/// Criteria of damage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct QualityOptions {
    /// Shortest run at the smallest or largest value that counts as clipped; at least two.
    pub clip_run: usize,
    /// Samples on each side whose median a spike is compared with; at least one. No spike is longer.
    pub spike_half_window: usize,
    /// Probability that Gaussian data of any colour show a spike anywhere, with the scale estimated robustly.
    pub spike_false_alarm: f64,
    /// If more than this fraction of the samples would be spikes, the signal is like that, and only what is far beyond
    /// the rest is reported.
    pub spike_max_fraction: f64,
}

impl Default for QualityOptions {
    /// Runs of 5; medians over 7 samples; a false alarm in a thousand series; at most 1 % of the samples.
    fn default() -> Self {
        Self { clip_run: 5, spike_half_window: 3, spike_false_alarm: 1e-3, spike_max_fraction: 0.01 }
    }
}

/// Findings in a series; every range is of sample indices, half open, in order.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Quality {
    /// Runs of NaN or infinite samples.
    pub non_finite: Vec<Range<usize>>,
    /// True if all finite samples are equal (or there is none). Then nothing below is reported.
    pub constant: bool,
    /// Runs at the smallest value. A signal held at levels (a command) shows them too: it is for the caller to know.
    pub clipped_low: Vec<Range<usize>>,
    /// Runs at the largest value.
    pub clipped_high: Vec<Range<usize>>,
    /// Samples that stand out from their neighbours and are no step.
    pub spikes: Vec<usize>,
}

impl Quality {
    /// Returns true if nothing was found.
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
/// A spike at sample t stands out from the middle of its neighbours, `r(t) = x(t) − (x(t−1) + x(t+1))/2`, or where data
/// do not remember their past from the median of all, by more than `s √(2 ln(N/p))`, which N Gaussian values of
/// deviation s exceed with a probability below p whatever their colour, and from the median of its window as well, as a
/// step does not. It also stands out from what the samples around it do: where a ripple or a fast ramp moves them from
/// one to the next, no sample of these is a spike, whatever the rest of the record is like.
///
/// # Source
/// Spikes: Hampel, F. R. (1974), J. Am. Stat. Assoc. 69, 383–393 (median and median absolute deviation); the largest of
/// N: the union bound with P(|z| > c) ≤ exp(−c²/2).
pub fn check_quality(x: &[f64], options: &QualityOptions) -> Result<Quality, SignalError> {
    check_range("clip_run", options.clip_run as f64, 2.0, f64::INFINITY)?;
    check_range("spike_half_window", options.spike_half_window as f64, 1.0, f64::INFINITY)?;
    check_range("spike_false_alarm", options.spike_false_alarm, 0.0, 1.0)?;
    check_range("spike_max_fraction", options.spike_max_fraction, 0.0, 1.0)?;
    let low = finite(x).fold(f64::INFINITY, f64::min);
    let high = finite(x).fold(f64::NEG_INFINITY, f64::max);
    let constant = low >= high;
    let runs_at = |level: f64| {
        let at_level = runs(x.len(), |i| !constant && x[i] == level);
        at_level.filter(|run| run.len() >= options.clip_run).collect()
    };
    Ok(Quality {
        non_finite: runs(x.len(), |i| !x[i].is_finite()).collect(),
        constant,
        clipped_low: runs_at(low),
        clipped_high: runs_at(high),
        spikes: if constant { vec![] } else { spikes(x, options) },
    })
}

/// A spike among many edges departs this many times as far as they do.
const FAR_BEYOND: f64 = 20.0;

/// A spike departs from the median of its window by at least this part of what it does from its neighbours.
const ALONE: f64 = 0.5;

/// A spike departs so many times as far as all but a share of the samples around it move from one to the next. Of a
/// ripple that the raster folds, and of a corner between two ramps, the ratio is 1.
const BEYOND_AROUND: f64 = 3.0;
/// So many samples on each side are around a spike.
const SAMPLES_ASIDE: usize = 24;
/// This share of the samples around a spike, those that move most, does not count.
const LARGEST_SHARE: f64 = 0.2;

/// The share of samples that sets the scale where their tails are heavier than Gaussian ones.
const TAIL_SHARE: f64 = 0.02;
/// So many Gaussian standard deviations that share lies beyond.
const TAIL_DEVIATIONS: f64 = 2.326_347_874;

fn spikes(x: &[f64], options: &QualityOptions) -> Vec<usize> {
    let middle = lower_median_streamed(|| finite(x)).unwrap_or(0.0);
    let (bend, about_median) = (|i: usize| bend(x, i), |i: usize| x[i] - middle);
    let false_alarm = options.spike_false_alarm;
    let of_bends = largest_by_chance(|| sizes(x.len(), bend), false_alarm);
    let of_all = largest_by_chance(|| sizes(x.len(), about_median), false_alarm);
    let (error, least): (&dyn Fn(usize) -> f64, f64) = match of_all < of_bends {
        true => (&about_median, of_all),
        false => (&bend, of_bends),
    };
    let departure_sizes = || sizes(x.len(), departures(x, options.spike_half_window));
    // Held signals depart nowhere but at spikes: there the plain deviation has to serve.
    let (held, all) = departure_sizes().fold((0, 0), |(held, all), size| (held + usize::from(size == 0.0), all + 1));
    let threshold = if 2 * held < all { least } else { least.max(3.0 * standard_deviation(x)) };
    let mut departure = departures(x, options.spike_half_window);
    let mut is_spike = |i: &usize| {
        let size = error(*i).abs();
        size > threshold
            && departure(*i).abs() > ALONE * size
            && size > BEYOND_AROUND * moved_around(x, *i, options.spike_half_window)
    };
    let found: Vec<usize> = work::checked(0..x.len()).filter(&mut is_spike).collect();
    let found = with_neighbours(&found, x.len(), &mut departure);
    let found = no_longer_than(options.spike_half_window, &found);
    let most = (options.spike_max_fraction * x.len() as f64).max(1.0) as usize;
    if found.len() <= most {
        return found;
    }
    // Edges depart too, all of about the same size: what is far beyond all but a few of the departures is no edge.
    let usual = select_streamed(departure_sizes, |count| count.saturating_sub(1 + most)).unwrap_or(0.0);
    let beyond = FAR_BEYOND * usual;
    found.into_iter().filter(|&i| departure(i).abs() > beyond).collect()
}

/// The finite ones of the sizes of so many values.
fn sizes(count: usize, mut value: impl FnMut(usize) -> f64) -> impl Iterator<Item = f64> {
    work::checked(0..count).map(move |i| value(i).abs()).filter(|size| size.is_finite())
}

/// Bound that the largest of so many Gaussian values exceeds only with the probability of a false alarm.
fn largest_by_chance<I: Iterator<Item = f64>>(sizes: impl Fn() -> I, false_alarm: f64) -> f64 {
    let mut count = 0;
    let place = |all: usize| {
        count = all;
        all.saturating_sub(1 + (TAIL_SHARE * all.saturating_sub(1) as f64).ceil() as usize)
    };
    let Some(tail) = select_streamed(&sizes, place) else { return f64::INFINITY };
    let usual = 1.4826 * lower_median_streamed(&sizes).unwrap_or(0.0);
    usual.max(tail / TAIL_DEVIATIONS) * (2.0 * (count as f64 / false_alarm).ln()).sqrt()
}

/// How far the samples around a place move from one to the next, but for the largest of them. What is within a spike's
/// reach of the place does not count.
fn moved_around(x: &[f64], i: usize, reach: usize) -> f64 {
    let before = i.saturating_sub(reach + SAMPLES_ASIDE)..i.saturating_sub(reach);
    let after = (i + reach).min(x.len())..(i + reach + SAMPLES_ASIDE).min(x.len());
    let moved = |range: Range<usize>| x[range].windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let mut sizes: Vec<f64> = moved(before).chain(moved(after)).filter(|size| size.is_finite()).collect();
    let largest = (LARGEST_SHARE * sizes.len() as f64) as usize;
    let place = sizes.len().saturating_sub(1 + largest);
    select(&mut sizes, place).unwrap_or(0.0)
}

/// Found samples without longer stretches, which are no spikes.
fn no_longer_than(most: usize, found: &[usize]) -> Vec<usize> {
    let stretches = found.chunk_by(|a, b| b - a == 1);
    stretches.filter(|stretch| stretch.len() <= most).flatten().copied().collect()
}

/// Spikes of several samples: beside one, what departs to the same side at least half as far.
fn with_neighbours(found: &[usize], count: usize, mut departure: impl FnMut(usize) -> f64) -> Vec<usize> {
    let mut belongs = |i: usize, to: usize| i == to || departure(i) / departure(to) > 0.5;
    let mut all = Vec::new();
    for &i in found {
        all.extend((i.saturating_sub(1)..=i + 1).filter(|j| *j < count && belongs(*j, i)));
    }
    all.sort_unstable();
    all.dedup();
    all
}

/// A sample less the middle of its two neighbours, Gaussian where the samples are; NaN at the ends and beside gaps.
fn bend(x: &[f64], i: usize) -> f64 {
    match (i.checked_sub(1).map(|before| x[before]), x.get(i + 1)) {
        (Some(before), Some(after)) => x[i] - 0.5 * before - 0.5 * after,
        _ => f64::NAN,
    }
}

/// A sample less the median of its window; NaN where it is not finite. The window shrinks, symmetrically, at the ends.
fn departures(x: &[f64], half_window: usize) -> impl FnMut(usize) -> f64 {
    let mut window = Vec::with_capacity(2 * half_window + 1);
    move |i| {
        if !x[i].is_finite() {
            return f64::NAN;
        }
        let half = half_window.min(i).min(x.len() - 1 - i);
        window.clear();
        window.extend(finite(&x[i - half..=i + half]));
        x[i] - lower_median(&mut window).unwrap_or(0.0)
    }
}

/// The samples that are finite.
fn finite(x: &[f64]) -> impl Iterator<Item = f64> {
    x.iter().copied().filter(|v| v.is_finite())
}

fn standard_deviation(x: &[f64]) -> f64 {
    let count = finite(x).count().max(1) as f64;
    let mean = finite(x).sum::<f64>() / count;
    (finite(x).map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt()
}
