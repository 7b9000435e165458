//! The stretches of a recording in which the dynamometer turns by itself.

use std::ops::Range;

use numerics::{order, vector};
use part_torque::torque_control;
use rig::estimation::timing_floor_s;
use rig::prepare::wrong_sign;
use rig::results::Stretch;
use rig::{Experiment, Role};
use signal::{Signal, runs};

use super::FrictionError;
use crate::fitted::Fitted;
use crate::options::{FrictionOptions, LONGEST_DELAY_S, RunOut, Term, TorqueUsed};

/// Shortest stretch, s: alone, and where T_d drives.
const SHORTEST_S: f64 = 1.0;
const SHORTEST_DRIVEN_S: f64 = 0.25;
/// Slower than this part of the highest speed, ...
const SLOWEST_PART: f64 = 0.02;
/// ... and than so many rad/s, is left out.
const SLOWEST_RAD_S: f64 = 1.0;
/// Of a machine that is slow itself no more than this part of its highest speed is left out.
const SLOWEST_OF_SLOW: f64 = 0.1;
/// A sample drops out that is off the median of those about it by this part of it.
const DROPPED: f64 = 0.1;
/// Samples on either side of that median.
const ABOUT: usize = 3;
/// All speeds within this part of the highest are one speed.
const STEADY: f64 = 0.02;
/// Over this the speed is averaged to see whether it falls, s.
const FALL_S: f64 = 1.0;
/// The torque control is taken from a recording where its error is less than this part of what T_d does.
const DISAGREES: f64 = 0.05;
/// The clock of T_d,calc is ahead of that of T_d* by at most this, s.
const AHEAD_S: f64 = 0.01;
/// Values of the modelled T_d in a sample of T_d*.
const FINER: usize = 4;
/// Samples of T_d over which means hardly see its course within a sample, which is not recorded.
const SAMPLES_OF_TORQUE: f64 = 5.0;
/// Means over this hardly see what a load cell does to T_d beyond being late, s.
const BLOCK_OF_CELL_S: f64 = 0.1;
/// T_d jumps where it changes from one sample to the next by more than so many times its usual change (rms), ...
const JUMP_TIMES_RMS: f64 = 3.0;
/// ... and by this part of the most.
const JUMP_PART: f64 = 0.25;
/// T_d is averaged over this to see what it does beyond noise and ripple, s.
const BLOCK_S: f64 = 0.05;
/// Points of a figure.
const SHOWN: usize = 600;

/// N_d on its clock, drop-outs marked and bridged, and T_d over the same time.
pub(super) struct FreeRun {
    pub(super) file: String,
    /// Without drop-outs, rad/s.
    pub(super) speed: Signal,
    pub(super) dropped: Vec<bool>,
    pub(super) torque: Option<Signal>,
    /// Source of T_d.
    pub(super) source: Option<TorqueUsed>,
    /// Means over this are compared, s; zero where every sample counts.
    pub(super) block_s: f64,
    /// Standard error of the clock of T_d against that of T_d,calc, s.
    pub(super) dated_s: f64,
}

/// T_d as it is known.
struct Torque {
    signal: Signal,
    source: TorqueUsed,
    block_s: f64,
    dated_s: f64,
}

