//! `dynoid experiment check`: whether an experiment is safe.

use bench_model::prediction::PredictionInputs;
use capability::Beyond;
use capability::beyond::of_model;
use design::safety::{ASSUMED_ENGINE, BenchSpread, Checked, Prior, Safety, SafetyCheck, SafetyInputs, check};
use report::safety::CheckedPlan;
use report::wording;
use rig::engine_pulses::KnownPulses;
use rig::experiment::{ControlMode, DEMAND_HOLD_S, Demands, ExperimentPlan};
use serde_json::json;
use units::RPM_RAD_S;
use virtual_bench::Assumption;

use super::planned::{self, Planned};
use super::stated::Bench;
use crate::cli::experiment::CheckArguments;
use crate::commands::result::{check_plot, show};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &CheckArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.on.result, &terminal.files())?;
    let bench = Bench::read(&arguments.on.bench, arguments.on.plan.study.as_deref(), terminal)?;
    let Planned { plan, .. } = planned::plan(&arguments.experiment, &arguments.on.plan, terminal)?;
    let doubts = planned::doubts(&plan, &bench.file);
    doubts.iter().for_each(|doubt| terminal.warning(doubt));
    let demands = Demands::of(&plan, arguments.on.plan.seed(), DEMAND_HOLD_S);
    let mut checked = checked(arguments, &bench, &plan, &demands, terminal)?;
    let beyond = beyond(&bench, &plan, &demands);
    if !beyond.is_empty() && checked.safety == Safety::Safe {
        checked.safety = Safety::Risky;
    }
    let shown = CheckedPlan {
        plan: &plan,
        speed_rad_s: demands.speed_rad_s[0],
        check: &checked,
        has_study: bench.assembled.is_some(),
        pulses: &bench.stated.pulses,
        assumptions: &bench.stated.assumed_for(&plan),
        friction: bench.friction(),
        beyond: &beyond,
    };
    let json = || facts(&bench, &shown, &doubts);
    show(&arguments.on.result, || bench.on_page(report::safety::page(&shown)), json, terminal)?;
    let is_complete = checked.unchecked.is_empty() || arguments.allow_unchecked;
    Ok(if checked.safety == Safety::Safe && is_complete { Outcome::Done } else { Outcome::NotSafe })
}

fn checked(
    arguments: &CheckArguments,
    bench: &Bench,
    plan: &ExperimentPlan,
    demands: &Demands,
    terminal: &Terminal,
) -> Result<SafetyCheck, CliError> {
    let not_checkable = |reason: String| CliError::NotCheckable { path: arguments.on.bench.clone(), reason };
    let model = bench.model_for(plan).map_err(|reason| not_checkable(reason.to_owned()))?;
    let engine = &bench.stated.parameters.engine;
    let prediction = PredictionInputs {
        plan,
        demands,
        model: &model,
        engine,
        firing_seed: Some(arguments.on.plan.seed()),
        friction: bench.friction().middle(),
        disturbances: bench.disturbances(),
        limits: bench.file.limits,
    };
    let spread = match &bench.assembled {
        Some(assembled) => BenchSpread::Estimated(&assembled.uncertainty),
        None => BenchSpread::Prior(Prior::default()),
    };
    let samples = arguments.samples as usize;
    let slowest_engine_control =
        if bench.stated.assumptions.contains(&Assumption::Engine) { ASSUMED_ENGINE } else { 1.0 };
    let (friction, seed, pulses) = (bench.friction(), arguments.on.plan.seed(), &bench.stated.pulses);
    let inputs = SafetyInputs { prediction, spread, pulses, slowest_engine_control, friction, samples, seed };
    check(&inputs, terminal.work()).map_err(|error| not_checkable(error.to_string()))
}

/// Where the engine's pulses are from.
pub(in crate::commands) fn pulses_from(pulses: &KnownPulses) -> serde_json::Value {
    match pulses {
        KnownPulses::Stated => json!({"from": "bench file"}),
        KnownPulses::Estimated(pulses) => json!({"from": "recordings", "recordings": pulses.recordings}),
        KnownPulses::Assumed(_) => json!({"from": "prior"}),
    }
}

/// Where the demands leave the range of the recordings that the model is from.
fn beyond(bench: &Bench, plan: &ExperimentPlan, demands: &Demands) -> Vec<Beyond> {
    let torques = if plan.label.mode == ControlMode::Tn { &demands.dyno_torque_nm } else { &demands.engine_torque_nm };
    of_model(&bench.validity, &demands.speed_rad_s, if plan.has_shaft { torques } else { &[] })
}

fn facts(bench: &Bench, shown: &CheckedPlan<'_>, doubts: &[String]) -> serde_json::Value {
    let CheckedPlan { plan, check: checked, .. } = *shown;
    let quantity = |one: &Checked| {
        let (name, unit, si) = wording::quantity(one.of);
        json!({"of": one.of, "name": name, "unit": unit, "limit": one.limit.map(|limit| limit / si),
            "quantile_5": one.quantile(0.05) / si, "median": one.quantile(0.5) / si, "quantile_95": one.quantile(0.95) / si,
            "worst": one.worst / si, "worst_resonance_hz": one.worst_resonance_hz,
            "reached": one.reached, "verdict": one.safety()})
    };
    let from = match &bench.assembled {
        Some(_) => json!({"from": "study"}),
        None => json!({"from": "prior", "within": Prior::default()}),
    };
    json!({
        "label": plan.label.to_string(),
        "speed_rpm": shown.speed_rad_s / RPM_RAD_S,
        "duration_s": plan.duration_s,
        "verdict": checked.safety,
        "samples": checked.unstable.of,
        "spread": from,
        "limits": checked.checked.iter().map(quantity).collect::<Vec<_>>(),
        "unstable": checked.unstable,
        "any_limit": checked.any,
        "unchecked": checked.unchecked,
        "thermal": checked.thermal,
        "sines": checked.sines,
        "engine_pulses": pulses_from(&bench.stated.pulses),
        "assumptions": bench.stated.assumed_for(plan),
        "doubts": doubts,
        "friction": shown.friction,
        "beyond": shown.beyond.iter().map(report::can::beyond).collect::<Vec<_>>(),
    })
}
