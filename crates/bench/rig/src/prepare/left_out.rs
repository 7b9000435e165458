//! Samples that are treated as missing: those that hold no value of their own, and spikes.

use std::ops::Range;

use signal::quality::{QualityOptions, check_quality};
use signal::updates::{Stale, Staleness, find_stale};

use crate::diagnostics::{Finding, Severity};
use crate::experiment::{ControlMode, ExperimentLabel};
use crate::prepare::log::Log;
use crate::prepare::samples::is_measured;
use crate::prepare::source::Source;
use crate::role::Role;

/// Probability that a series of Gaussian values shows a spike: a campaign has tens of series.
const SPIKE_FALSE_ALARM: f64 = 1e-6;
/// A slower controller's demand rests for more of its samples.
const MINORITY: f64 = 0.5;
/// T_d* may rest where N_d rested up to so many samples before: a controller is no later. At this part of its repeats,
/// beyond those by chance, it follows N_d.
const LATEST: usize = 20;
const FOLLOWS: f64 = 0.5;
/// A demand with more pulses of one sample than this part of its samples is meant to have them.
const MOST_PULSES: f64 = 0.01;
/// A torque this part of the demanded range beyond that range was not demanded: a drive overshoots less.
const BEYOND_DEMAND: f64 = 0.5;

/// Which samples of a channel are left out, one entry a sample, or none at all. Why is noted. A demand may be held:
/// only a T_d* of a speed controller that rests for a minority of its samples does not.
pub(super) fn samples(source: &Source<'_>, all: &[Source<'_>], label: &ExperimentLabel, log: &mut Log) -> Vec<bool> {
    let is_computed = source.role == Role::DynoTorqueDemand && label.mode == ControlMode::Nt;
    if !is_measured(source.role) && !is_computed {
        return if source.role.is_demand() { spikes_of_demand(source, log) } else { Vec::new() };
    }
    match find_stale(source.samples) {
        Some(stale) if !is_computed || is_repeated_at_times(&stale) && !rests_with_speed(source, &stale, all) => {
            stale_samples(source, stale, log)
        }
        None if !is_computed => spikes(source, all, log),
        _ => Vec::new(),
    }
}

fn is_repeated_at_times(stale: &Stale) -> bool {
    matches!(stale.how, Staleness::Repeated { .. }) && stale.share() < MINORITY
}

/// Tells whether T_d* repeats where N_d has, some samples before: a controller that sees the same as before demands the
/// same. N_d in steps repeats by chance, and T_d* then changes by multiples of what one of these steps makes of it.
fn rests_with_speed(demand: &Source<'_>, stale: &Stale, all: &[Source<'_>]) -> bool {
    let is_on_clock = |source: &&Source<'_>| source.time_s.len() == demand.time_s.len();
    let Some(speed) = all.iter().find(|source| source.role == Role::DynoSpeed).filter(is_on_clock) else {
        return false;
    };
    let rests: Vec<bool> = speed.samples.windows(2).map(|pair| pair[0] == pair[1]).collect();
    let share = |of: &dyn Fn(usize) -> bool| {
        let counted = rests.iter().enumerate().filter(|(i, _)| of(*i));
        let (resting, all) =
            counted.fold((0.0, 0.0), |(sum, all), (_, rests)| (sum + f64::from(u8::from(*rests)), all + 1.0));
        resting / f64::max(all, 1.0)
    };
    let by_chance = share(&|_| true);
    let before = |lag: usize| share(&|i| stale.samples.get(i + 1 + lag).is_some_and(|is_stale| *is_stale));
    (0..=LATEST).any(|lag| before(lag) - by_chance > FOLLOWS * (1.0 - by_chance))
}

fn stale_samples(source: &Source<'_>, stale: Stale, log: &mut Log) -> Vec<bool> {
    let first = stale.samples.iter().position(|is_stale| *is_stale);
    let share = stale.share();
    let (finding, severity) = match stale.how {
        Staleness::Held { every } => (Finding::SamplesRaised { every, interpolated: false }, Severity::Warning),
        Staleness::Interpolated { every } => (Finding::SamplesRaised { every, interpolated: true }, Severity::Warning),
        Staleness::Straightened => (Finding::SamplesStraightened { share }, Severity::Error),
        Staleness::Repeated { longest: Range { start, end } } => {
            let time_s = |i: usize| source.time_s.get(i).copied().unwrap_or(f64::NAN);
            let longest_s = time_s(end - 1) - time_s(start.saturating_sub(1));
            (Finding::SamplesRepeated { share, longest_s }, Severity::of_share(share))
        }
    };
    let is_lost = matches!(finding, Finding::SamplesStraightened { .. });
    let time_s = first.and_then(|i| source.time_s.get(i).copied());
    log.channel(severity, source.channel, time_s, finding);
    if is_lost { Vec::new() } else { stale.samples }
}