/// The stretches of a recording in which the dynamometer turns fast enough.
pub(super) fn free_runs(experiment: &Experiment, options: FrictionOptions) -> Result<Vec<FreeRun>, FrictionError> {
    let file = || experiment.file.clone();
    if !experiment.label.is_without_shaft() {
        return Err(FrictionError::ShaftOn { file: file(), label: experiment.label.clone() });
    }
    let role = Role::DynoSpeed;
    let measured = experiment.signal(role).ok_or_else(|| FrictionError::MissingSignal { file: file(), role })?;
    let known = torque(experiment, options.torque_limit_nm)?;
    let torque = known.as_ref().map(|known| &known.signal);
    let (speed, dropped) = without_drop_outs(measured);
    let fastest = speed.samples.iter().fold(0.0, |most: f64, w| most.max(w.abs()));
    let slowest = options.slowest_rad_s.unwrap_or_else(|| match fastest {
        0.0 => SLOWEST_RAD_S,
        _ => (SLOWEST_PART * fastest).max(SLOWEST_RAD_S.min(SLOWEST_OF_SLOW * fastest)),
    });
    let is_inside =
        |t: f64| torque.is_none_or(|x| t - LONGEST_DELAY_S >= x.start_s && t + LONGEST_DELAY_S <= x.end_s());
    let is_used = |i: usize| speed.samples[i].abs() > slowest && is_inside(speed.time_s(i));
    let mut runs: Vec<Range<usize>> = runs(speed.len(), is_used).collect();
    if torque.is_none() {
        runs = runs.into_iter().filter_map(|run| longest_fall(&speed, run)).collect();
    }
    let length = |run: &Range<usize>| run.len() as f64 * speed.sample_time_s;
    let turning_s = runs.iter().map(length).fold(0.0, |sum, s| sum + s);
    let shortest_s = if torque.is_some() { SHORTEST_DRIVEN_S } else { SHORTEST_S };
    runs.retain(|run| length(run) >= shortest_s);
    if runs.is_empty() {
        return Err(FrictionError::HardlyTurns {
            file: file(),
            turning_s,
            needed_s: shortest_s,
            slowest_rad_s: slowest,
        });
    }
    let free_run = |run: Range<usize>| FreeRun {
        file: file(),
        speed: Signal {
            start_s: speed.time_s(run.start),
            sample_time_s: speed.sample_time_s,
            samples: speed.samples[run.clone()].to_vec(),
        },
        dropped: dropped[run].to_vec(),
        torque: torque.cloned(),
        source: known.as_ref().map(|known| known.source),
        block_s: known.as_ref().map_or(0.0, |known| known.block_s),
        dated_s: known.as_ref().map_or(0.0, |known| known.dated_s),
    };
    Ok(runs.into_iter().map(free_run).collect())
}

/// T_d as finely as it can be known: T_d* through the torque control that this recording itself shows, where T_d,calc
/// agrees with it, since T_d,calc dates the edges of T_d no better than to its own sample; else T_d,calc, or the load
/// cell.
fn torque(experiment: &Experiment, torque_limit_nm: Option<f64>) -> Result<Option<Torque>, FrictionError> {
    let roles = [(Role::AirGapTorque, TorqueUsed::Calculated), (Role::LoadCellTorque, TorqueUsed::LoadCell)];
    let found = roles.into_iter().find_map(|(role, source)| Some((experiment.signal(role)?, role, source)));
    let Some((recorded, role, source)) = found else { return Ok(None) };
    if wrong_sign(experiment, role).is_some() {
        return Err(FrictionError::WrongSign { file: experiment.file.clone(), role });
    }
    // Few edges, each at the same place between two samples, date T_d,calc no better than any sample is dated.
    let own_s = timing_floor_s(recorded.sample_time_s);
    let modelled = || {
        let demand = experiment.signal(Role::DynoTorqueDemand)?;
        // Where the clock of T_d,calc is ahead, it would answer before it is asked, which no torque control does.
        let mut later = experiment.clone();
        later.signals.get_mut(&Role::AirGapTorque)?.start_s += AHEAD_S;
        let fit = torque_control::estimate(&later, torque_limit_nm).ok()?;
        let (model, delay) = (fit.model, fit.result.delay_and_lag.parameters.get(2)?);
        let spread = vector::standard_deviation(&recorded.samples);
        let agrees = model.residual.standard_deviation_nm < DISAGREES * spread;
        agrees.then(|| {
            let torque = model.finer_air_gap_torque(demand, FINER);
            Torque {
                signal: Signal { start_s: torque.start_s - AHEAD_S, ..torque },
                source: TorqueUsed::Modelled,
                block_s: 0.0,
                dated_s: delay.standard_error.min(recorded.sample_time_s).hypot(own_s),
            }
        })
    };
    let least_s = if source == TorqueUsed::LoadCell { BLOCK_OF_CELL_S } else { 0.0 };
    let as_recorded = || Torque {
        signal: recorded.clone(),
        source,
        block_s: least_s.max(SAMPLES_OF_TORQUE * recorded.sample_time_s),
        dated_s: own_s,
    };
    Ok(Some(modelled().unwrap_or_else(as_recorded)))
}

/// Refuses speeds that show nothing.
pub(super) fn check_range(free_runs: &[FreeRun]) -> Result<(), FrictionError> {
    let (from_rad_s, to_rad_s) = speeds(free_runs);
    match free_runs.first() {
        Some(first) if to_rad_s - from_rad_s < STEADY * to_rad_s.abs().max(from_rad_s.abs()) => {
            Err(FrictionError::SteadySpeed { file: first.file.clone(), from_rad_s, to_rad_s })
        }
        _ => Ok(()),
    }
}

