//! Gain from a further recording.
//!
//! Each experiment of the method is run on a virtual bench that is as this one is known to be, and studied beside the
//! recordings there are, as it would be once it is measured. What the study then states in place of what it states now
//! is what the experiment buys: choices of the study, its corrections, and its trust in time stamps are in it, which
//! a count of information (see [`design::excitation_design`]) leaves out.

use std::sync::Arc;

use bench_model::analysis::results_of;
use bench_model::disturbances::Disturbances;
use bench_model::model::{AssembledModel, BenchModel};
use bench_model::prediction::PredictionInputs;
use design::excitation_design::{DesignTask, ExcitedDemand, Goal, Measurements, OperatingPoint, PeakLimits, design};
use design::safety::{ASSUMED_ENGINE, BenchSpread, FrictionSpread, Prior, Safety, SafetyCheck, SafetyInputs, check};
use numerics::null::nan_if_null;
use numerics::parallel;
use part_controller::speed_controller::Encoder;
use part_shaft::Parts;
use rig::experiment::catalogue::{self, Settings};
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan, Test, UPDATE_S};
use rig::numbers::unscaled;
use rig::results::{Estimate, Notation, Parameter, Quantity, ReadNotation};
use rig::{BenchFile, Experiment, ExperimentLabel, Role};
use serde::{Deserialize, Serialize};
use units::RPM_RAD_S;
use virtual_bench::{Assumption, Numerics, StatedBench, VirtualBenchError, VirtualRun, rename, simulate_hidden};
use work::Context;

use crate::fits::Fits;
use crate::gather::{Prepared, experiment_of};
use crate::whole::model_of;
use crate::{Source, StudyError};

/// Experiments of the method that a study learns from.
const CANDIDATES: [ExperimentLabel; 7] = [
    ExperimentLabel::BS_T_NT,
    ExperimentLabel::WHITE_NOISE_T_TN,
    ExperimentLabel::MULTISINE_T_TN,
    ExperimentLabel::MULTISINE_N_NT,
    ExperimentLabel::LEVELS_N_NT,
    ExperimentLabel::RAMP_N_NT,
    ExperimentLabel::STEP_T_TN,
];
/// Torque at which a designed experiment runs, Nm: that of the method's others.
const DESIGNED_AT_NM: f64 = 60.0;
/// How far a designed experiment may move the speed, rad/s.
const SWING_RAD_S: f64 = 100.0 * RPM_RAD_S;
/// Shortest experiment that an estimator takes, s.
const SHORTEST_S: f64 = 5.0;
/// Benches on which an experiment is checked: as many as `dynoid experiment check` takes.
const CHECKED: usize = 200;
/// Time at the operating point before the recording starts, s.
const SETTLING_S: f64 = 2.0;
/// Goals of a design: the shaft, on which resonance, gain and damping rest.
const DESIGNED_FOR: [Goal; 2] = [Goal::Stiffness, Goal::Damping];
/// Intervals after two realisations of one experiment differ by as much without a reason: that of J_e, the least
/// repeatable, by an eighth (standard deviation, six recordings of 16 s).
const SAME: f64 = 0.2;

/// Conditions of the next experiment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NextOptions {
    /// Speed at which it would run, rpm.
    pub speed_rpm: f64,
    /// Its length, s.
    pub duration_s: f64,
    /// Half an interval of this part of the value is narrow enough, and narrowing it further buys nothing.
    pub enough: f64,
    /// Seed of what is random in it.
    pub seed: u64,
}

impl Default for NextOptions {
    /// A minute at 1200 rpm; within one per cent is enough.
    fn default() -> Self {
        NextOptions { speed_rpm: 1200.0, duration_s: 60.0, enough: 0.01, seed: 1 }
    }
}

