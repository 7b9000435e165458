//! Where and how inputs repeat: the period, the stretch in which it holds, the harmonics they excite, and from which
//! period on the outputs have settled.

use std::f64::consts::TAU;

use numerics::order::upper_median;

use super::periodic::{PeriodicSpectra, period_coefficients, periodic_spectra};
use super::{check_records, check_some};
use crate::Complex64;
use crate::correlation::is_constant;
use crate::distributions::{chi_squared_quantile, f_tail};
use crate::error::{SignalError, check_at_least, check_range};
use crate::periodicity::{Periodicity, detect_common_period};
use crate::resample::{Interpolation, interpolate_at};
use crate::series::{Signal, mean};

/// Part of the variance of an input that need not repeat: the noise on a measured one.
const UNREPEATED: f64 = 0.05;
/// A block of a period belongs to the repetition where no more than this part of it changes, apart from the noise.
const CHANGED: f64 = 1e-3;
/// An input excites a line where its amplitude is this part of its strongest line. What lies below is as weak as the
/// distortion of an actuator.
const EXCITED: f64 = 0.01;
/// Chance that a line of noise counts as excited, or a settled period as not settled.
const CHANCE: f64 = 1e-3;
/// The probability above which a repetition may as well be chance, as in a short stretch; and the levels of a signal of
/// which only the places of its changes say something.
const LIKELY: f64 = 0.01;
const FEW_LEVELS: usize = 3;
/// By how many bins the highest line may miss its place for the period not to be a whole number of samples: leakage of
/// as much goes to the next bins.
const OFF_LINE: f64 = 1e-4;
/// Standard errors from which a fraction of a sample in the period is more than noise.
const CERTAIN: f64 = 5.0;
/// Periods from which on a period found is not taken apart.
const WANTED_PERIODS: usize = 8;
/// Degrees of freedom to which the variances of neighbouring lines are taken together.
const POOLED_FREEDOM: usize = 24;

/// A stretch of a record in which the inputs repeat.
#[derive(Debug, Clone, PartialEq)]
pub struct Repetition {
    /// The period in samples, not always a whole number.
    pub period_samples: f64,
    /// First sample of the first period used.
    pub first: usize,
    /// Whole periods used.
    pub periods: usize,
    /// Periods before those that were left out, because the outputs had not settled.
    pub unsettled: usize,
    /// True if the outputs still change from period to period by more than noise where the used periods begin.
    pub still_settling: bool,
    /// Of each input the harmonics of the period that it excites, rising.
    pub excited: Vec<Vec<usize>>,
}

/// Inputs and outputs of a repetition, whole periods of `period` samples, without drift.
#[derive(Debug, Clone)]
pub(super) struct Periods {
    pub(super) channels: Vec<Vec<f64>>,
    pub(super) period: usize,
}

impl Periods {
    /// The last whole periods of channels, on a clock on which the period is a whole number of samples; none where
    /// there are fewer than two.
    fn of(channels: &[&[f64]], period_samples: f64) -> Result<Option<Self>, SignalError> {
        let period = period_samples.round();
        let (step, last) = (period_samples / period, channels.first().map_or(0, |x| x.len()) as f64 - 1.0);
        let period = period as usize;
        let count = ((last / step + 1.0 + 1e-9) / period.max(1) as f64) as usize;
        if count < 2 || period < 3 {
            return Ok(None);
        }
        let first = last - (count * period - 1) as f64 * step;
        let times: Vec<f64> = (0..count * period).map(|i| (first + i as f64 * step).max(0.0)).collect();
        let taken = |x: &&[f64]| {
            let whole = match step {
                1.0 => x[x.len() - count * period..].to_vec(),
                _ => interpolate_at(&Signal::new(0.0, 1.0, x.to_vec())?, &times, Interpolation::BandLimited)?,
            };
            Ok(without_drift(&whole, period))
        };
        Ok(Some(Periods { channels: channels.iter().map(taken).collect::<Result<_, SignalError>>()?, period }))
    }

    /// The harmonics that each of the first channels excites.
    fn excited(&self, inputs: usize) -> Result<Vec<Vec<usize>>, SignalError> {
        let spectra = self.spectra(0, 1.0, &[])?;
        Ok((0..inputs).map(|j| excited(&spectra, j)).collect())
    }