/// Which way it turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Directions {
    One,
    Both,
}

impl Directions {
    /// These terms, with the offset where it is separated from them.
    pub(super) fn with(self, terms: &[Term]) -> Vec<Term> {
        let offset = (self == Directions::Both).then_some(Term::Offset);
        offset.into_iter().chain(terms.iter().copied()).collect()
    }
}

/// Directions in which the free runs turn.
pub(super) fn directions(free_runs: &[FreeRun]) -> Directions {
    let (low, high) = speeds(free_runs);
    if low < 0.0 && high > 0.0 { Directions::Both } else { Directions::One }
}

/// Lowest and highest speed.
pub(super) fn speeds(free_runs: &[FreeRun]) -> (f64, f64) {
    let all = free_runs.iter().flat_map(|free_run| &free_run.speed.samples);
    all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), w| (low.min(*w), high.max(*w)))
}

impl FreeRun {
    pub(super) fn stretch(&self) -> Stretch {
        Stretch { file: self.file.clone(), start_s: self.speed.start_s, end_s: self.speed.end_s() }
    }

    /// The free_run beside that of the model.
    pub(super) fn run_out(&self, fit: &Fitted) -> RunOut {
        let step = self.speed.len().div_ceil(SHOWN).max(1);
        let mut modelled = vec![0.0; self.speed.len()];
        let integral = self.torque_integral(fit.delay_s);
        let mut speed = self.speed.samples[0];
        let mut lost = 0.0;
        for (i, modelled) in modelled.iter_mut().enumerate() {
            *modelled = speed;
            lost += self.speed.sample_time_s * fit.deceleration(speed);
            let driven = integral.as_ref().map_or(0.0, |all| all.get(i + 1).copied().unwrap_or(0.0));
            speed = self.speed.samples[0] - driven / fit.inertia_kg_m2() - lost;
        }
        let at = || (0..self.speed.len()).step_by(step);
        RunOut {
            stretch: self.stretch(),
            torque: self.source,
            left_out: self.dropped.iter().filter(|d| **d).count(),
            time_s: at().map(|i| self.speed.time_s(i)).collect(),
            measured_rad_s: at().map(|i| self.speed.samples[i]).collect(),
            modelled_rad_s: at().map(|i| modelled[i]).collect(),
        }
    }

    /// T_d at the instants of N_d, `delay_s` later on its own clock, Nm.
    pub(super) fn torque_at(&self, delay_s: f64) -> Option<Vec<f64>> {
        self.torque.as_ref().map(|torque| self.read(torque, delay_s))
    }

    /// ∫T_d dt from the first sample on, Nm s; integrated on the clock of T_d.
    pub(super) fn torque_integral(&self, delay_s: f64) -> Option<Vec<f64>> {
        let torque = self.torque.as_ref()?;
        let sum = torque.with_samples(integral(&torque.samples, torque.sample_time_s));
        let all = self.read(&sum, delay_s);
        let first = all.first().copied().unwrap_or(0.0);
        Some(all.into_iter().map(|sum| sum - first).collect())
    }

    /// Sum of the jumps of T_d, Nm, at the instants of N_d, and the time between two samples within which each happens,
    /// s. None where T_d is known between its samples.
    pub(super) fn jumps(&self, delay_s: f64) -> Option<(Vec<f64>, f64)> {
        let torque = self.torque.as_ref().filter(|_| self.source != Some(TorqueUsed::Modelled))?;
        let changes: Vec<f64> = torque.samples.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let most = changes.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
        let rms = (changes.iter().map(|c| c * c).sum::<f64>() / changes.len().max(1) as f64).sqrt();
        let least = (JUMP_TIMES_RMS * rms).max(JUMP_PART * most);
        let mut sum = 0.0;
        let sums = changes.iter().map(|change| {
            sum += if change.abs() > least { *change } else { 0.0 };
            sum
        });
        let jumped = torque.with_samples(std::iter::once(0.0).chain(sums).collect());
        Some((self.read(&jumped, delay_s), torque.sample_time_s))
    }

