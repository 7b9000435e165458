//! Safety of an experiment on a bench that is not known exactly. Many benches are drawn, each runs the demands, and
//! every limit of the bench file gets the probability of being reached.
//!
//! An engine that fires adds its pulses, see [`bench_model::prediction`]. What counts in the end is how many benches
//! reach any limit at all.

mod allowed;
mod checked;
mod course;
mod friction;
mod ladder;
mod quantity;
mod run;
mod sines;
mod spread;
mod verdict;

use bench_model::document::ResultFormat;
use bench_model::prediction::{PredictionError, PredictionInputs};
use numerics::null::nan_if_null;
use rig::engine_pulses::KnownPulses;
use rig::experiment::Demands;
use rig::random::Source;
use serde::{Deserialize, Serialize};
use signal::proportion::Proportion;
use work::Context;

pub use checked::Checked;
pub use course::{AtResonance, largest_change};
pub use friction::{FrictionFrom, FrictionSpread};
pub use quantity::{Quantity, SPEED_CHANGE_S, reaches};
use run::{Outcome, outcomes};
pub use sines::{Proposal, SafeSine};
use spread::Drawn;
pub use spread::{BenchSpread, Prior, slowed};
pub use verdict::{ALLOWED, Safety};

/// Share of the bandwidth that the speed control of an engine of which nothing is known has at least.
pub const ASSUMED_ENGINE: f64 = 0.1;

/// Ignition efficiencies below this heat the exhaust much.
const HOT_EFFICIENCY: f64 = 0.8;

/// Inputs of a safety check.
#[derive(Debug, Clone, Copy)]
pub struct SafetyInputs<'a> {
    /// Plan, demands, nominal bench and limits. Its disturbances are those that benches have in the root mean square.
    pub prediction: PredictionInputs<'a>,
    /// How benches differ from the nominal one.
    pub spread: BenchSpread<'a>,
    /// Knowledge of the engine's firing pulses.
    pub pulses: &'a KnownPulses,
    /// Nobody measures how fast the engine's speed control (TN) is, and the faster it is, the more it damps the
    /// resonance: its bandwidth is drawn between this share of the one stated and all of it. 1: exactly as stated; see
    /// [`ASSUMED_ENGINE`].
    pub slowest_engine_control: f64,
    /// How the friction of their dynamometers differs; that of `prediction` has no part in it.
    pub friction: FrictionSpread,
    /// Benches drawn; from 72 on, none of which reaches a limit, the 95 % interval of its probability ends below 5 %.
    pub samples: usize,
    /// Seed of the draws; equal seeds give equal results, however many threads work.
    pub seed: u64,
}

/// Effect of retarded ignition on the exhaust: a hint, no limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ThermalHint {
    /// How long the ignition efficiency lies below 0.8, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub below_80_percent_s: f64,
    /// Mean share of the torque that is lost to it, 0 … 1.
    #[serde(deserialize_with = "nan_if_null")]
    pub mean_loss: f64,
}

/// The result of a safety check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SafetyCheck {
    /// Every quantity that the plan has.
    pub checked: Vec<Checked>,
    /// How many of the benches drawn are not stable.
    pub unstable: Proportion,
    /// How many reach any of the stated limits or are not stable.
    pub any: Proportion,
    /// Quantities whose limit is not stated, so that nothing is said of them.
    pub unchecked: Vec<Quantity>,
    /// Verdict of all together.
    pub safety: Safety,
    /// Retarded ignition, if the plan has any.
    pub thermal: Option<ThermalHint>,
    /// Amplitudes at which a sine test keeps the limits; `None` where the plan is no sine test of T_d*, or no limit
    /// bears on its amplitude.
    pub sines: Option<Proposal>,
}

impl SafetyCheck {
    /// Its form as a document.
    pub const DOCUMENT: ResultFormat<SafetyCheck> = ResultFormat::new("dynoid-safety-check", 1);
}

/// Why nothing can be checked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SafetyError {
    /// The nominal bench cannot be predicted.
    #[error(transparent)]
    Prediction(#[from] PredictionError),
    /// The uncertainty holds hardly any possible bench.
    #[error(
        "the parameters are so uncertain that hardly any bench drawn from them is possible; give better data to the study, \
         or check without it"
    )]
    NoBench,
    /// No samples.
    #[error("at least one bench must be drawn")]
    NoSamples,
}