/// Why nothing can be said.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NextError {
    /// The recordings cannot be studied.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// No shaft is known, so that no bench can take the place of this one.
    #[error("neither the recordings nor the bench file give the shaft, so this bench cannot be simulated")]
    UnknownShaft,
    /// Experiments that are too short for every estimator.
    #[error("experiments of {duration_s} s are too short for every estimate; at least {SHORTEST_S} s are needed")]
    TooShort {
        /// Their length, s.
        duration_s: f64,
    },
    /// There is no such bench.
    #[error(transparent)]
    VirtualBench(#[from] VirtualBenchError),
}

/// Gains from further experiments.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NextExperiments {
    /// Present knowledge: results of the whole model, and parameters of its parts.
    pub now: Vec<Parameter>,
    /// The experiments, the one that buys most first.
    pub candidates: Vec<Candidate>,
    /// Half an interval of this part of the value was taken for narrow enough.
    #[serde(deserialize_with = "nan_if_null")]
    pub enough: f64,
    /// Assumptions about the bench that they were tried on.
    pub assumptions: Vec<Assumption>,
}

/// An experiment, and what would be known after it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Candidate {
    /// Its label.
    pub label: ExperimentLabel,
    /// True where its demand was designed for this bench, see [`design::excitation_design`].
    pub is_designed: bool,
    /// Speed, rpm.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_rpm: f64,
    /// Length, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub duration_s: f64,
    /// The largest |T_shaft| it drove the virtual bench to, firing pulses included, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub peak_shaft_torque_nm: f64,
    /// Safety on benches like this one, as a check of it says; `None` where it buys nothing, or cannot be checked.
    pub safety: Option<Safety>,
    /// Its gains, in the order of what is known.
    pub gains: Vec<Gain>,
}

/// Gain from an experiment in one number, SI; written in the unit people read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "WrittenGain"))]
#[serde(into = "WrittenGain", try_from = "ReadGain")]
pub struct Gain {
    /// The number.
    pub quantity: Quantity,
    /// Its value now, or where it is not known now, after the experiment.
    pub value: f64,
    /// Half the width of the 95 % interval now; none: not known now.
    pub now: Option<f64>,
    /// The same after the experiment.
    pub then: f64,
    /// True where the interval is narrow enough already.
    pub is_enough_now: bool,
}

/// A gain as JSON has it.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct WrittenGain {
    key: Quantity,
    #[serde(flatten)]
    notation: Notation,
    value: f64,
    now: Option<f64>,
    then: f64,
    is_enough_now: bool,
}

impl From<Gain> for WrittenGain {
    fn from(gain: Gain) -> Self {
        let notation = gain.quantity.notation();
        let written = |value: f64| notation.per_si * value;
        let Gain { value, now, then, is_enough_now, .. } = gain;
        WrittenGain {
            key: gain.quantity,
            notation,
            value: written(value),
            now: now.map(written),
            then: written(then),
            is_enough_now,
        }
    }
}

/// A gain as it is read; null is read as NaN.
#[derive(Deserialize)]
struct ReadGain {
    #[serde(flatten)]
    notation: ReadNotation,
    #[serde(deserialize_with = "nan_if_null")]
    value: f64,
    now: Option<f64>,
    #[serde(deserialize_with = "nan_if_null")]
    then: f64,
    is_enough_now: bool,
}

impl TryFrom<ReadGain> for Gain {
    type Error = String;

    fn try_from(read: ReadGain) -> Result<Self, String> {
        let quantity = read.notation.quantity()?;
        let si = |written: f64| unscaled(written, &[quantity.notation().per_si]);
        let ReadGain { value, now, then, is_enough_now, .. } = read;
        Ok(Gain { quantity, value: si(value), now: now.map(si), then: si(then), is_enough_now })
    }
}

impl Gain {
    /// By how much the interval gets narrower, if there is one now.
    pub fn narrowing(&self) -> Option<f64> {
        Some(self.now? / self.then)
    }