    fn count(&self) -> usize {
        self.channels.first().map_or(0, |x| x.len() / self.period)
    }

    /// Mean spectra of all but the first periods.
    pub(super) fn spectra(
        &self,
        left_out: usize,
        sample_time_s: f64,
        harmonics: &[usize],
    ) -> Result<PeriodicSpectra, SignalError> {
        let rest: Vec<&[f64]> = self.channels.iter().map(|x| &x[left_out * self.period..]).collect();
        periodic_spectra(&rest, self.period, sample_time_s, harmonics)
    }
}

/// How the inputs repeat, and the periods themselves; none where they do not repeat at least twice.
pub(super) fn find(
    inputs: &[&[f64]],
    outputs: &[&[f64]],
    sample_time_s: f64,
    period_s: Option<f64>,
) -> Result<Option<(Repetition, Periods)>, SignalError> {
    check_some(inputs)?;
    let channels = [inputs, outputs].concat();
    let length = check_records(&channels, sample_time_s)?;
    check_at_least(8, length)?;
    let moving: Vec<&[f64]> = inputs.iter().copied().filter(|u| !is_constant(u)).collect();
    let found = match period_s {
        None => stretch(&moving)?,
        Some(period_s) => Some(given(&moving, period_s / sample_time_s)?),
    };
    let Some((period, first, end)) = found else { return Ok(None) };
    let used: Vec<&[f64]> = channels.iter().map(|x| &x[first..end]).collect();
    let mut period_samples = period as f64 + missed_samples(&used[..inputs.len()], period)?.unwrap_or(0.0);
    let Some(mut periods) = Periods::of(&used, period_samples)? else { return Ok(None) };
    let mut excited = periods.excited(inputs.len())?;
    // A period that is no whole number of samples was found as a multiple that nearly is.
    if let (None, Some(times)) = (period_s, shorter(&excited, periods.count())) {
        period_samples /= times as f64;
        periods = Periods::of(&used, period_samples)?.unwrap_or(periods);
        excited = periods.excited(inputs.len())?;
    }
    let mut lines: Vec<usize> = excited.iter().flatten().copied().collect();
    lines.sort_unstable();
    lines.dedup();
    if lines.is_empty() {
        return Ok(None);
    }
    let (unsettled, still_settling) = settling(&periods, inputs.len(), &lines)?;
    let first = end - ((periods.count() - unsettled) as f64 * period_samples).round() as usize;
    let count = periods.count() - unsettled;
    let found = Repetition { period_samples, first, periods: count, unsettled, still_settling, excited };
    Ok(Some((found, periods)))
}

/// How many times shorter the period is, where all harmonics excited are multiples and few periods were found: as many
/// as make enough of them. Noise that lasts longer than a period would not show in the differences between shorter
/// ones.
fn shorter(excited: &[Vec<usize>], periods: usize) -> Option<usize> {
    let common = excited.iter().flatten().fold(0, |a, b| greatest_common_divisor(a, *b));
    let enough = (2..=common).find(|d| common.is_multiple_of(*d) && d * periods >= WANTED_PERIODS);
    (periods < WANTED_PERIODS && common > 1).then(|| enough.unwrap_or(common))
}

fn greatest_common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// The probability that inputs which do not repeat look like this after one of the periods tried: of values on either
/// side of a period that correlate so, and where there are but a few levels, of changes in the same places.
fn by_chance(inputs: &[&[f64]], found: Periodicity) -> f64 {
    let tried = inputs.first().map_or(0, |u| u.len() / 2) as f64;
    let one = |u: &&[f64]| {
        let moves = u[found.period..].windows(2).filter(|w| w[0] != w[1]).count();
        if has_few_levels(u) {
            let pairs = u.len() - found.period;
            let choices = (0..moves).map(|k| ((pairs - k) as f64 / (moves - k) as f64).ln());
            return (-choices.sum::<f64>()).exp();
        }
        // About a line.
        let freedom = moves as f64 - 2.0;
        let alike = (1.0 - found.unrepeated).clamp(0.0, 1.0).powi(2);
        match freedom > 0.0 {
            true if alike < 1.0 => 0.5 * f_tail(freedom * alike / (1.0 - alike), 1.0, freedom),
            true => 0.0,
            false => 1.0,
        }
    };
    tried * inputs.iter().map(one).fold(1.0, f64::min)
}