    /// A signal at the instants of N_d, `late_s` later on its own clock.
    fn read(&self, signal: &Signal, late_s: f64) -> Vec<f64> {
        let last = signal.len().saturating_sub(2) as f64;
        let value = |i: usize| {
            let position = (self.speed.time_s(i) + late_s - signal.start_s) / signal.sample_time_s;
            let below = position.floor().clamp(0.0, last.max(0.0));
            let here = signal.samples[below as usize];
            let next = signal.samples.get(below as usize + 1).unwrap_or(&here);
            here + (next - here) * (position - below).clamp(0.0, 1.0)
        };
        (0..self.speed.len()).map(value).collect()
    }

    /// Means of T_d, Nm, and of N_d, rad/s, over blocks, and the duration of one.
    pub(super) fn blocks(&self) -> Option<(Vec<(f64, f64)>, f64)> {
        let torque = self.torque_at(0.0)?;
        let length = ((BLOCK_S / self.speed.sample_time_s) as usize).max(1);
        let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
        let pairs = torque.chunks_exact(length).zip(self.speed.samples.chunks_exact(length));
        Some((pairs.map(|(t, w)| (mean(t), mean(w))).collect(), length as f64 * self.speed.sample_time_s))
    }
}

/// The largest torque that can have slowed a dynamometer of this inertia: what T_d and the change of its speed come to,
/// Nm.
pub(super) fn largest_torque_nm(free_runs: &[FreeRun], inertia_kg_m2: f64) -> f64 {
    let of_course = |free_run: &FreeRun| {
        let length = ((BLOCK_S / free_run.speed.sample_time_s) as usize).max(1);
        let block_s = length as f64 * free_run.speed.sample_time_s;
        let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
        let speeds: Vec<f64> = free_run.speed.samples.chunks_exact(length).map(mean).collect();
        let torques = free_run.torque_at(0.0).unwrap_or_default();
        let braked = torques.chunks_exact(length).map(|part| mean(part).abs()).fold(0.0, f64::max);
        let change = |pair: &[f64]| inertia_kg_m2 * (pair[1] - pair[0]).abs() / block_s;
        braked + speeds.windows(2).map(change).fold(0.0, f64::max)
    };
    free_runs.iter().map(of_course).fold(0.0, f64::max)
}

/// The integral by the rule of trapezia, zero at the first sample.
pub(super) fn integral(values: &[f64], step_s: f64) -> Vec<f64> {
    let mut sum = 0.0;
    let mut all = Vec::with_capacity(values.len());
    for (i, value) in values.iter().enumerate() {
        if i > 0 {
            sum += 0.5 * step_s * (values[i - 1] + value);
        }
        all.push(sum);
    }
    all
}

/// The speed with samples that drop out bridged by their neighbours, and which these are.
fn without_drop_outs(speed: &Signal) -> (Signal, Vec<bool>) {
    let x = &speed.samples;
    let is_dropped = |i: usize| {
        let mut about = x[i.saturating_sub(ABOUT)..(i + ABOUT + 1).min(x.len())].to_vec();
        let dropped = |median: f64| (x[i] - median).abs() > DROPPED * median.abs() && median.abs() > SLOWEST_RAD_S;
        order::upper_median(&mut about).is_some_and(dropped)
    };
    let dropped: Vec<bool> = (0..x.len()).map(is_dropped).collect();
    let mut mended = x.clone();
    for i in (0..x.len()).filter(|i| dropped[*i]) {
        let before = (0..i).rev().find(|j| !dropped[*j]);
        let after = (i + 1..x.len()).find(|j| !dropped[*j]);
        mended[i] = match (before, after) {
            (Some(b), Some(a)) => x[b] + (x[a] - x[b]) * (i - b) as f64 / (a - b) as f64,
            (Some(only), None) | (None, Some(only)) => x[only],
            (None, None) => x[i],
        };
    }
    (speed.with_samples(mended), dropped)
}

/// The longest part of a run in which the speed falls from one second to the next.
fn longest_fall(speed: &Signal, Range { start: from, end: to }: Range<usize>) -> Option<Range<usize>> {
    let window = ((FALL_S / speed.sample_time_s) as usize).max(1);
    let mean = |i: usize| speed.samples[i..i + window].iter().map(|w| w.abs()).sum::<f64>();
    let last = to.checked_sub(2 * window)?;
    let falls: Vec<bool> = (from..last.max(from)).map(|i| mean(i + window) < mean(i)).collect();
    let longest = runs(falls.len(), |i| falls[i]).max_by_key(ExactSizeIterator::len)?;
    Some(from + longest.start..(from + longest.end + 2 * window).min(to))
}
