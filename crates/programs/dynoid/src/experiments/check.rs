//! Safety of an experiment.

use bench_model::prediction::PredictionInputs;
use capability::Beyond;
use capability::beyond::of_model;
use design::safety::{
    ASSUMED_ENGINE, Checked, FrictionSpread, Prior, Proposal, Quantity, Safety, SafetyCheck, SafetyInputs, ThermalHint,
    check,
};
use page::Page;
use report::safety::CheckedPlan;
use report::wording;
use rig::engine_pulses::KnownPulses;
use rig::experiment::{ControlMode, DEMAND_HOLD_S, Demands, ExperimentPlan};
use serde::Serialize;
use signal::proportion::Proportion;
use units::RPM_RAD_S;
use virtual_bench::Assumption;
use work::Context;

use crate::error::Error;
use crate::known::{Draws, KnownBench, PulsesFrom};

/// An experiment with the probability that it reaches each limit of the bench.
#[derive(Debug, Clone)]
pub struct CheckedExperiment {
    plan: ExperimentPlan,
    /// The lowest and the highest speed demanded.
    speeds_rad_s: (f64, f64),
    check: SafetyCheck,
    beyond: Vec<Beyond>,
    has_study: bool,
    pulses: KnownPulses,
    assumptions: Vec<Assumption>,
    friction: FrictionSpread,
}

impl CheckedExperiment {
    /// Predicts an experiment on many benches, drawn from what is known of this one.
    ///
    /// # Errors
    /// A bench or a plan that cannot be predicted.
    pub fn of(bench: &KnownBench, plan: ExperimentPlan, draws: Draws, context: &Context) -> Result<Self, Error> {
        let demands = Demands::of(&plan, draws.seed, DEMAND_HOLD_S);
        let mut check = checked(bench, &plan, &demands, draws, context)?;
        let beyond = beyond(bench, &plan, &demands);
        if !beyond.is_empty() && check.safety == Safety::Safe {
            check.safety = Safety::Risky;
        }
        let stated = bench.virtual_bench();
        Ok(CheckedExperiment {
            speeds_rad_s: range(&demands.speed_rad_s),
            check,
            beyond,
            has_study: bench.assembled().is_some(),
            pulses: stated.pulses.clone(),
            assumptions: stated.assumed_for(&plan),
            friction: bench.friction(),
            plan,
        })
    }

    /// The result, with all its numbers.
    pub fn check(&self) -> &SafetyCheck {
        &self.check
    }

    /// Tells whether the experiment is safe: it stays within the range of the model, and hardly any bench reaches a
    /// limit. It is not if a limit was not checked, unless the caller `allows_unchecked` limits.
    pub fn is_safe(&self, allows_unchecked: bool) -> bool {
        self.check.safety == Safety::Safe && (self.check.unchecked.is_empty() || allows_unchecked)
    }

    /// The result as a page; [`KnownBench::on_page`] adds the bench.
    pub fn page(&self) -> Page {
        report::safety::page(&CheckedPlan {
            plan: &self.plan,
            speeds_rad_s: self.speeds_rad_s,
            check: &self.check,
            has_study: self.has_study,
            pulses: &self.pulses,
            assumptions: &self.assumptions,
            friction: self.friction,
            beyond: &self.beyond,
        })
    }

    /// The result in numbers.
    pub fn facts(&self) -> CheckFacts<'_> {
        let check = &self.check;
        CheckFacts {
            label: self.plan.label.to_string(),
            speeds_rpm: (self.speeds_rad_s.0 / RPM_RAD_S, self.speeds_rad_s.1 / RPM_RAD_S),
            duration_s: self.plan.duration_s,
            verdict: check.safety,
            samples: check.unstable.of,
            spread: if self.has_study { SpreadFrom::Study } else { SpreadFrom::Prior { within: Prior::default() } },
            limits: check.checked.iter().map(LimitFacts::of).collect(),
            unstable: &check.unstable,
            any_limit: &check.any,
            unchecked: &check.unchecked,
            thermal: &check.thermal,
            sines: &check.sines,
            engine_pulses: PulsesFrom::of(&self.pulses),
            assumptions: &self.assumptions,
            friction: self.friction,
            beyond: self.beyond.iter().map(report::can::beyond).collect(),
        }
    }
}

fn range(x: &[f64]) -> (f64, f64) {
    x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)))
}

fn checked(
    bench: &KnownBench,
    plan: &ExperimentPlan,
    demands: &Demands,
    draws: Draws,
    context: &Context,
) -> Result<SafetyCheck, Error> {
    let model = bench.model_for(plan).map_err(|reason| bench.refused(reason))?;
    let stated = bench.virtual_bench();
    let prediction = PredictionInputs {
        plan,
        demands,
        model: &model,
        engine: &stated.parameters.engine,
        firing_seed: Some(draws.seed),
        friction: bench.friction().middle(),
        disturbances: bench.disturbances(),
        limits: bench.file().limits,
    };
    let inputs = SafetyInputs {
        prediction,
        spread: bench.spread(),
        pulses: &stated.pulses,
        slowest_engine_control: if bench.assumes_engine() { ASSUMED_ENGINE } else { 1.0 },
        friction: bench.friction(),
        samples: draws.benches,
        seed: draws.seed,
    };
    check(&inputs, context).map_err(|error| bench.refused(error))
}

/// Where the demands leave the range of the recordings that the model is from.
fn beyond(bench: &KnownBench, plan: &ExperimentPlan, demands: &Demands) -> Vec<Beyond> {
    let torques = if plan.label.mode == ControlMode::Tn { &demands.dyno_torque_nm } else { &demands.engine_torque_nm };
    of_model(&bench.validity(), &demands.speed_rad_s, if plan.has_shaft { torques } else { &[] })
}

/// Numbers of [`CheckedExperiment`].
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CheckFacts<'a> {
    label: String,
    /// The lowest and the highest speed demanded.
    speeds_rpm: (f64, f64),
    duration_s: f64,
    verdict: Safety,
    samples: usize,
    spread: SpreadFrom,
    limits: Vec<LimitFacts>,
    unstable: &'a Proportion,
    any_limit: &'a Proportion,
    unchecked: &'a [Quantity],
    thermal: &'a Option<ThermalHint>,
    sines: &'a Option<Proposal>,
    engine_pulses: PulsesFrom<'a>,
    assumptions: &'a [Assumption],
    friction: FrictionSpread,
    beyond: Vec<String>,
}

/// Source of the differences between the benches.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "from", rename_all = "snake_case")]
enum SpreadFrom {
    Study,
    Prior { within: Prior },
}

/// A limit of the bench.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct LimitFacts {
    of: Quantity,
    name: &'static str,
    unit: &'static str,
    limit: Option<f64>,
    quantile_5: f64,
    median: f64,
    quantile_95: f64,
    worst: f64,
    worst_resonance_hz: Option<f64>,
    reached: Option<Proportion>,
    verdict: Safety,
}

impl LimitFacts {
    fn of(one: &Checked) -> Self {
        let (name, unit, si) = wording::quantity(one.of);
        LimitFacts {
            of: one.of,
            name,
            unit,
            limit: one.limit.map(|limit| limit / si),
            quantile_5: one.quantile(0.05) / si,
            median: one.quantile(0.5) / si,
            quantile_95: one.quantile(0.95) / si,
            worst: one.worst / si,
            worst_resonance_hz: one.worst_resonance_hz,
            reached: one.reached,
            verdict: one.safety(),
        }
    }
}
