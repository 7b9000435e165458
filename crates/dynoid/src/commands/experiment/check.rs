//! `dynoid experiment check`: whether an experiment is safe.

use bench_model::prediction::PredictionInputs;
use design::safety::{ASSUMED_ENGINE, BenchSpread, Checked, Prior, Safety, SafetyCheck, SafetyInputs, check};
use report::safety::CheckedPlan;
use report::wording;
use rig::engine_pulses::KnownPulses;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan};
use serde_json::json;
use virtual_bench::Assumption;

use super::planned::{self, Planned};
use super::stated::Bench;
use crate::cli::experiment::CheckArguments;
use crate::commands::result::{check_plot, show};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &CheckArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.on.result)?;
    let bench = Bench::read(&arguments.on.bench, arguments.on.plan.study.as_deref(), terminal)?;
    let Planned { plan, .. } = planned::plan(&arguments.experiment, &arguments.on.plan, terminal)?;
    let doubts = planned::doubts(&plan, &bench.file);
    doubts.iter().for_each(|doubt| terminal.warning(doubt));
    let checked = checked(arguments, &bench, &plan, terminal)?;
    let shown = CheckedPlan {
        plan: &plan,
        check: &checked,
        has_study: bench.assembled.is_some(),
        pulses: &bench.stated.pulses,
        assumptions: &bench.stated.assumed_for(&plan),
    };
    let json = || facts(&bench, &plan, &checked, &doubts);
    show(&arguments.on.result, || report::safety::page(&shown), json, terminal)?;
    let is_complete = checked.unchecked.is_empty() || arguments.allow_unchecked;
    Ok(if checked.safety == Safety::Safe && is_complete { Outcome::Done } else { Outcome::NotSafe })
}

fn checked(
    arguments: &CheckArguments,
    bench: &Bench,
    plan: &ExperimentPlan,
    terminal: &Terminal,
) -> Result<SafetyCheck, CliError> {
    let not_checkable = |reason: String| CliError::NotCheckable { path: arguments.on.bench.clone(), reason };
    let model = bench.model_for(plan).map_err(|reason| not_checkable(reason.to_owned()))?;
    let demands = Demands::of(plan, arguments.on.plan.seed(), DEMAND_HOLD_S);
    let engine = &bench.stated.parameters.engine;
    let prediction = PredictionInputs {
        plan,
        demands: &demands,
        model: &model,
        engine,
        firing_seed: Some(arguments.on.plan.seed()),
        limits: bench.file.limits,
    };
    let spread = match &bench.assembled {
        Some(assembled) => BenchSpread::Estimated(&assembled.uncertainty),
        None => BenchSpread::Prior(Prior::default()),
    };
    let samples = arguments.samples as usize;
    let slowest_engine_control =
        if bench.stated.assumptions.contains(&Assumption::Engine) { ASSUMED_ENGINE } else { 1.0 };
    let inputs = SafetyInputs {
        prediction,
        spread,
        pulses: &bench.stated.pulses,
        slowest_engine_control,
        samples,
        seed: arguments.on.plan.seed(),
    };
    let progress = terminal.long("running the experiment on benches");
    check(&inputs, &|done, all| progress.at(done, all)).map_err(|error| not_checkable(error.to_string()))
}

/// Where the engine's pulses are from.
pub(in crate::commands) fn pulses_from(pulses: &KnownPulses) -> serde_json::Value {
    match pulses {
        KnownPulses::Stated => json!({"from": "bench file"}),
        KnownPulses::Estimated(pulses) => json!({"from": "recordings", "recordings": pulses.recordings}),
        KnownPulses::Assumed(_) => json!({"from": "prior"}),
    }
}

fn facts(bench: &Bench, plan: &ExperimentPlan, checked: &SafetyCheck, doubts: &[String]) -> serde_json::Value {
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
    })
}
