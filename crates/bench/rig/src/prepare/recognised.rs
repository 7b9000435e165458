//! Experiment that a recording shows by itself: who controls what, and how the demand moves. A person has to accept it.

use std::fmt;

use signal::Signal;
use units::RPM_RAD_S;

use super::label::{Answer, answers, blocks, correlation, mean, turns_with};
use crate::experiment::{ControlMode, Excitation, Experiment, ExperimentLabel, Test};
use crate::role::Role;

/// A demand whose values lie within this part of their mean is constant.
const CONSTANT: f64 = 2e-3;
/// A demand of speed that stays within this part of its mean is moved about one speed.
const ABOUT_ONE: f64 = 0.05;
/// Means over this are compared, s.
const BLOCK_S: f64 = 0.1;
/// N_d follows N_d* from this correlation on.
const FOLLOWS: f64 = 0.7;
/// A demand that rests so long is at a level, s.
const LEVEL_S: f64 = 0.3;
/// Share of the time at levels, from which on a demand consists of them.
const MOSTLY: f64 = 0.5;
/// Values closer than this part of the range are one level.
const SAME_LEVEL: f64 = 1e-3;
/// Values whose correlation with the next ones is smaller are white.
const WHITE: f64 = 0.3;
/// Three values of one sine leave less than this part of themselves.
const OF_A_SINE: f64 = 0.02;
/// Values in which the frequency of a sine is looked at.
const WITHIN: usize = 50;
/// Fewest values that show what a demand is.
const FEWEST: usize = 20;

/// Observation from which an experiment is recognised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LabelReason {
    /// N_d follows a moving N_d*.
    FollowsSpeedDemand,
    /// T_d* answers to every change of N_d.
    TorqueAnswers,
    /// T_d* rests while N_d changes.
    TorqueIsSet,
    /// Nothing shows which side controls what.
    NoControl,
    /// The engine does not turn with the dynamometer.
    ShaftOff,
    /// The engine's speed is not recorded, as with the shaft off.
    NoEngine,
    /// N_d* is constant.
    ConstantSpeed {
        /// Its value, rad/s.
        speed_rad_s: f64,
    },
    /// A demand moves between levels.
    Levels {
        /// How many.
        count: usize,
        /// True where it takes its time between them.
        with_ramps: bool,
    },
    /// N_d* is switched about one speed.
    AboutOneSpeed,
    /// A demand is one of two values, for random times.
    TwoValues,
    /// Each value of a demand is independent of the one before.
    White,
    /// A demand consists of sines, one at a time or several.
    Sines {
        /// True where they come one after another.
        one_by_one: bool,
    },
    /// The demand that should show the test is missing, or too short.
    NoDemand,
}

impl fmt::Display for LabelReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LabelReason::FollowsSpeedDemand => f.write_str("N_d follows N_d*, so the dynamometer controls the speed"),
            LabelReason::TorqueAnswers => {
                f.write_str("T_d* answers to every change of N_d, so the dynamometer controls the speed")
            }
            LabelReason::TorqueIsSet => {
                f.write_str("T_d* rests while N_d changes, so the dynamometer controls the torque")
            }
            LabelReason::NoControl => f.write_str("the signals do not show which side controls the speed"),
            LabelReason::ShaftOff => f.write_str("the engine does not turn with the dynamometer, so the shaft is off"),
            LabelReason::NoEngine => {
                f.write_str("the engine's speed is not recorded, so the data do not show that the shaft is on")
            }
            LabelReason::ConstantSpeed { speed_rad_s } => {
                write!(f, "N_d* is constant at {:.0} rpm, so the engine excites", speed_rad_s / RPM_RAD_S)
            }
            LabelReason::Levels { count, with_ramps: true } => write!(f, "the demand ramps between {count} levels"),
            LabelReason::Levels { count, .. } => write!(f, "the demand steps between {count} levels"),
            LabelReason::AboutOneSpeed => f.write_str("N_d* is switched about one speed, as with a motored engine"),
            LabelReason::TwoValues => f.write_str("the demand switches between two values at random times"),
            LabelReason::White => f.write_str("each value of the demand is independent of the one before"),
            LabelReason::Sines { one_by_one: true } => f.write_str("the demand is one sine after another"),
            LabelReason::Sines { .. } => f.write_str("the demand is a sum of sines"),
            LabelReason::NoDemand => f.write_str("the demand is missing or too short to show the test"),
        }
    }
}

/// The experiment that a recording shows by itself, if it shows one, with the reasons for it or against one. The
/// label that the experiment has is not looked at.
pub fn recognised(experiment: &Experiment) -> (Option<ExperimentLabel>, Vec<LabelReason>) {
    let (mode, reason) = control(experiment);
    let mut reasons = vec![reason];
    let label = mode.and_then(|mode| match mode {
        ControlMode::Nt => speed_controlled(experiment, &mut reasons),
        ControlMode::Tn => torque_controlled(experiment, &mut reasons),
    });
    (label, reasons)
}

fn control(experiment: &Experiment) -> (Option<ControlMode>, LabelReason) {
    let moves = experiment.signal(Role::DynoSpeedDemand).is_some_and(|demand| range(demand) > CONSTANT);
    let follows = || {
        let [speed, demand] = blocks(experiment, [Role::DynoSpeed, Role::DynoSpeedDemand], BLOCK_S)?;
        correlation(&speed, &demand)
    };
    if moves && follows().is_some_and(|related| related > FOLLOWS) {
        return (Some(ControlMode::Nt), LabelReason::FollowsSpeedDemand);
    }
    match answers(experiment) {
        Some(Answer::ToSpeed) => (Some(ControlMode::Nt), LabelReason::TorqueAnswers),
        Some(Answer::Rests) => (Some(ControlMode::Tn), LabelReason::TorqueIsSet),
        None => (None, LabelReason::NoControl),
    }
}

