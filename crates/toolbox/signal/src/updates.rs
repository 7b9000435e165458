//! Samples that hold no value of their own: a logger holds or interpolates a slow channel up to a fast raster, or
//! repeats the last sample where a new one is late.

use std::ops::Range;

use numerics::order::lower_median;
use serde::{Deserialize, Serialize};

use crate::runs;

/// Ratios of the rasters that are looked for: the largest is that of 50 Hz on a raster of 1 kHz.
const LARGEST_RATIO: usize = 20;
/// New values that are needed to see a pattern in.
const FEWEST_NEW: usize = 50;
/// Of the samples between those that a slow channel has, at most this share may seem new; of its own, at least this
/// share has to.
const NEW_BETWEEN: f64 = 0.02;
const NEW_OF_ITS_OWN: f64 = 0.5;
/// Samples lie on a straight line within this part of the largest magnitude, or within a step of their resolution.
const ROUNDING: f64 = 1e-9;
/// Differences that are multiples of a step within this part of it show a resolution, ...
const MULTIPLE_WITHIN: f64 = 0.1;
/// ... if this share of them is.
const MULTIPLES_SHARE: f64 = 0.9;
/// In finer steps than this part of the usual difference, repeats by chance are as frequent as differences of one step.
const FINE: f64 = 3.0;
/// Repeats count beyond so many times those by chance, ...
const REPEATS_FACTOR: f64 = 1.5;
/// ... so many standard deviations of these, ...
const REPEATS_DEVIATIONS: f64 = 5.0;
/// ... and this share of the samples.
const REPEATS_SHARE: f64 = 1e-3;
/// Of samples on straight lines at irregular instants, this share has to be.
const MANY_STRAIGHT: f64 = 0.05;
/// Of all samples this share has to bend clearly; rest is no straight line.
const MOVES: f64 = 0.25;

/// Why samples hold no value of their own.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Staleness {
    /// All but every n-th sample repeat the one before.
    Held {
        /// The n.
        every: usize,
    },
    /// All but every n-th sample lie on straight lines between these.
    Interpolated {
        /// The n.
        every: usize,
    },
    /// Samples repeat the one before at irregular instants.
    Repeated {
        /// The longest run of repeats.
        longest: Range<usize>,
    },
    /// Samples lie on straight lines between instants that are no samples.
    Straightened,
}

/// Samples that hold no value of their own.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stale {
    /// Why.
    pub how: Staleness,
    /// Which: one entry a sample.
    pub samples: Vec<bool>,
}

impl Stale {
    /// Their share, 0…1.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.samples.iter().filter(|stale| **stale).count() as f64 / self.samples.len().max(1) as f64
    }
}

/// Samples that hold no value of their own, if there are more of them than chance makes. Rest at zero, and at the
/// largest and the smallest value, does not count.
///
/// Values in steps `q` repeat by chance as often as they change by one step, where they usually change by several: the
/// density of the differences is the same at 0 and at ±q. More frequent repeats are not by chance.
///
/// # Example
/// ```
/// use signal::updates::{Staleness, find_stale};
/// let slow: Vec<f64> = (0..200).map(|i| (0.7 * f64::from(i)).sin()).collect();
/// let held: Vec<f64> = slow.iter().flat_map(|x| [*x; 4]).collect();
/// assert_eq!(find_stale(&held).map(|stale| stale.how), Some(Staleness::Held { every: 4 }));
/// assert_eq!(find_stale(&slow), None);
/// ```
#[must_use]
pub fn find_stale(x: &[f64]) -> Option<Stale> {
    held(x).or_else(|| interpolated(x)).or_else(|| repeated(x)).or_else(|| straightened(x))
}

fn held(x: &[f64]) -> Option<Stale> {
    let is_new: Vec<Option<bool>> = (0..x.len()).map(|i| difference(x, i).map(|d| d != 0.0)).collect();
    let (every, first) = regular(&is_new)?;
    Some(Stale { how: Staleness::Held { every }, samples: all_but(x.len(), every, first) })
}

fn interpolated(x: &[f64]) -> Option<Stale> {
    let tolerance = (1.01 * resolution(x).unwrap_or(0.0)).max(rounding(x));
    let is_new: Vec<Option<bool>> = (0..x.len()).map(|i| bend(x, i).map(|b| b > tolerance)).collect();
    let (every, first) = regular(&is_new)?;
    Some(Stale { how: Staleness::Interpolated { every }, samples: all_but(x.len(), every, first) })
}