/// Checks an experiment. Its runs are steps of the work.
///
/// # Errors
/// The nominal bench cannot be predicted, no samples, an uncertainty without possible benches.
pub fn check(inputs: &SafetyInputs<'_>, context: &Context) -> Result<SafetyCheck, SafetyError> {
    if inputs.samples == 0 {
        return Err(SafetyError::NoSamples);
    }
    let nominal = inputs.prediction.model;
    let mut random = Source::Safety.stream(inputs.seed);
    let mut of_friction = Source::Friction.stream(inputs.seed);
    let mut of_disturbances = Source::Disturbances.stream(inputs.seed);
    let benches = (0..inputs.samples)
        .map(|i| {
            let model = inputs.spread.draw(nominal, &mut random).ok_or(SafetyError::NoBench)?;
            let speed = random.between(inputs.slowest_engine_control, 1.0);
            let inertia = model.mechanics.engine_inertia_kg_m2;
            let engine = inputs.pulses.draw(inputs.prediction.engine, inertia, &mut random);
            let firing_seed = inputs.seed.wrapping_add(i as u64);
            let friction = inputs.friction.draw(&mut of_friction);
            let disturbances = inputs.prediction.disturbances.draw(&mut of_disturbances);
            Ok(Drawn { model, engine: spread::slowed(&engine, speed), friction, disturbances, firing_seed })
        })
        .collect::<Result<Vec<_>, SafetyError>>()?;
    let outcomes = outcomes(&inputs.prediction, &benches, context)?;
    let checked = checked(&inputs.prediction, &outcomes);
    let unstable = Proportion::new(outcomes.iter().filter(|outcome| outcome.is_unstable).count(), outcomes.len());
    let any = Proportion::new(
        outcomes.iter().filter(|outcome| is_beyond(&inputs.prediction, outcome)).count(),
        outcomes.len(),
    );
    let sines = sines::propose(&inputs.prediction, &benches, &outcomes, context)?;
    Ok(SafetyCheck {
        safety: checked::overall(&checked, any),
        unchecked: checked.iter().filter(|one| one.of.has_limit() && one.limit.is_none()).map(|one| one.of).collect(),
        any,
        thermal: thermal(&inputs.prediction),
        checked,
        unstable,
        sines,
    })
}

/// Tells whether a bench reaches any limit, or is not stable.
fn is_beyond(inputs: &PredictionInputs<'_>, outcome: &Outcome) -> bool {
    let reaches = |of: &Quantity| {
        of.limit(&inputs.limits).is_some_and(|limit| quantity::reaches(outcome.values[*of as usize], limit))
    };
    outcome.is_unstable || Quantity::of_plan(inputs.plan).iter().any(reaches)
}

/// Every quantity of the plan, judged.
fn checked(inputs: &PredictionInputs<'_>, outcomes: &[Outcome]) -> Vec<Checked> {
    let judge = |of: &Quantity| {
        let limit = of.limit(&inputs.limits);
        let value = |outcome: &Outcome| outcome.values[*of as usize];
        let worst = outcomes.iter().reduce(|a, b| if of.is_worse(value(b), value(a)) { b } else { a })?;
        let mut values: Vec<f64> = outcomes.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        let reached = limit.map(|limit| {
            let count = values.iter().filter(|value| quantity::reaches(**value, limit)).count();
            Proportion::new(count, values.len())
        });
        let worst_resonance_hz = inputs.plan.has_shaft.then_some(worst.resonance_hz);
        Some(Checked { of: *of, limit, values, reached, worst: value(worst), worst_resonance_hz })
    };
    Quantity::of_plan(inputs.plan).iter().filter_map(judge).collect()
}

fn thermal(inputs: &PredictionInputs<'_>) -> Option<ThermalHint> {
    let is_fired = inputs.plan.has_shaft && !inputs.plan.is_motored;
    let Demands { ignition_efficiency, .. } = inputs.demands;
    if !is_fired || ignition_efficiency.iter().all(|efficiency| *efficiency >= 1.0) {
        return None;
    }
    let hot = ignition_efficiency.iter().filter(|efficiency| **efficiency < HOT_EFFICIENCY).count();
    let lost: f64 = ignition_efficiency.iter().map(|efficiency| 1.0 - efficiency).sum();
    Some(ThermalHint {
        below_80_percent_s: hot as f64 * rig::experiment::UPDATE_S,
        mean_loss: lost / ignition_efficiency.len() as f64,
    })
}
