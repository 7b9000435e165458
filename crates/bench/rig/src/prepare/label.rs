//! Check of a recording against its label: which side controls what, the shaft on or off, the excitation.

use signal::Signal;
use signal::derivative::central_difference;

use crate::align::{common_window, cut};
use crate::bench_file::BenchFile;
use crate::diagnostics::{Finding, SeenInstead, Severity};
use crate::experiment::{ControlMode, Excitation, Experiment, Test};
use crate::prepare::log::Log;
use crate::role::Role;

/// Correlation of the changes of T_d* with those of N_d from one mean over 0.1 s to the next. On recordings of ten
/// simulated benches at a constant N_d* it is 0.61 and more in speed control, and 0.10 and less in torque control.
const ANSWERS: f64 = 0.45;
/// T_d* does not answer below this correlation.
const NO_ANSWER: f64 = 0.3;
/// Means over this are compared, s.
const ANSWERS_WITHIN_S: f64 = 0.1;
/// The same correlation from one sample to the next: 0.27 and more in speed control, 0.17 and less in torque control. A
/// controller of the shaft torque answers to what moves N_d, and not to the noise of N_d.
const ANSWERS_TO_NOISE: f64 = 0.22;
/// T_d* answers to the noise of N_d up to so many samples later.
const LATEST_ANSWER: usize = 6;
/// A T_d* that is set rests for this share of its samples; one that a controller computes from a measured speed never
/// rests, but where it is recorded in coarse steps.
const RESTS: f64 = 0.5;
/// Correlation of the speeds from which on the engine turns with the dynamometer.
const TURNS_WITH_CORRELATION: f64 = 0.9;
/// The engine turns with the dynamometer where their means differ by less than this share.
const TURNS_WITH_WITHIN: f64 = 0.02;
/// An inertia this many times J_d is not that of the dynamometer alone.
const LARGER: f64 = 1.2;
/// Means over this are compared to see what T_d moves, s.
const BLOCK_S: f64 = 0.25;
/// T_d explains this part of what the speed does, where it shows an inertia.
const EXPLAINS: f64 = 0.9;
/// A constant N_d* varies by less than this part of itself.
const CONSTANT: f64 = 0.02;

/// Tells whether the label is wrong beyond doubt; notes the evidence against it.
pub(super) fn contradicts(experiment: &Experiment, bench_file: &BenchFile, log: &mut Log) -> bool {
    let Some((seen, severity)) = seen_instead(experiment, bench_file) else { return false };
    log.file(severity, None, Finding::LabelContradicted { label: experiment.label.clone(), seen });
    severity == Severity::Error
}

fn seen_instead(experiment: &Experiment, bench_file: &BenchFile) -> Option<(SeenInstead, Severity)> {
    let error = |seen| Some((seen, Severity::Error));
    let label = &experiment.label;
    if label.is_without_shaft() {
        if turns_with(experiment) {
            return error(SeenInstead::ShaftOn);
        }
        let ratio = moved_inertia_kg_m2(experiment)? / bench_file.dynamometer_inertia_kg_m2;
        return (ratio > LARGER).then_some((SeenInstead::LargerInertia { ratio }, Severity::Warning));
    }
    match (label.mode, label.excitation, answers(experiment)) {
        (ControlMode::Tn, _, Some(Answer::ToSpeed)) => error(SeenInstead::SpeedControl),
        (ControlMode::Nt, Excitation::Torque, Some(Answer::Rests)) => error(SeenInstead::TorqueControl),
        (ControlMode::Nt, Excitation::Torque, _) if label.test == Test::Bs => {
            let demand = experiment.signal(Role::DynoSpeedDemand)?;
            let changes = spread(&demand.samples)? > CONSTANT * demand.mean()?.abs();
            changes.then_some((SeenInstead::SpeedDemandChanges, Severity::Warning))
        }
        _ => None,
    }
}

/// Answer of T_d* to a change of N_d.
pub(super) enum Answer {
    ToSpeed,
    Rests,
}

pub(super) fn answers(experiment: &Experiment) -> Option<Answer> {
    let changes = |means: Vec<f64>| means.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>();
    let roles = [Role::DynoSpeed, Role::DynoTorqueDemand];
    let [speed, demand] = blocks(experiment, roles, ANSWERS_WITHIN_S)?.map(changes);
    let related = correlation(&speed, &demand).unwrap_or(0.0);
    let samples = &experiment.signal(Role::DynoTorqueDemand)?.samples;
    let resting = samples.windows(2).filter(|pair| pair[0] == pair[1]).count();
    match related {
        related if related > ANSWERS && answers_to_noise(experiment)? => Some(Answer::ToSpeed),
        related if related < NO_ANSWER && resting as f64 > RESTS * samples.len() as f64 => Some(Answer::Rests),
        _ => None,
    }
}

