//! The answer from the model.

use capability::{Answer, Beyond, CanInputs, Easier, FollowingSpread, LimitVerdict, can, easier};
use design::safety::{ASSUMED_ENGINE, BenchSpread, Prior};
use report::can::{Asked, answer, limit_of, statistic};
use serde_json::json;
use virtual_bench::Assumption;

use super::test::{Test, What};
use super::wanted::Wanted;
use crate::cli::can::CanArguments;
use crate::commands::experiment::check::pulses_from;
use crate::commands::experiment::stated::Bench;
use crate::commands::result::show;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(super) fn run(
    arguments: &CanArguments,
    test: &Test,
    wanted: &Wanted,
    terminal: &mut Terminal,
) -> Result<Outcome, CliError> {
    let bench = Bench::read(&arguments.on.bench, arguments.on.plan.study.as_deref(), terminal)?;
    let not_checkable = |reason: String| CliError::NotCheckable { path: arguments.on.bench.clone(), reason };
    let (model, assumptions) = match &test.what {
        What::Plan { plan, .. } => (bench.model_for(plan), bench.stated.assumed_for(plan)),
        What::Cycle { .. } => (bench.model_with_shaft(), bench.stated.assumptions.clone()),
    };
    let model = model.map_err(|reason| not_checkable(reason.to_owned()))?;
    let is_assumed = bench.stated.assumptions.contains(&Assumption::Engine);
    let inputs = CanInputs {
        demand: test.demand(),
        model: &model,
        engine: &bench.stated.parameters.engine,
        pulses: &bench.stated.pulses,
        limits: bench.file.limits,
        validity: bench.validity,
        spread: spread(&bench),
        slowest_engine_control: if is_assumed { ASSUMED_ENGINE } else { 1.0 },
        friction: bench.friction(),
        disturbances: bench.disturbances(),
        following: if is_assumed { FollowingSpread::ASSUMED } else { FollowingSpread::NONE },
        filter_hz: None,
        sets: &wanted.sets,
        own: &wanted.own,
        samples: arguments.samples as usize,
        seed: arguments.on.plan.seed(),
    };
    let failed = |error: capability::CapabilityError| not_checkable(error.to_string());
    let verdict = can(&inputs, terminal.work()).map_err(failed)?;
    let changes = match verdict.answer {
        Answer::No => easier(&inputs, terminal.work()).map_err(failed)?,
        Answer::Yes | Answer::Perhaps | Answer::NotShown | Answer::NotJudged => Vec::new(),
    };
    let asked = Asked {
        test: &test.title,
        duration_s: test.demand().duration_s(),
        verdict: &verdict,
        easier: &changes,
        sets: &wanted.sets,
        has_study: bench.assembled.is_some(),
        is_cycle: matches!(test.what, What::Cycle { .. }),
        pulses: &bench.stated.pulses,
        assumptions: &assumptions,
        friction: inputs.friction,
        following: Some(inputs.following).filter(|_| is_assumed && inputs.is_torque_demanded()),
    };
    show(&arguments.on.result, || bench.on_page(report::can::predicted(&asked)), || facts(&asked), terminal)?;
    let is_complete = verdict.unchecked.is_empty() || arguments.allow_unchecked;
    let is_yes = matches!(verdict.answer, Answer::Yes | Answer::NotJudged);
    Ok(if is_yes && is_complete { Outcome::Done } else { Outcome::NotSafe })
}

/// How the benches of a command differ from the nominal one.
pub(super) fn spread(bench: &Bench) -> BenchSpread<'_> {
    match &bench.assembled {
        Some(assembled) => BenchSpread::Estimated(&assembled.uncertainty),
        None => BenchSpread::Prior(Prior::default()),
    }
}

/// Part of a test beyond what is known, with its words.
pub(super) fn words_and_numbers(beyond: &Beyond) -> serde_json::Value {
    json!({"words": report::can::beyond(beyond), "numbers": beyond})
}

fn facts(asked: &Asked<'_>) -> serde_json::Value {
    let verdict = asked.verdict;
    let limit = |one: &LimitVerdict| {
        let (name, unit, si) = limit_of(one.of);
        json!({"of": one.of, "name": name, "unit": unit, "limit": one.limit.map(|limit| limit / si),
            "quantile_5": one.values.quantile(0.05) / si, "median": one.values.quantile(0.5) / si, "quantile_95": one.values.quantile(0.95) / si,
            "margin": one.limit.map(|limit| 1.0 - one.values.quantile(0.95) / limit), "reached": one.reached, "time_s": one.time_s})
    };
    let set = |set: &capability::SetVerdict| {
        let numbers = set.statistics.iter().map(|one| {
            json!({"signal": one.signal, "statistic": statistic(one.statistic), "low": one.low, "high": one.high,
                "quantile_5": one.values.quantile(0.05), "median": one.values.quantile(0.5), "quantile_95": one.values.quantile(0.95),
                "lowest": one.values.as_slice().first(), "highest": one.values.as_slice().last(), "kept": one.kept})
        });
        json!({"name": set.name, "kept": set.kept, "statistics": numbers.collect::<Vec<_>>(), "nominal": set.nominal})
    };
    let own = verdict.own.iter().map(|one| {
        json!({"requirement": report::can::own(&one.own), "limit": one.limit,
            "quantile_5": one.values.quantile(0.05), "median": one.values.quantile(0.5), "quantile_95": one.values.quantile(0.95),
            "margin": 1.0 - one.values.quantile(0.95) / one.limit, "kept": one.kept, "time_s": one.time_s})
    });
    let change =
        |one: &Easier| json!({"change": one.change, "words": report::can::change(one.change), "kept": one.kept});
    json!({
        "test": asked.test,
        "duration_s": asked.duration_s,
        "answer": verdict.answer,
        "sentence": answer(verdict),
        "beyond": verdict.beyond.iter().map(words_and_numbers).collect::<Vec<_>>(),
        "kept": verdict.kept,
        "unstable": verdict.unstable,
        "samples": verdict.kept.of,
        "limits": verdict.limits.iter().map(limit).collect::<Vec<_>>(),
        "unchecked": verdict.unchecked,
        "requirements": verdict.sets.iter().map(set).collect::<Vec<_>>(),
        "own": own.collect::<Vec<_>>(),
        "easier": asked.easier.iter().map(change).collect::<Vec<_>>(),
        "doubts": verdict.doubts,
        "spread": if asked.has_study { "study" } else { "prior" },
        "engine_pulses": pulses_from(asked.pulses),
        "assumptions": asked.assumptions,
        "friction": asked.friction,
        "engine_following": asked.following,
    })
}