    /// Tells whether the number gets known, or an interval that is too wide narrower by more than realisations differ.
    pub fn is_worth_while(&self) -> bool {
        !self.is_enough_now && self.narrowing().is_none_or(|narrowing| narrowing * (1.0 - SAME) > 1.0)
    }

    /// Tells whether a number that is known within this part of itself would no longer be: the recording takes the
    /// place of a better one.
    pub fn is_spoiled(&self, enough: f64) -> bool {
        self.is_enough_now && self.then > enough * self.value.abs()
    }
}

impl Candidate {
    /// How many numbers it makes known that are not, and the sum of the logarithms by which it narrows intervals that
    /// are too wide, less those by which it spoils numbers that are known within this part of themselves. One that is
    /// too wide and gets wider costs nothing.
    pub fn worth(&self, enough: f64) -> (usize, f64) {
        let new = self.gains.iter().filter(|gain| gain.now.is_none()).count();
        let of = |gain: &Gain| match gain.narrowing() {
            Some(narrowing) if gain.is_spoiled(enough) => narrowing.ln(),
            Some(narrowing) if !gain.is_enough_now => narrowing.ln().max(0.0),
            _ => 0.0,
        };
        (new, self.gains.iter().map(of).sum())
    }

    /// The factor by which it narrows intervals that are too wide, all factors multiplied; spoiled numbers count as in
    /// [`Candidate::worth`].
    pub fn narrowing(&self, enough: f64) -> f64 {
        self.worth(enough).1.exp()
    }

    /// Tells whether it buys anything.
    pub fn is_worth_while(&self) -> bool {
        self.gains.iter().any(Gain::is_worth_while)
    }

    /// Tells whether it would reach a limit of the bench.
    pub fn is_unsafe(&self) -> bool {
        self.safety == Some(Safety::Unsafe)
    }
}

/// An experiment with its gains, and with its check.
#[derive(Debug, Clone)]
pub struct RatedExperiment {
    /// The experiment with its gains.
    pub candidate: Candidate,
    /// The check of its safety; `None` where it cannot be checked, or was not, since it buys nothing.
    pub check: Option<SafetyCheck>,
}

/// Gains from each experiment of the method, beside the recordings there are; there may be none.
///
/// # Errors
/// [`NextError`]: recordings of which none can be used, or a bench of which too little is known to try anything on.
pub fn next_experiments(
    bench: &BenchFile,
    recordings: Prepared,
    options: NextOptions,
    context: &Context,
) -> Result<NextExperiments, NextError> {
    Ok(rated_experiments(bench, recordings, options, context)?.0)
}

/// The same, with the check of each candidate, in their order.
///
/// # Errors
/// Those of [`next_experiments`].
pub fn rated_experiments(
    bench: &BenchFile,
    recordings: Prepared,
    options: NextOptions,
    context: &Context,
) -> Result<(NextExperiments, Vec<Option<SafetyCheck>>), NextError> {
    let experiments = usable(bench, recordings)?;
    let all: Vec<&Experiment> = experiments.iter().collect();
    rated_beside(&Parts::of(&all, bench), options, context)
}

/// The gains from one experiment with this plan, and its check. Of the options, the plan has speed and length of its
/// own; the speed is only stated.
///
/// # Errors
/// Those of [`next_experiments`].
pub fn rated_plan(
    bench: &BenchFile,
    recordings: Prepared,
    plan: &ExperimentPlan,
    options: NextOptions,
    context: &Context,
) -> Result<RatedExperiment, NextError> {
    let experiments = usable(bench, recordings)?;
    let all: Vec<&Experiment> = experiments.iter().collect();
    let parts = Parts::of(&all, bench);
    let step = context.step("trying the experiment on a bench like this one", 0);
    let rated = Ground::of(&parts, options, &step)?.rate(plan, false, true)?;
    Ok(rated)
}

fn usable(bench: &BenchFile, recordings: Prepared) -> Result<Arc<Vec<Experiment>>, NextError> {
    match recordings.usable(bench) {
        Ok(prepared) => Ok(prepared.experiments),
        Err(StudyError::NoRecordings) => Ok(Arc::default()),
        Err(error) => Err(error.into()),
    }
}

