//! Demands on the bench: sines, and how long each value was held.

use rig::{ControlMode, Experiment, Role};
use signal::Signal;
use signal::periodicity::{Sinusoid, find_sinusoids};

use crate::segments::steady_sines;

/// Sines that a demand may be made of, at most; the share of it that they leave at most; the least of the largest that
/// counts.
const MOST_SINES: usize = 40;
const REST: f64 = 0.1;
const LEAST: f64 = 0.002;
/// Probability with which chance makes a sine.
const FALSE_ALARM: f64 = 1e-9;
/// Sines that are demanded one after another make up at least this share of a recording, and last this long each.
const ONE_AFTER_ANOTHER: f64 = 0.5;
const LONG_S: f64 = 2.0;
/// Longest hold that is looked for, and the share of changes that keep to it.
const LONGEST_HOLD_S: f64 = 0.2;
const KEPT: f64 = 0.97;
/// A demand that is held changes at so many of the instants at which it may; one that is made of sines hardly ever
/// rests.
const OFTEN: f64 = 0.2;
const MOVING: f64 = 0.7;

/// A part of a recording over which the demand is of one kind.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stretch {
    pub(super) start_s: f64,
    pub(super) end_s: f64,
    /// Sines that are demanded, Hz.
    pub(super) sines_hz: Vec<f64>,
}

/// The demand that the experimenter sets: that of T_d where the dynamometer controls it, else that of N_d.
pub(super) fn demand_role(experiment: &Experiment) -> Role {
    match experiment.label.mode {
        ControlMode::Tn => Role::DynoTorqueDemand,
        ControlMode::Nt => Role::DynoSpeedDemand,
    }
}

/// The parts of a recording: each of the sines of a sine test, else all that every signal covers.
pub(super) fn stretches(experiment: &Experiment) -> Vec<Stretch> {
    let start_s = experiment.signals.values().map(|s| s.start_s).fold(f64::NEG_INFINITY, f64::max);
    let end_s = experiment.signals.values().map(Signal::end_s).fold(f64::INFINITY, f64::min);
    let Some(demand) = experiment.signal(demand_role(experiment)) else {
        return vec![Stretch { start_s, end_s, sines_hz: Vec::new() }];
    };
    let sines: Vec<_> = steady_sines(demand).into_iter().filter(|s| s.end_s - s.start_s >= LONG_S).collect();
    if sines.len() > 1 && sines.iter().map(|s| s.end_s - s.start_s).sum::<f64>() > ONE_AFTER_ANOTHER * (end_s - start_s)
    {
        let one = |s: crate::segments::Segment| Stretch {
            start_s: s.start_s.max(start_s),
            end_s: s.end_s.min(end_s),
            sines_hz: vec![s.frequency_hz],
        };
        return sines.into_iter().map(one).filter(|s| s.end_s - s.start_s >= LONG_S).collect();
    }
    vec![Stretch { start_s, end_s, sines_hz: sines_of(&demand.slice(start_s, end_s)) }]
}

/// The sines of a demand that is made of them; none of any other, such as one that steps or rests between ramps.
fn sines_of(demand: &Signal) -> Vec<f64> {
    let hold_s = held_hz(demand).map_or(demand.sample_time_s, |held_hz| 1.0 / held_hz);
    let ticks = demand.duration_s() / hold_s;
    if (changes(demand).len() as f64) < MOVING * ticks {
        return Vec::new();
    }
    let Ok(found) = find_sinusoids(&demand.samples, demand.sample_time_s, MOST_SINES, FALSE_ALARM) else {
        return Vec::new();
    };
    let mean = demand.mean().unwrap_or(0.0);
    let power = demand.samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / demand.len().max(1) as f64;
    let explained: f64 = found.iter().map(|s| 0.5 * s.amplitude * s.amplitude).sum();
    // Above half the rate of the demand there are images alone.
    let highest_hz = held_hz(demand).map_or(f64::INFINITY, |held_hz| 0.5 * held_hz);
    let is_made_of_them = explained > (1.0 - REST) * power;
    let least = LEAST * found.iter().map(|s| s.amplitude).fold(0.0, f64::max);
    let is_one = |s: &Sinusoid| is_made_of_them && s.freq_hz < highest_hz && s.amplitude > least;
    found.into_iter().filter(is_one).map(|s| s.freq_hz).collect()
}

/// How often a demand that is held changes, Hz; none where it may change with every sample, or never does.
pub(super) fn held_hz(demand: &Signal) -> Option<f64> {
    let changes = changes(demand);
    let steps = || changes.windows(2).map(|w| w[1] - w[0]);
    let longest = (LONGEST_HOLD_S / demand.sample_time_s).round() as usize;
    let keeps = |hold: &usize| steps().filter(|step| step.is_multiple_of(*hold)).count() as f64;
    let enough = KEPT * steps().count() as f64;
    let hold = (2..=longest).rev().filter(|_| changes.len() > 2).find(|hold| keeps(hold) >= enough)?;
    // Steps that are far apart keep to any clock.
    let is_often = changes.len() as f64 * hold as f64 > OFTEN * demand.len() as f64;
    is_often.then(|| 1.0 / (hold as f64 * demand.sample_time_s))
}

/// Samples that differ from the one before.
fn changes(demand: &Signal) -> Vec<usize> {
    (1..demand.len()).filter(|k| demand.samples[*k] != demand.samples[k - 1]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_the_rate_of_a_held_demand_is_found() {
        let sine = |t: f64| (std::f64::consts::TAU * 8.0 * t).sin();
        let held = (0..3000).map(|k| sine((k / 10) as f64 * 0.01)).collect();
        let demand = Signal::new(0.0, 1e-3, held).unwrap();
        assert!((held_hz(&demand).unwrap() - 100.0).abs() < 1e-9);
        assert_eq!(sines_of(&demand).iter().map(|f| f.round() as i64).collect::<Vec<_>>(), [8]);
        let free = Signal::new(0.0, 1e-3, (0..3000).map(|k| sine(k as f64 * 1e-3)).collect()).unwrap();
        assert_eq!(held_hz(&free), None);
    }
}