fn speed_controlled(experiment: &Experiment, reasons: &mut Vec<LabelReason>) -> Option<ExperimentLabel> {
    let label = |test, excitation| Some(ExperimentLabel::new(test, excitation, ControlMode::Nt));
    let has_engine = experiment.signal(Role::EngineSpeed).is_some();
    if has_engine && !turns_with(experiment) {
        reasons.push(LabelReason::ShaftOff);
        return label(Test::NoShaft, Excitation::Speed);
    }
    let Some(demand) = experiment.signal(Role::DynoSpeedDemand) else {
        reasons.push(LabelReason::NoDemand);
        return None;
    };
    if range(demand) <= CONSTANT {
        reasons.push(LabelReason::ConstantSpeed { speed_rad_s: mean(&demand.samples)? });
        return label(Test::Bs, Excitation::Torque);
    }
    if !has_engine {
        reasons.push(LabelReason::NoEngine);
        return None;
    }
    let course = Course::of(demand);
    if range(demand) < ABOUT_ONE && course.at_levels < MOSTLY {
        reasons.push(LabelReason::AboutOneSpeed);
        return label(Test::Unfired, Excitation::Speed);
    }
    if course.levels > 1 {
        reasons.push(LabelReason::Levels { count: course.levels, with_ramps: course.has_ramps });
        let test = match (course.levels, course.has_ramps) {
            (2, true) => Test::Ramp,
            (2, false) => Test::Step,
            _ => Test::Levels,
        };
        return label(test, Excitation::Speed);
    }
    label(course.excited(reasons)?, Excitation::Speed)
}

fn torque_controlled(experiment: &Experiment, reasons: &mut Vec<LabelReason>) -> Option<ExperimentLabel> {
    let course = Course::of(experiment.signal(Role::DynoTorqueDemand)?);
    let test = if course.at_levels > MOSTLY && course.levels > 1 {
        reasons.push(LabelReason::Levels { count: course.levels, with_ramps: false });
        Test::Step
    } else {
        course.excited(reasons)?
    };
    Some(ExperimentLabel::new(test, Excitation::Torque, ControlMode::Tn))
}

/// Course of a demand.
struct Course {
    /// Each value once, as long as it rests.
    values: Vec<f64>,
    /// Levels at which it rests for some time.
    levels: usize,
    /// Share of the time at them.
    at_levels: f64,
    /// True where most of the changes from level to level take several samples.
    has_ramps: bool,
}

impl Course {
    fn of(demand: &Signal) -> Self {
        let x = &demand.samples;
        let runs: Vec<&[f64]> = x.chunk_by(|a, b| a == b).collect();
        let (low, high) = ends(x);
        let at_level = |run: &&&[f64]| run.len() as f64 * demand.sample_time_s >= LEVEL_S;
        let mut held: Vec<f64> = runs.iter().filter(at_level).map(|run| run[0]).collect();
        let resting: usize = runs.iter().filter(at_level).map(|run| run.len()).sum();
        let changes = held.len().saturating_sub(1);
        held.sort_by(f64::total_cmp);
        held.dedup_by(|a, b| (*a - *b).abs() <= SAME_LEVEL * (high - low));
        let between = runs.len() - runs.iter().filter(at_level).count();
        Course {
            levels: held.len(),
            at_levels: resting as f64 / x.len().max(1) as f64,
            has_ramps: between > 2 * changes,
            values: runs.iter().map(|run| run[0]).collect(),
        }
    }

    /// The test of a demand that rests at no levels.
    fn excited(&self, reasons: &mut Vec<LabelReason>) -> Option<Test> {
        let (low, high) = ends(&self.values);
        let is_end = |value: &f64| (value - low).min(high - value) <= SAME_LEVEL * (high - low);
        let (test, reason) = if self.values.len() < FEWEST {
            (None, LabelReason::NoDemand)
        } else if self.values.iter().all(is_end) {
            (Some(Test::Binary), LabelReason::TwoValues)
        } else if correlation(&self.values, &self.values[1..]).is_none_or(|related| related.abs() < WHITE) {
            (Some(Test::WhiteNoise), LabelReason::White)
        } else {
            let one_by_one = self.is_one_sine_at_a_time();
            (Some(if one_by_one { Test::Sine } else { Test::Multisine }), LabelReason::Sines { one_by_one })
        };
        reasons.push(reason);
        test
    }

    /// Tells whether x(k+1) + x(k−1) = 2 cos(ωT) x(k) holds in most parts of the demand, about its mean.
    fn is_one_sine_at_a_time(&self) -> bool {
        let Some(middle) = mean(&self.values) else { return false };
        let x: Vec<f64> = self.values.iter().map(|value| value - middle).collect();
        let is_sine = |part: &[f64]| {
            let triples = || part.windows(3).map(|w| (w[1], w[0] + w[2]));
            let (square, product) = triples().fold((0.0, 0.0), |(s, p), (x, y)| (s + x * x, p + x * y));
            let left: f64 = triples().map(|(x, y)| (y - product / square * x).powi(2)).sum();
            left <= OF_A_SINE * OF_A_SINE * square
        };
        let parts = x.len() / WITHIN;
        parts > 0 && 2 * x.chunks_exact(WITHIN).filter(|part| is_sine(part)).count() > parts
    }
}

fn ends(x: &[f64]) -> (f64, f64) {
    x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)))
}

/// Range of a signal as a part of its mean.
fn range(signal: &Signal) -> f64 {
    let (low, high) = ends(&signal.samples);
    (high - low) / mean(&signal.samples).unwrap_or(0.0).abs().max(f64::MIN_POSITIVE)
}
