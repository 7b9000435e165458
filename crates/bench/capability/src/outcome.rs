//! Inputs of an answer, and the outcome of one bench.

use bench_model::disturbances::Disturbances;
use bench_model::document::Validity;
use bench_model::friction::DynoFriction;
use bench_model::model::BenchModel;
use cycle::{Judged, Own, RequirementSet, Validation};
use design::safety::{BenchSpread, FrictionSpread, reaches};
use rig::bench_file::Limits;
use rig::bench_parameters::EngineParameters;
use rig::engine_pulses::KnownPulses;

use crate::demand::Demand;
use crate::extremes::{LimitOf, Peak};
use crate::following::{Following, FollowingSpread};

/// Inputs of an answer.
#[derive(Debug, Clone, Copy)]
pub struct CanInputs<'a> {
    /// The test.
    pub demand: Demand<'a>,
    /// The bench.
    pub model: &'a BenchModel,
    /// Its engine.
    pub engine: &'a EngineParameters,
    /// Knowledge of its firing pulses.
    pub pulses: &'a KnownPulses,
    /// Limits that the bench must not exceed.
    pub limits: Limits,
    /// The range of the recordings that the model is from.
    pub validity: Validity,
    /// How benches differ from it.
    pub spread: BenchSpread<'a>,
    /// Share of the stated bandwidth that the engine's speed control (TN) has at least.
    pub slowest_engine_control: f64,
    /// How the friction of their dynamometers differs.
    pub friction: FrictionSpread,
    /// Errors of their dynamometers' encoders, in the root mean square, and ripple of their drives.
    pub disturbances: Disturbances,
    /// How the torque of their engines follows what is demanded of it.
    pub following: FollowingSpread,
    /// The demands pass a low-pass of first order with this corner before the bench gets them, Hz; what it does is
    /// judged by the demands as they were.
    pub filter_hz: Option<f64>,
    /// Requirement sets that must be met.
    pub sets: &'a [RequirementSet],
    /// Requirements of one's own.
    pub own: &'a [Own],
    /// Benches drawn.
    pub samples: usize,
    /// Seed of the draws; equal seeds give equal results.
    pub seed: u64,
}

/// Outcome of one bench.
#[derive(Debug, Clone)]
pub(crate) struct Outcome {
    pub(crate) peaks: [Peak; LimitOf::COUNT],
    pub(crate) validations: Vec<Validation>,
    pub(crate) own: Vec<Judged>,
    pub(crate) is_unstable: bool,
    /// Speed and torque at the times of the bands.
    pub(crate) course: Vec<(f64, f64)>,
    /// The largest magnitude in each stretch of the run, by quantity; empty where nobody asks for it.
    pub(crate) limited: Vec<Vec<f64>>,
}

/// One bench that could be the one at hand.
#[derive(Debug, Clone)]
pub(crate) struct Drawn {
    pub(crate) model: BenchModel,
    pub(crate) engine: EngineParameters,
    /// Share of the stated bandwidth that its speed control has.
    pub(crate) engine_speed: f64,
    pub(crate) friction: DynoFriction,
    pub(crate) disturbances: Disturbances,
    /// How its torque follows what is demanded.
    pub(crate) following: Following,
    pub(crate) firing_seed: Option<u64>,
}

/// Tells whether every limit is kept.
pub(crate) fn keeps_limits(has_shaft: bool, limits: &Limits, peaks: &[Peak; LimitOf::COUNT]) -> bool {
    reached(has_shaft, limits, peaks).next().is_none()
}

/// The limits that are reached.
pub(crate) fn reached<'a>(
    has_shaft: bool,
    limits: &'a Limits,
    peaks: &'a [Peak; LimitOf::COUNT],
) -> impl Iterator<Item = LimitOf> + 'a {
    let is_reached = |of: &LimitOf| of.limit(limits).is_some_and(|limit| reaches(peaks[*of as usize].value, limit));
    LimitOf::of_test(has_shaft, limits).filter(is_reached)
}

/// Tells whether every requirement set is met.
pub(crate) fn meets_sets(sets: &[RequirementSet], validations: &[Validation]) -> bool {
    validations.len() == sets.len() && validations.iter().all(|validation| validation.passes)
}