/// Returns true if a signal switches between a few levels.
fn has_few_levels(u: &[f64]) -> bool {
    let mut levels: Vec<f64> = Vec::new();
    u.iter().all(|v| {
        if !levels.contains(v) {
            levels.push(*v);
        }
        levels.len() <= FEW_LEVELS
    })
}

/// The period, and begin and end of the longest stretch in which all inputs repeat. Where the whole record does not,
/// its halves and its middle are tried: an excitation may begin late or end early.
fn stretch(inputs: &[&[f64]]) -> Result<Option<(usize, usize, usize)>, SignalError> {
    let Some(length) = inputs.first().map(|u| u.len()) else { return Ok(None) };
    let parts = [(0, length), (length / 2, length), (0, length / 2), (length / 4, length - length / 4)];
    let mut best: Option<(usize, usize, usize)> = None;
    for (from, to) in parts {
        if to - from < 8 || inputs.iter().any(|u| is_constant(&u[from..to])) {
            continue;
        }
        let part: Vec<Vec<f64>> = inputs.iter().map(|u| without_line(&u[from..to])).collect();
        let part: Vec<&[f64]> = part.iter().map(Vec::as_slice).collect();
        let Some(found) = detect_common_period(&part, UNREPEATED)? else { continue };
        let raw: Vec<&[f64]> = inputs.iter().map(|u| &u[from..to]).collect();
        if by_chance(&raw, found) > LIKELY {
            continue;
        }
        let Some((first, end)) = repeating(inputs, found.period, (from, to), None) else { continue };
        // A part of few periods may repeat best after several of them.
        if best.is_none_or(|(period, a, b)| (end - first) * period > (b - a) * found.period) {
            best = Some((found.period, first, end));
        }
        if end - first + found.period > length {
            break;
        }
    }
    Ok(best)
}

/// The stretch in which the inputs repeat after a period given, in samples.
fn given(inputs: &[&[f64]], period: f64) -> Result<(usize, usize, usize), SignalError> {
    let length = inputs.first().map_or(0, |u| u.len());
    check_range("period in samples", period, 3.0, 0.5 * length as f64)?;
    let period = period.round() as usize;
    let wrong = SignalError::NotRepeated { period };
    let (first, end) = repeating(inputs, period, (0, length), Some(2.0 * UNREPEATED)).ok_or(wrong)?;
    Ok((period, first, end))
}

/// The longest run in which each block of a period is followed by one that differs from it by no more than `limit` of
/// the variance of the part in which the period was found; without a limit, by no more than noise as in half of the
/// blocks.
fn repeating(inputs: &[&[f64]], period: usize, part: (usize, usize), limit: Option<f64>) -> Option<(usize, usize)> {
    let length = inputs.first()?.len();
    let blocks = (length + 1).checked_sub(2 * period)?;
    // Of the input that changes most.
    let mut change = vec![0.0_f64; blocks];
    for u in inputs {
        let level = mean(&u[part.0..part.1]).unwrap_or(0.0);
        let energy: f64 = u[part.0..part.1].iter().map(|v| (v - level).powi(2)).sum();
        let in_period = 2.0 * energy * period as f64 / (part.1 - part.0) as f64;
        let step = |t: usize| (u[t + period] - u[t]).powi(2) / in_period;
        let mut sums = vec![0.0; length - period + 1];
        (0..length - period).for_each(|t| sums[t + 1] = sums[t] + step(t));
        change.iter_mut().enumerate().for_each(|(t, most)| *most = most.max(sums[t + period] - sums[t]));
    }
    let usual = upper_median(&mut change[part.0..(part.1 + 1).saturating_sub(2 * period).max(part.0)].to_vec());
    let limit = limit.unwrap_or(2.0 * usual.unwrap_or(0.0) + CHANGED);
    let (mut best, mut start) = (0..0, 0);
    for (t, change) in change.iter().enumerate() {
        if *change > limit {
            start = t + 1;
        } else if t + 1 - start > best.len() {
            best = start..t + 1;
        }
    }
    (!best.is_empty()).then(|| (best.start, best.end - 1 + 2 * period))
}