/// The same, beside recordings that were prepared.
pub(super) fn beside(parts: &Parts<'_>, options: NextOptions, context: &Context) -> Result<NextExperiments, NextError> {
    Ok(rated_beside(parts, options, context)?.0)
}

fn rated_beside(
    parts: &Parts<'_>,
    options: NextOptions,
    context: &Context,
) -> Result<(NextExperiments, Vec<Option<SafetyCheck>>), NextError> {
    let ground = Ground::of(parts, options, context)?;
    let at = OperatingPoint { speed_rad_s: options.speed_rpm * RPM_RAD_S, torque_nm: DESIGNED_AT_NM };
    let plans: Vec<(ExperimentPlan, bool)> = designed(parts.bench, &ground.stated, at, options.duration_s)
        .into_iter()
        .map(|plan| (plan, true))
        .chain(of_the_method(options.speed_rpm, options.duration_s).map(|plan| (plan, false)))
        .collect();
    let rate = |(plan, is_designed): &(ExperimentPlan, bool)| ground.rate(plan, *is_designed, false);
    let rated = parallel::map_as_step(context, "trying experiments on a bench like this one", &plans, rate);
    let mut rated = rated.into_iter().collect::<Result<Vec<RatedExperiment>, VirtualBenchError>>()?;
    let worth = |one: &RatedExperiment| one.candidate.worth(options.enough);
    rated.sort_by(|a, b| worth(b).partial_cmp(&worth(a)).unwrap_or(std::cmp::Ordering::Equal));
    let (candidates, checks) = rated.into_iter().map(|one| (one.candidate, one.check)).unzip();
    let Ground { known, stated, .. } = ground;
    let found =
        NextExperiments { now: known.numbers, candidates, enough: options.enough, assumptions: stated.assumptions };
    Ok((found, checks))
}

/// Ground on which experiments are tried: what recordings show, and a virtual bench that is as this one is known to be.
struct Ground<'a, 'b> {
    parts: &'a Parts<'b>,
    known: Known,
    stated: StatedBench,
    options: NextOptions,
}

impl<'a, 'b> Ground<'a, 'b> {
    fn of(parts: &'a Parts<'b>, options: NextOptions, context: &Context) -> Result<Self, NextError> {
        if options.duration_s.is_nan() || options.duration_s < SHORTEST_S {
            return Err(NextError::TooShort { duration_s: options.duration_s });
        }
        let known = Known::of(parts, context);
        let assembled = known.model.as_ref();
        let mut stated = StatedBench::of(parts.bench, assembled.map(|assembled| &assembled.model))?
            .with_pulses(assembled.and_then(|assembled| assembled.engine_pulses.as_ref()));
        if !stated.knows_shaft() {
            return Err(NextError::UnknownShaft);
        }
        adopt_sensors(&mut stated, &parts.experiments, known.encoder);
        Ok(Ground { parts, known, stated, options })
    }

    /// Gains from a plan, and its check: always, or where it buys anything.
    fn rate(
        &self,
        plan: &ExperimentPlan,
        is_designed: bool,
        is_always_checked: bool,
    ) -> Result<RatedExperiment, VirtualBenchError> {
        let Ground { parts, known, stated, options } = self;
        let (then, peak_shaft_torque_nm) = try_out(parts, stated, plan, options.seed)?;
        let candidate = Candidate {
            label: plan.label.clone(),
            is_designed,
            speed_rpm: options.speed_rpm,
            duration_s: plan.duration_s,
            peak_shaft_torque_nm,
            safety: None,
            gains: then.iter().map(|p| gain(p, &known.numbers, options.enough)).collect(),
        };
        let is_checked = is_always_checked || candidate.is_worth_while();
        let check = is_checked.then(|| safety(parts.bench, stated, known.model.as_ref(), plan, options.seed)).flatten();
        let safety = check.as_ref().map(|check| check.safety);
        Ok(RatedExperiment { candidate: Candidate { safety, ..candidate }, check })
    }
}