/// Values in steps may lie on straight lines by chance.
fn straightened(x: &[f64]) -> Option<Stale> {
    if resolution(x).is_some() {
        return None;
    }
    let tolerance = rounding(x);
    let is_straight = |i: usize| {
        let moves = difference(x, i).is_some_and(|d| d > tolerance);
        moves && bend(x, i).is_some_and(|b| b <= tolerance)
    };
    let samples: Vec<bool> = (0..x.len()).map(is_straight).collect();
    let found = samples.iter().filter(|straight| **straight).count() as f64;
    let bends = (0..x.len()).filter(|i| bend(x, *i).is_some_and(|b| b > 4.0 * tolerance)).count() as f64;
    let count = x.len() as f64;
    (found > MANY_STRAIGHT * count && bends > MOVES * count).then_some(Stale { how: Staleness::Straightened, samples })
}

/// Departure from a straight line that rounding of the last digits explains.
fn rounding(x: &[f64]) -> f64 {
    work::checkpoint();
    ROUNDING * x.iter().filter(|v| v.is_finite()).fold(0.0, |most: f64, v| most.max(v.abs()))
}

fn repeated(x: &[f64]) -> Option<Stale> {
    work::checkpoint();
    let (low, high) =
        x.iter().filter(|v| v.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let rests = |v: f64| v == 0.0 || v == low || v == high;
    let samples: Vec<bool> = (0..x.len()).map(|i| difference(x, i) == Some(0.0) && !rests(x[i])).collect();
    let mut sizes: Vec<f64> = (1..x.len()).filter_map(|i| difference(x, i)).filter(|d| *d > 0.0).collect();
    let step = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    let by_chance = 0.5 * sizes.iter().filter(|d| **d < 1.5 * step).count() as f64;
    if lower_median(&mut sizes)? < FINE * step {
        return None;
    }
    let found = samples.iter().filter(|stale| **stale).count() as f64;
    let most =
        REPEATS_FACTOR * by_chance + REPEATS_DEVIATIONS * (by_chance + 1.0).sqrt() + REPEATS_SHARE * x.len() as f64;
    let longest = runs(samples.len(), |i| samples[i]).max_by_key(ExactSizeIterator::len)?;
    (found > most).then_some(Stale { how: Staleness::Repeated { longest }, samples })
}

/// Every how many samples a new value comes, and at which it first does.
fn regular(is_new: &[Option<bool>]) -> Option<(usize, usize)> {
    let known = is_new.iter().flatten().count();
    let new = is_new.iter().filter(|new| **new == Some(true)).count();
    if new < FEWEST_NEW || new as f64 > (NEW_OF_ITS_OWN + NEW_BETWEEN) * known as f64 {
        return None;
    }
    (2..=LARGEST_RATIO).rev().find_map(|every| {
        work::checkpoint();
        let mut counts = vec![(0.0, 0.0); every];
        for (i, new) in is_new.iter().enumerate() {
            let Some(new) = new else { continue };
            counts[i % every].0 += f64::from(u8::from(*new));
            counts[i % every].1 += 1.0;
        }
        let share = |(new, all): (f64, f64)| if all > 0.0 { new / all } else { 0.0 };
        let first = (0..every).max_by(|a, b| share(counts[*a]).total_cmp(&share(counts[*b])))?;
        let own = share(counts.swap_remove(first));
        let between = counts.iter().fold((0.0, 0.0), |sum, c| (sum.0 + c.0, sum.1 + c.1));
        (own >= NEW_OF_ITS_OWN && share(between) <= NEW_BETWEEN).then_some((every, first))
    })
}

fn all_but(count: usize, every: usize, first: usize) -> Vec<bool> {
    (0..count).map(|i| i % every != first).collect()
}

/// The step in which values are recorded, if they are in steps.
///
/// # Example
/// ```
/// let x: Vec<f64> = (0..300).map(|i| (10.0 * (0.1 * f64::from(i)).sin()).round() * 0.25).collect();
/// assert_eq!(signal::updates::resolution(&x), Some(0.25));
/// ```
#[must_use]
pub fn resolution(x: &[f64]) -> Option<f64> {
    work::checkpoint();
    let sizes = || (1..x.len()).filter_map(|i| difference(x, i)).filter(|d| *d > 0.0);
    let step = sizes().fold(f64::INFINITY, f64::min);
    let is_multiple = |d: &f64| (d / step - (d / step).round()).abs() < MULTIPLE_WITHIN;
    let all = sizes().count();
    (all > 0 && sizes().filter(is_multiple).count() as f64 > MULTIPLES_SHARE * all as f64).then_some(step)
}

/// The size of the change from the sample before; none beside a gap.
fn difference(x: &[f64], i: usize) -> Option<f64> {
    let change = (x[i] - x[i.checked_sub(1)?]).abs();
    change.is_finite().then_some(change)
}

/// How far a sample is from the straight line through its neighbours, doubled; none beside a gap.
fn bend(x: &[f64], i: usize) -> Option<f64> {
    let bend = (x[i.checked_sub(1)?] - 2.0 * x[i] + x.get(i + 1)?).abs();
    bend.is_finite().then_some(bend)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::Random;

    /// Coloured noise about a speed, in steps.
    fn speed(count: usize, step: f64) -> Vec<f64> {
        let mut random = Random::new(3);
        let mut slow = 0.0;
        let value = |_| {
            slow = 0.99 * slow + random.normal();
            let x: f64 = 1200.0 + slow + 0.3 * random.normal();
            if step > 0.0 { (x / step).round() * step } else { x }
        };
        (0..count).map(value).collect()
    }

    fn between(slow: &[f64], every: usize) -> Vec<f64> {
        let line = |pair: &[f64]| {
            (0..every).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / every as f64).collect::<Vec<_>>()
        };
        slow.windows(2).flat_map(line).collect()
    }

    fn how(x: &[f64]) -> Option<Staleness> {
        find_stale(x).map(|stale| stale.how)
    }

    #[test]
    fn exact_slow_channels_on_a_fast_raster() {
        for step in [0.0, 0.01] {
            let slow = speed(3000, step);
            for every in [2, 4, 10] {
                let held: Vec<f64> = slow.iter().flat_map(|x| vec![*x; every]).skip(1).collect();
                let found = find_stale(&held).unwrap();
                assert_eq!(found.how, Staleness::Held { every });
                assert!(!found.samples[every - 1] && found.samples[every]);
                let straight = between(&slow, every);
                assert_eq!(how(&straight), Some(Staleness::Interpolated { every }), "{every}, {step}");
                assert!(find_stale(&straight).unwrap().samples.iter().step_by(every).skip(1).all(|stale| !stale));
                if step > 0.0 {
                    let rounded: Vec<f64> = straight.iter().map(|x| (x / step).round() * step).collect();
                    assert_eq!(how(&rounded), Some(Staleness::Interpolated { every }), "{every}, rounded");
                }
            }
        }
    }

    #[test]
    fn exact_repeats_at_irregular_instants() {
        for step in [0.0, 0.01, 0.1] {
            let mut x = speed(20_000, step);
            let mut random = Random::new(5);
            (1..x.len()).for_each(|i| {
                if random.uniform() < 0.3 {
                    x[i] = x[i - 1];
                }
            });
            let found = find_stale(&x).unwrap();
            assert!(matches!(found.how, Staleness::Repeated { .. }) && (found.share() - 0.3).abs() < 0.05, "{step}");
        }
        // In coarse steps as many repeat by chance.
        for step in [0.0, 0.01] {
            let mut stuck = speed(20_000, step);
            let value = stuck[5000];
            stuck[5000..5200].fill(value);
            let Some(Staleness::Repeated { longest }) = how(&stuck) else { panic!("{step}") };
            assert!(longest.len() >= 199, "{longest:?}");
        }
    }

    #[test]
    fn exact_lines_between_instants_that_are_no_samples() {
        let slow = speed(3000, 0.0);
        let at = |t: f64| slow[t as usize] + t.fract() * (slow[t as usize + 1] - slow[t as usize]);
        let x: Vec<f64> = (0..9000).map(|i| at(0.3 * f64::from(i))).collect();
        assert_eq!(how(&x), Some(Staleness::Straightened));
    }

    #[test]
    fn exact_samples_that_are_all_their_own() {
        for step in [0.0, 0.01, 0.3, 1.0, 3.0] {
            assert_eq!(how(&speed(20_000, step)), None, "{step}");
        }
        // At rest, and clipped.
        let mut x = speed(20_000, 0.01);
        x[..8000].fill(0.0);
        assert_eq!(how(&x), None);
        let clipped: Vec<f64> = speed(20_000, 0.01).iter().map(|x| x.min(1203.0)).collect();
        assert_eq!(how(&clipped), None);
        assert_eq!(how(&[]), None);
        assert_eq!(how(&[1.0; 500]), None);
    }
}