/// By how many samples the true period is longer than a whole number; none where that is noise, or does not matter.
fn missed_samples(inputs: &[&[f64]], period: usize) -> Result<Option<f64>, SignalError> {
    let highest = (period - 1) / 2;
    let count = inputs.first().map_or(0, |u| u.len() / period);
    if count < 2 || highest < 1 {
        return Ok(None);
    }
    let harmonics: Vec<usize> = (1..=highest).collect();
    let coefficients = period_coefficients(inputs, period, &harmonics)?;
    let at = |p: usize, i: usize| coefficients[p * inputs.len() * highest + i];
    let strength = |i: usize| (0..count).map(|p| at(p, i).norm()).sum::<f64>();
    let strongest = (0..inputs.len() * highest).map(strength).fold(0.0, f64::max);
    let strong: Vec<usize> = (0..inputs.len() * highest).filter(|i| strength(*i) > 0.1 * strongest).collect();
    // Of each pair of periods, by least squares over the lines: a phase is −2πh·missed/period.
    let of_pair = |p: usize| {
        let (mut up, mut down) = (0.0, 0.0);
        for &i in &strong {
            let (h, turned) = ((i % highest + 1) as f64, at(p + 1, i) * at(p, i).conj());
            up -= h * turned.norm() * turned.arg();
            down += h * h * turned.norm();
        }
        period as f64 * up / (TAU * down)
    };
    let each: Vec<f64> = (0..count - 1).map(of_pair).collect();
    let pairs = each.len() as f64;
    let missed = each.iter().sum::<f64>() / pairs;
    let scatter = each.iter().map(|v| (v - missed).powi(2)).sum::<f64>();
    let error = (scatter / (pairs * (pairs - 1.0).max(1.0))).sqrt();
    let top = strong.iter().map(|i| i % highest + 1).max().unwrap_or(1) as f64;
    let matters = top * missed.abs() / period as f64 > OFF_LINE && missed.abs() > CERTAIN * error;
    Ok(matters.then_some(missed))
}

fn without_line(x: &[f64]) -> Vec<f64> {
    let middle = 0.5 * (x.len() as f64 - 1.0);
    let level = mean(x).unwrap_or(0.0);
    let (mut up, mut down) = (0.0, 0.0);
    for (t, v) in x.iter().enumerate() {
        let distance = t as f64 - middle;
        up += distance * (v - level);
        down += distance * distance;
    }
    let slope = up / down;
    x.iter().enumerate().map(|(t, v)| v - level - slope * (t as f64 - middle)).collect()
}

/// Whole periods without their means and without the slope that the means of their neighbours have: a drift would look
/// the same in every period, as a line at each harmonic.
fn without_drift(x: &[f64], period: usize) -> Vec<f64> {
    let means: Vec<f64> = x.chunks_exact(period).map(|p| mean(p).unwrap_or(0.0)).collect();
    let middle = 0.5 * (period as f64 - 1.0);
    let mut level = Vec::with_capacity(x.len());
    for (j, own) in means.iter().enumerate() {
        let (before, after) = (j.saturating_sub(1), (j + 1).min(means.len() - 1));
        let slope = (means[after] - means[before]) / ((after - before).max(1) * period) as f64;
        level.extend((0..period).map(|t| own + slope * (t as f64 - middle)));
    }
    x.iter().zip(level).map(|(x, level)| x - level).collect()
}

/// The harmonics that an input excites: strong against its strongest one, and more than its noise.
fn excited(spectra: &PeriodicSpectra, input: usize) -> Vec<usize> {
    let (n, count) = (spectra.channels, spectra.harmonics.len());
    let power = |k: usize| spectra.mean[k * n + input].norm_sqr();
    let own: Vec<f64> = (0..count).map(|k| spectra.covariance[(k * n + input) * n + input].re).collect();
    let width = pooled_lines(spectra.periods, count);
    let noise = pooled(&own, width);
    let strongest = (0..count).map(power).fold(0.0, f64::max);
    let significant = largest_by_chance((spectra.periods - 1) * width, count);
    let is_excited = |k: &usize| power(*k) > EXCITED * EXCITED * strongest && power(*k) > significant * noise[*k];
    (0..count).filter(is_excited).map(|k| spectra.harmonics[k]).collect()
}