fn spikes(source: &Source<'_>, all: &[Source<'_>], log: &mut Log) -> Vec<bool> {
    let possible = demanded(source.role, all);
    let si = |i: &usize| source.factor * source.samples[*i];
    spikes_if(source, &|i| possible.as_ref().is_none_or(|range| !range.contains(&si(i))), log)
}

/// Spikes of a channel whose samples are impossible.
pub(super) fn spikes_if(source: &Source<'_>, is_impossible: &dyn Fn(&usize) -> bool, log: &mut Log) -> Vec<bool> {
    let options = QualityOptions { spike_false_alarm: SPIKE_FALSE_ALARM, ..QualityOptions::default() };
    let Ok(quality) = check_quality(source.samples, &options) else { return Vec::new() };
    left_out(source, quality.spikes.into_iter().filter(is_impossible).collect(), log)
}

/// Single samples of a held demand beyond those before and after them, which rest: no controller asks for a torque or a
/// speed for one sample. A demand that changes from sample to sample, or often for one, has none.
fn spikes_of_demand(source: &Source<'_>, log: &mut Log) -> Vec<bool> {
    let x = source.samples;
    let resting = x.windows(2).filter(|pair| pair[0] == pair[1]).count();
    if (resting as f64) < MINORITY * x.len() as f64 {
        return Vec::new();
    }
    let is_spike = |around: &[f64]| {
        let [before, one, after] = [around[1], around[2], around[3]];
        let is_beyond = one > before.max(after) || one < before.min(after);
        // What a spike beside it interrupts goes on behind that.
        let is_alone = one != around[0] && one != around[4];
        is_beyond && is_alone && (around[0] == before || after == around[4])
    };
    let found: Vec<usize> = x.windows(5).enumerate().filter(|(_, w)| is_spike(w)).map(|(i, _)| i + 2).collect();
    if found.len() as f64 > MOST_PULSES * x.len() as f64 {
        return Vec::new();
    }
    left_out(source, found, log)
}

/// Notes spikes, and leaves them out.
fn left_out(source: &Source<'_>, found: Vec<usize>, log: &mut Log) -> Vec<bool> {
    let si = |i: &usize| source.factor * source.samples[*i];
    let Some(first) = found.first() else { return Vec::new() };
    let usual = numerics::order::lower_median_streamed(|| source.samples.iter().copied().filter(|v| v.is_finite()));
    let from_usual = |i: &usize| (source.samples[*i] - usual.unwrap_or(0.0)).abs();
    let farthest = found.iter().max_by(|a, b| from_usual(a).total_cmp(&from_usual(b))).map_or(0.0, si);
    let time_s = source.time_s.get(*first).copied();
    let severity = Severity::of_share(found.len() as f64 / source.samples.len() as f64);
    log.channel(severity, source.channel, time_s, Finding::Spikes { count: found.len(), farthest });
    let mut left_out = vec![false; source.samples.len()];
    found.into_iter().for_each(|i| left_out[i] = true);
    left_out
}

/// The range that a torque of the dynamometer can have by its demand, Nm: what the drive does in one sample may look
/// like a spike. Any value is possible for a torque without a recorded demand; none of a speed beside its neighbours
/// is.
fn demanded(role: Role, all: &[Source<'_>]) -> Option<Range<f64>> {
    match role {
        Role::DynoSpeed | Role::EngineSpeed => return None,
        Role::AirGapTorque | Role::LoadCellTorque => {}
        _ => return Some(f64::NEG_INFINITY..f64::INFINITY),
    }
    let Some(demand) = all.iter().find(|source| source.role == Role::DynoTorqueDemand) else {
        return Some(f64::NEG_INFINITY..f64::INFINITY);
    };
    let values = demand.samples.iter().map(|x| demand.factor * x).filter(|x| x.is_finite());
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    let beyond = BEYOND_DEMAND * (high - low);
    Some(low - beyond..high + beyond)
}