/// Tells whether T_d* follows N_d from sample to sample.
fn answers_to_noise(experiment: &Experiment) -> Option<bool> {
    let roles = [Role::DynoSpeed, Role::DynoTorqueDemand];
    let (from_s, to_s) = common_window(experiment, &roles)?;
    let [speed, demand] =
        [cut(experiment.signal(roles[0])?, from_s, to_s), cut(experiment.signal(roles[1])?, from_s, to_s)];
    let changes = |signal: &Signal| signal.samples.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>();
    let (of_speed, of_demand) = (changes(&speed), changes(&demand));
    let is_one_raster = (speed.sample_time_s / demand.sample_time_s - 1.0).abs() < 1e-3;
    let after = |lag: usize| correlation(&of_speed, of_demand.get(lag..)?);
    Some(is_one_raster && (0..=LATEST_ANSWER).any(|lag| after(lag).is_some_and(|related| related > ANSWERS_TO_NOISE)))
}

/// Tells whether the engine's speed follows that of the dynamometer.
pub(super) fn turns_with(experiment: &Experiment) -> bool {
    let roles = [Role::DynoSpeed, Role::EngineSpeed];
    let compared = || {
        let [dyno, engine] = blocks(experiment, roles, BLOCK_S)?;
        let (dyno_mean, engine_mean) = (mean(&dyno)?, mean(&engine)?);
        let alike = (engine_mean / dyno_mean - 1.0).abs() < TURNS_WITH_WITHIN;
        let moves = dyno.iter().any(|w| (w - dyno_mean).abs() > TURNS_WITH_WITHIN * dyno_mean.abs());
        Some(alike && (!moves || correlation(&dyno, &engine)? > TURNS_WITH_CORRELATION))
    };
    compared().unwrap_or(false)
}

/// The inertia that T_d moves, kg m², where T_d is almost all that does: −∫T_d dt over the change of ω_d, by least
/// squares.
fn moved_inertia_kg_m2(experiment: &Experiment) -> Option<f64> {
    let [speed, torque] = blocks(experiment, [Role::DynoSpeed, Role::AirGapTorque], BLOCK_S)?;
    let acceleration: Vec<f64> = central_difference(&speed, BLOCK_S).ok()?;
    let related = correlation(&acceleration, &torque)?;
    (related < -EXPLAINS).then_some(())?;
    Some(-related * spread(&torque)? / spread(&acceleration)?)
}

/// Means of two signals over blocks of the time that they share.
pub(super) fn blocks(experiment: &Experiment, roles: [Role; 2], block_s: f64) -> Option<[Vec<f64>; 2]> {
    let (from_s, to_s) = common_window(experiment, &roles)?;
    let count = ((to_s - from_s) / block_s) as usize;
    let means = |signal: &Signal| {
        let block = |k: usize| {
            let start_s = from_s + k as f64 * block_s;
            mean(&signal.slice(start_s, start_s + block_s).samples)
        };
        (0..count).map(block).collect::<Option<Vec<f64>>>()
    };
    Some([means(experiment.signal(roles[0])?)?, means(experiment.signal(roles[1])?)?])
}

pub(super) fn mean(x: &[f64]) -> Option<f64> {
    (!x.is_empty()).then(|| x.iter().sum::<f64>() / x.len() as f64)
}

fn spread(x: &[f64]) -> Option<f64> {
    let middle = mean(x)?;
    Some((x.iter().map(|v| (v - middle).powi(2)).sum::<f64>() / x.len() as f64).sqrt())
}

/// Correlation of as many values as both have; none where one does not change.
pub(super) fn correlation(x: &[f64], y: &[f64]) -> Option<f64> {
    let count = x.len().min(y.len());
    let (x, y) = (&x[..count], &y[..count]);
    let (x_mean, y_mean) = (mean(x)?, mean(y)?);
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for (x, y) in x.iter().zip(y) {
        xx += (x - x_mean).powi(2);
        yy += (y - y_mean).powi(2);
        xy += (x - x_mean) * (y - y_mean);
    }
    (xx > 0.0 && yy > 0.0).then(|| xy / (xx * yy).sqrt())
}