/// Knowledge that recordings give.
struct Known {
    numbers: Vec<Parameter>,
    model: Option<AssembledModel>,
    encoder: Option<Encoder>,
}

impl Known {
    fn of(parts: &Parts<'_>, context: &Context) -> Self {
        let fits = Fits::of(parts, context);
        let model = fits.pieces().and_then(|pieces| model_of(&parts.bench.facts(), &pieces));
        let of_model = model.iter().flat_map(|assembled| results_of(&assembled.model, &assembled.uncertainty));
        let numbers = of_model.chain(of_parts(&fits)).filter(|p| p.standard_error > 0.0).collect();
        Known { numbers, model, encoder: fits.controller.ok().map(|c| c.encoder) }
    }
}

/// The parameters of the parts that people ask for.
fn of_parts(fits: &Fits) -> Vec<Parameter> {
    let shaft = fits.shaft.as_ref().ok();
    let inertias = shaft.and_then(|shaft| shaft.inertias.as_ref()).map(|(_, estimate)| estimate);
    let parts: [(Option<&Estimate>, &[Quantity]); 5] = [
        (shaft.map(|shaft| &shaft.estimate), &[Quantity::Stiffness, Quantity::Damping]),
        (inertias, &[Quantity::DynoInertia, Quantity::EngineInertia]),
        (
            fits.controller.as_ref().ok().map(|c| &c.result.estimate),
            &[Quantity::ProportionalGain, Quantity::IntegralGain],
        ),
        (
            fits.feed_forward.as_ref().ok().map(|f| &f.estimate),
            &[Quantity::SpeedFeedForward, Quantity::AccelerationFeedForward],
        ),
        (fits.torque_control.as_ref().ok().map(|t| &t.result.delay_and_lag), &[Quantity::TorqueControlTotalDelay]),
    ];
    let of = |(estimate, quantities): (Option<&Estimate>, &[Quantity])| {
        quantities.iter().filter_map(|quantity| estimate?.parameter(*quantity).cloned()).collect::<Vec<Parameter>>()
    };
    parts.into_iter().flat_map(of).collect()
}

/// The recordings' rasters and the noise of their speeds, in place of those of the default virtual bench.
fn adopt_sensors(stated: &mut StatedBench, experiments: &[&Experiment], encoder: Option<Encoder>) {
    let parameters = &mut stated.parameters;
    let updates = |role: Role| {
        let sampled = experiments.iter().find_map(|e| e.signal(role))?;
        Some(((sampled.sample_time_s / UPDATE_S).round() as usize).max(1))
    };
    if let Some(updates) = updates(Role::EngineSpeed) {
        parameters.clocks.engine_speed_decimation = updates;
    }
    if let Some(updates) = updates(Role::AirGapTorque).or(updates(Role::FlangeTorque)) {
        parameters.clocks.torque_decimation = updates;
    }
    if let Some(speed) = experiments.iter().find_map(|e| e.signal(Role::DynoSpeed)) {
        // The floor of the recorded speed has its rounding in it.
        parameters.sensors.speed_noise_rad_s = Encoder::known_or_assumed(encoder, speed, None).noise_rad_s;
        parameters.sensors.speed_resolution_rad_s = 0.0;
    }
}

fn of_the_method(speed_rpm: f64, duration_s: f64) -> impl Iterator<Item = ExperimentPlan> {
    CANDIDATES.into_iter().filter_map(move |label| {
        let template = catalogue::of(&label)?;
        let (speed, duration) = (speed_rpm.to_string(), duration_s.to_string());
        let settings = Settings::parse(&template.parameters(), &[("speed", &speed), ("duration", &duration)]).ok()?;
        template.plan(&settings).ok()
    })
}

