//! From time stamps to uniform clocks: order, jitter, gaps and missing samples.

use std::f64::consts::TAU;

use signal::Signal;
use signal::clock::{ClockCheck, check_clock, fitted_clock, tick};
use units::Quantity;

use crate::diagnostics::{Finding, Severity};
use crate::prepare::log::Log;
use crate::prepare::source::{Source, Stretches};

/// A gap no longer than this is interpolated, s.
const SHORT_GAP_S: f64 = 0.02;
/// A gap no longer than this many samples is interpolated.
const SHORT_GAP_SAMPLES: usize = 5;
/// Above this share of samples that are not numbers a channel is refused.
const MOST_NOT_A_NUMBER: f64 = 0.1;
/// A uniform clock with more samples than this many times those that were recorded is none: stamps come in bursts, as
/// of a logger that writes in batches. What is interpolated would be nearly all, and more than a memory holds.
const MOST_TICKS: f64 = 10.0;
/// Time stamps further from a uniform clock than this share of the sample time are interpolated onto one.
const JITTER_SHARE: f64 = 0.1;
/// Time stamps closer to a uniform clock than this share of the sample time are rounded, not jittering.
const EXACT_SHARE: f64 = 1e-6;

/// The channel on a uniform clock, in SI, or `None` if it is refused.
pub(super) fn uniform_stretches(source: &Source<'_>, left_out: &[bool], log: &mut Log) -> Option<Stretches> {
    let (time_s, mut values) = numbers(source, left_out, log)?;
    let check = checked(source, &time_s, log)?;
    let is_angle = source.unit.quantity == Quantity::Angle;
    if is_angle {
        unwrap(&mut values);
    }
    let is_short = |missing: usize, duration_s: f64| {
        missing <= SHORT_GAP_SAMPLES || duration_s <= SHORT_GAP_S + 0.5 * check.sample_time_s
    };
    let long = check.gaps.iter().filter(|gap| !is_short(gap.missing, gap.duration_s));
    let mut stretches = Vec::new();
    let mut first = 0;
    for end in long.map(|gap| gap.between.end).chain([time_s.len()]) {
        if is_in_bursts(&time_s[first..end], check.sample_time_s) {
            let mean_s = (time_s[end - 1] - time_s[first]) / (end - first) as f64;
            let finding = Finding::Bursts { sample_time_s: check.sample_time_s, mean_s };
            log.channel(Severity::Error, source.channel, Some(time_s[first]), finding);
            return None;
        }
        let own = stretch(&time_s[first..end], &values[first..end], check.sample_time_s);
        stretches.extend(if is_angle { own.and_then(|angle| rate(&angle)) } else { own });
        first = end;
    }
    report_gaps(source, &time_s, &check, &is_short, log);
    report_jitter(source, &stretches, &time_s, check.sample_time_s, log);
    (!stretches.is_empty()).then_some(stretches)
}

/// Tells whether a clock of this sample time would have far more samples than there are stamps.
fn is_in_bursts(time_s: &[f64], sample_time_s: f64) -> bool {
    let (Some(first), Some(last)) = (time_s.first(), time_s.last()) else { return false };
    (last - first) / sample_time_s > MOST_TICKS * time_s.len() as f64
}

/// Takes the jumps out of an angle that starts anew with every turn, rad.
fn unwrap(angle: &mut [f64]) {
    let (low, high) = angle.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), a| (l.min(*a), h.max(*a)));
    if high - low > TAU {
        return;
    }
    let (mut turns, mut before) = (0.0, angle.first().copied().unwrap_or_default());
    for a in angle {
        turns -= ((*a - before) / TAU).round();
        before = *a;
        *a += TAU * turns;
    }
}

/// The speed of an angle: its mean from the sample before, dated at the end, as that of an encoder with a gate of one
/// sample.
fn rate(angle: &Signal) -> Option<Signal> {
    let step_s = angle.sample_time_s;
    let speeds = angle.samples.windows(2).map(|pair| (pair[1] - pair[0]) / step_s).collect();
    Signal::new(angle.start_s + step_s, step_s, speeds).ok()
}

/// Time stamps and values in SI of the samples that are numbers and not left out; the others are treated as missing.
fn numbers(source: &Source<'_>, left_out: &[bool], log: &mut Log) -> Option<(Vec<f64>, Vec<f64>)> {
    let pairs = source.time_s.iter().zip(source.samples);
    let total = pairs.len();
    let count = source.samples[..total].iter().filter(|value| !value.is_finite()).count();
    let is_left_out = |i: usize| left_out.get(i).copied().unwrap_or(false);
    let kept = pairs.enumerate().filter(|(i, (_, value))| value.is_finite() && !is_left_out(*i));
    let (time_s, values): (Vec<f64>, Vec<f64>) = kept.map(|(_, (time, value))| (*time, value * source.factor)).unzip();
    if count == 0 && total >= 2 {
        return Some((time_s, values));
    }
    let first = source.samples.iter().position(|value| !value.is_finite());
    let when = first.and_then(|index| source.time_s.get(index).copied());
    let mended = values.len() >= 2 && count as f64 <= MOST_NOT_A_NUMBER * total as f64;
    let finding = match count {
        0 => Finding::TooShort { duration_s: 0.0, needed_s: 0.0 },
        count => Finding::NotANumber { count, mended },
    };
    let severity = if mended { Severity::of_share(count as f64 / total as f64) } else { Severity::Error };
    log.channel(severity, source.channel, when, finding);
    mended.then_some((time_s, values))
}