/// Bound that the largest of so many `|X|²/σ̂²` of noise exceeds by chance only, each distributed as F with 2 and
/// `2·freedom` degrees of freedom.
fn largest_by_chance(freedom: usize, count: usize) -> f64 {
    let freedom = freedom as f64;
    freedom * ((CHANCE / count as f64).powf(-1.0 / freedom) - 1.0)
}

/// How many of the first periods to leave out until the outputs have settled, and whether even half of them are too
/// few. A period has not settled where its lines differ from those of the later half of the periods by more than noise,
/// at all lines together or at one. One more is left out with those: what is left in it is too small to be seen in a
/// period, but not in the mean.
fn settling(periods: &Periods, inputs: usize, lines: &[usize]) -> Result<(usize, bool), SignalError> {
    let (count, outputs) = (periods.count(), periods.channels.len() - inputs);
    let late = count - count / 2;
    if late < 2 || outputs == 0 || count < 3 {
        return Ok((0, false));
    }
    let refs: Vec<&[f64]> = periods.channels[inputs..].iter().map(Vec::as_slice).collect();
    let coefficients = period_coefficients(&refs, periods.period, lines)?;
    let width = outputs * lines.len();
    let mut departures = vec![(0.0, 0.0_f64); count - late];
    for output in 0..outputs {
        let at = |p: usize, k: usize| coefficients[p * width + output * lines.len() + k];
        let (level, noise) = late_periods(at, count, late, lines.len());
        for (p, (sum, worst)) in departures.iter_mut().enumerate() {
            for k in 0..lines.len() {
                let departure = (at(p, k) - level[k]).norm_sqr() / noise[k];
                *sum += departure / width as f64;
                *worst = worst.max(departure);
            }
        }
    }
    let freedom = (late - 1) * pooled_lines(late, lines.len());
    // The mean of F is above one, and the later mean has noise too.
    let scale = 1.0 + 1.0 / late as f64;
    let inflated = scale * freedom as f64 / (freedom as f64 - 1.0).max(0.5);
    let all = inflated * chi_squared_quantile(1.0 - CHANCE, 2.0 * width as f64) / (2.0 * width as f64);
    let one = scale * largest_by_chance(freedom, width);
    let moved = departures.iter().take_while(|(sum, worst)| *sum > all || *worst > one).count();
    let still = moved == departures.len();
    Ok((if moved == 0 { 0 } else { (moved + 1).min(departures.len()) }, still))
}

/// Lines over which a variance from so many periods is averaged.
fn pooled_lines(periods: usize, lines: usize) -> usize {
    let reach = POOLED_FREEDOM.div_ceil(2 * (periods - 1)) / 2;
    (2 * reach + 1).min(lines)
}

/// Mean and variance of each line over the later periods, the variances averaged over neighbouring lines.
fn late_periods(
    at: impl Fn(usize, usize) -> Complex64,
    count: usize,
    late: usize,
    lines: usize,
) -> (Vec<Complex64>, Vec<f64>) {
    let mean = |k: usize| (count - late..count).map(|p| at(p, k)).sum::<Complex64>() / late as f64;
    let level: Vec<Complex64> = (0..lines).map(mean).collect();
    let scatter = |k: usize| (count - late..count).map(|p| (at(p, k) - level[k]).norm_sqr()).sum::<f64>();
    let own: Vec<f64> = (0..lines).map(|k| scatter(k) / (late - 1) as f64).collect();
    let rounding = level.iter().map(|v| v.norm_sqr()).fold(0.0, f64::max) * 1e-18 + f64::MIN_POSITIVE;
    let noise = pooled(&own, pooled_lines(late, lines)).into_iter().map(|v| v.max(rounding)).collect();
    (level, noise)
}

/// Means over so many neighbours.
fn pooled(values: &[f64], width: usize) -> Vec<f64> {
    let mean = |k: usize| {
        let first = k.saturating_sub(width / 2).min(values.len() - width);
        values[first..first + width].iter().sum::<f64>() / width as f64
    };
    (0..values.len()).map(mean).collect()
}