/// The excitation that shows the shaft best within the limits that are stated; none where none is.
fn designed(bench: &BenchFile, stated: &StatedBench, at: OperatingPoint, duration_s: f64) -> Option<ExperimentPlan> {
    let limits = PeakLimits { speed_rad_s: Some(SWING_RAD_S), ..PeakLimits::left_by(&bench.limits, at) };
    limits.shaft_torque_nm?;
    let measured = Measurements::of_bench(&stated.parameters, at);
    let model = BenchModel::of(&stated.parameters);
    let excited = ExcitedDemand::Torque;
    let task = DesignTask::of_goals(&DESIGNED_FOR, model, excited, at, measured, limits, duration_s).ok()?;
    let mut plan = design(&task).ok()?.multisine.plan(Test::Multisine, excited, at, duration_s);
    plan.settling_s = SETTLING_S;
    Some(plan)
}

/// Knowledge once the recording of an experiment on the bench is added to those there are, and the largest |T_shaft| in
/// it, Nm.
fn try_out(
    parts: &Parts<'_>,
    stated: &StatedBench,
    plan: &ExperimentPlan,
    seed: u64,
) -> Result<(Vec<Parameter>, f64), VirtualBenchError> {
    let VirtualRun { mut recording, hidden } = simulate_hidden(&stated.parameters, plan, seed, Numerics::default())?;
    rename(&mut recording, &parts.bench.channels);
    // No file of the recordings is called so.
    let file = format!("{0}_next/{0}.mf4", plan.label);
    let source = Source { file, sha256: String::new(), recording: Ok(recording) };
    let peak_nm = hidden.shaft_torque_nm.iter().fold(0.0_f64, |peak, torque| peak.max(torque.abs()));
    let then = match experiment_of(parts.bench, &source) {
        Ok((experiment, _)) => Known::of(&parts.with(&experiment), &Context::new()),
        Err(_) => Known::of(parts, &Context::new()),
    };
    Ok((then.numbers, peak_nm))
}

/// Check of an experiment; `None` where it cannot be checked.
fn safety(
    bench: &BenchFile,
    stated: &StatedBench,
    known: Option<&AssembledModel>,
    plan: &ExperimentPlan,
    seed: u64,
) -> Option<SafetyCheck> {
    let model = stated.linear_model(known.map(|known| &known.model));
    let demands = Demands::of(plan, seed, DEMAND_HOLD_S);
    let estimated = known.and_then(|known| known.dyno_friction.as_ref());
    let friction = FrictionSpread::of(bench, stated.parameters.drive.torque_limit_nm, estimated);
    let prediction = PredictionInputs {
        plan,
        demands: &demands,
        model: &model,
        engine: &stated.parameters.engine,
        firing_seed: Some(seed),
        friction: friction.middle(),
        disturbances: known.and_then(|known| known.disturbances).unwrap_or_else(Disturbances::assumed),
        limits: bench.limits,
    };
    let inputs = SafetyInputs {
        prediction,
        spread: known.map_or(BenchSpread::Prior(Prior::default()), |known| BenchSpread::Estimated(&known.uncertainty)),
        slowest_engine_control: if stated.assumptions.contains(&Assumption::Engine) { ASSUMED_ENGINE } else { 1.0 },
        pulses: &stated.pulses,
        friction,
        samples: CHECKED,
        seed,
    };
    check(&inputs, &Context::new()).ok()
}

/// Gain in a number.
fn gain(then: &Parameter, now: &[Parameter], enough: f64) -> Gain {
    let half_width = |p: &Parameter| 0.5 * (p.interval.1 - p.interval.0);
    let now = now.iter().find(|known| known.quantity == then.quantity);
    Gain {
        quantity: then.quantity,
        value: now.unwrap_or(then).value,
        now: now.map(half_width),
        then: half_width(then),
        is_enough_now: now.is_some_and(|p| half_width(p) <= enough * p.value.abs()),
    }
}