/// The clock behind the time stamps, if they rise throughout.
fn checked(source: &Source<'_>, time_s: &[f64], log: &mut Log) -> Option<ClockCheck> {
    let broken = time_s.iter().position(|time| !time.is_finite());
    let fallen = || time_s.windows(2).position(|pair| pair[1] <= pair[0]).map(|index| index + 1);
    if let Some(index) = broken.or_else(fallen) {
        let when = time_s.get(index).copied().filter(|time| time.is_finite());
        log.channel(Severity::Error, source.channel, when, Finding::TimeNotIncreasing);
        return None;
    }
    check_clock(time_s).ok()
}

/// One uninterrupted stretch on a uniform clock. A single sample is none.
fn stretch(time_s: &[f64], values: &[f64], typical_s: f64) -> Option<Signal> {
    let (first, last) = (*time_s.first()?, *time_s.last()?);
    let intervals = ((last - first) / typical_s).round();
    if intervals < 1.0 {
        return None;
    }
    let mut clock = (first, (last - first) / intervals);
    let count = intervals as usize + 1;
    if largest_deviation(time_s, clock) > EXACT_SHARE * clock.1 {
        clock = fitted_clock(time_s, clock).unwrap_or(clock);
    }
    let is_whole = count == values.len() && largest_deviation(time_s, clock) <= JITTER_SHARE * clock.1;
    let samples = if is_whole { values.to_vec() } else { interpolated(time_s, values, clock, count) };
    Signal::new(clock.0, clock.1, samples).ok()
}

/// Largest distance of time stamps from the nearest tick of a clock, s.
fn largest_deviation(time_s: &[f64], clock: (f64, f64)) -> f64 {
    let deviation = |time: &f64| (time - clock.0 - tick(*time, clock) * clock.1).abs();
    time_s.iter().map(deviation).fold(0.0, f64::max)
}

/// Values on a uniform clock, on straight lines between the samples. The time stamps rise.
fn interpolated(time_s: &[f64], values: &[f64], clock: (f64, f64), count: usize) -> Vec<f64> {
    let mut left = 0;
    let value = |i: usize| {
        let time = clock.0 + i as f64 * clock.1;
        while left + 2 < time_s.len() && time_s[left + 1] <= time {
            left += 1;
        }
        let share = (time - time_s[left]) / (time_s[left + 1] - time_s[left]);
        values[left] + share.clamp(0.0, 1.0) * (values[left + 1] - values[left])
    };
    (0..count).map(value).collect()
}

fn report_gaps(
    source: &Source<'_>,
    time_s: &[f64],
    check: &ClockCheck,
    is_short: &dyn Fn(usize, f64) -> bool,
    log: &mut Log,
) {
    let short: Vec<_> = check.gaps.iter().filter(|gap| is_short(gap.missing, gap.duration_s)).collect();
    let longest_s = short.iter().map(|gap| gap.duration_s).fold(0.0, f64::max);
    match short[..] {
        [] => {}
        [gap] => {
            let finding = Finding::Gap { duration_s: gap.duration_s, mended: true };
            log.channel(Severity::Note, source.channel, time_s.get(gap.between.start).copied(), finding);
        }
        [first, ..] => {
            let missing: usize = short.iter().map(|gap| gap.missing).sum();
            let share = missing as f64 / (missing + time_s.len()) as f64;
            let severity = Severity::of_share(share);
            let finding = Finding::ShortGaps { count: short.len(), longest_s, share };
            log.channel(severity, source.channel, time_s.get(first.between.start).copied(), finding);
        }
    }
    for gap in check.gaps.iter().filter(|gap| !is_short(gap.missing, gap.duration_s)) {
        let finding = Finding::Gap { duration_s: gap.duration_s, mended: false };
        log.channel(Severity::Warning, source.channel, time_s.get(gap.between.start).copied(), finding);
    }
}

/// Notes the largest distance of the time stamps from the clocks that stand for them.
fn report_jitter(source: &Source<'_>, stretches: &[Signal], time_s: &[f64], sample_time_s: f64, log: &mut Log) {
    let deviation = |time: f64| {
        let stretch = stretches.iter().find(|stretch| time <= stretch.end_s() + 0.5 * stretch.sample_time_s)?;
        Some(largest_deviation(&[time], (stretch.start_s, stretch.sample_time_s)))
    };
    let deviations = time_s.iter().map(|&time| (time, deviation(time).unwrap_or(0.0)));
    let Some((time, largest_s)) = deviations.max_by(|a, b| a.1.total_cmp(&b.1)) else { return };
    if largest_s > JITTER_SHARE * sample_time_s {
        log.channel(Severity::Warning, source.channel, Some(time), Finding::Jitter { largest_s, sample_time_s });
    }
}
