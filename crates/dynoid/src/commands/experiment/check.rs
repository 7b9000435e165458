//! `dynoid experiment check`: whether an experiment is safe.

use bench_model::prediction::PredictionInputs;
use design::safety::{
    ASSUMED_ENGINE, BenchSpread, Checked, Prior, Proposal, Quantity, SafeSine, Safety, SafetyCheck, SafetyInputs, check,
};
use page::{Align, Cell, Table, Tone};
use report::wording::{self, number};
use rig::ControlMode;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan};
use serde_json::json;
use virtual_bench::Assumption;

use super::design::say_assumed;
use super::planned::{self, Planned};
use super::stated::Bench;
use crate::cli::experiment::CheckArguments;
use crate::commands::identify::data::check_plot;
use crate::commands::identify::judge::{picture, written};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &CheckArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.on.result, &[std::slice::from_ref(&arguments.on.bench)])?;
    let bench = Bench::read(&arguments.on.bench, arguments.on.plan.study.as_deref(), terminal)?;
    let Planned { plan, .. } = planned::plan(&arguments.experiment, &arguments.on.plan, terminal)?;
    let doubts = planned::doubts(&plan, &bench.file);
    doubts.iter().for_each(|doubt| terminal.warning(doubt));
    let checked = checked(arguments, &bench, &plan, terminal)?;
    picture(&arguments.on.result, &format!("{}, checked", plan.label), || report::safety::figures(&checked))?;
    if arguments.on.result.json {
        terminal.json(&facts(&bench, &plan, &checked, &doubts))?;
    } else if !terminal.is_quiet() {
        print(&bench, &plan, &checked, terminal);
        written(&arguments.on.result.plot, terminal);
    }
    Ok(if checked.safety == Safety::Safe { Outcome::Done } else { Outcome::NotSafe })
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
    let prediction = PredictionInputs { plan, demands: &demands, model: &model, engine, limits: bench.file.limits };
    let spread = match &bench.assembled {
        Some(assembled) => BenchSpread::Estimated(&assembled.uncertainty),
        None => BenchSpread::Prior(Prior::default()),
    };
    let samples = arguments.samples as usize;
    let slowest_engine_control =
        if bench.stated.assumptions.contains(&Assumption::Engine) { ASSUMED_ENGINE } else { 1.0 };
    let inputs = SafetyInputs { prediction, spread, slowest_engine_control, samples, seed: arguments.on.plan.seed() };
    let progress = terminal.long("running the experiment on benches");
    check(&inputs, &|done, all| progress.told(done, all)).map_err(|error| not_checkable(error.to_string()))
}

fn print(bench: &Bench, plan: &ExperimentPlan, checked: &SafetyCheck, terminal: &mut Terminal) {
    let verdict = wording::safety(checked.safety).to_uppercase();
    terminal.heading(&format!("{}, {} s: {verdict}", plan.label, plan.duration_s), style(checked.safety));
    terminal.table(&limits(checked));
    terminal.gap();
    let drawn = checked.unstable.of;
    terminal.paragraph(&format!("{drawn} benches drawn: {}.", spread_words(bench)));
    if plan.label.mode == ControlMode::Tn && bench.stated.assumed_for(plan).contains(&Assumption::Engine) {
        terminal
            .paragraph("The engine's speed control is drawn between a tenth of the assumed bandwidth and all of it.");
    }
    if checked.safety == Safety::NotChecked {
        terminal
            .item(("not checked:", Tone::Caution), "the bench file states no limit that bears on this; add [limits]");
    }
    if checked.unstable.count > 0 {
        terminal.item(
            ("not stable:", Tone::Bad),
            &format!("{} of the benches drawn", number::proportion(&checked.unstable)),
        );
    }
    if let Some(hint) = checked.thermal {
        let words = format!(
            "ignition efficiency below 0.8 for {}; {} of the torque is lost to the exhaust on average",
            number::measure(hint.below_80_percent_s, "s"),
            number::share(hint.mean_loss)
        );
        terminal.item(("heat:", Tone::Caution), &words);
    }
    say_assumed(bench, plan, terminal);
    if let Some(proposal) = &checked.sines {
        propose(proposal, terminal);
    }
}

fn spread_words(bench: &Bench) -> String {
    let percent = |share: f64| format!("±{:.0} %", 100.0 * share);
    match &bench.assembled {
        Some(_) => "by the covariance of the study's estimates; what it did not estimate is taken as exact".to_owned(),
        None => {
            let Prior { resonance, damping, engine_inertia } = Prior::default();
            format!(
                "resonance {}, damping {}, inertia of the engine {} (95 % ranges)",
                percent(resonance),
                percent(damping),
                percent(engine_inertia)
            )
        }
    }
}

fn limits(checked: &SafetyCheck) -> Table {
    let mut table = Table::new(&[
        ("", Align::Left),
        ("median", Align::Right),
        ("1 in 20 beyond", Align::Right),
        ("limit", Align::Right),
        ("reached (95 % interval)", Align::Left),
        ("", Align::Left),
    ]);
    for one in &checked.checked {
        let (name, unit, si) = wording::quantity(one.of);
        let limit = match (one.limit, one.of.has_limit()) {
            (Some(limit), _) => Cell::from(value(limit / si, unit)),
            (None, true) => Cell::toned("none stated", Tone::Faint),
            (None, false) => Cell::from(""),
        };
        let verdict = if one.of.has_limit() { wording::safety(one.safety()) } else { "" };
        table.row([
            name.into(),
            value(one.quantile(0.5) / si, unit).into(),
            value(beyond(one) / si, unit).into(),
            limit,
            one.reached.as_ref().map_or_else(String::new, number::proportion).into(),
            Cell::toned(verdict, style(one.safety())),
        ]);
    }
    table
}

/// What one bench in twenty goes beyond.
fn beyond(checked: &Checked) -> f64 {
    checked.quantile(if checked.of == Quantity::LowestSpeed { 0.05 } else { 0.95 })
}

fn value(value: f64, unit: &str) -> String {
    if value.is_infinite() { "without bound".to_owned() } else { format!("{} {unit}", number::significant(value, 4)) }
}

fn style(safety: Safety) -> Tone {
    match safety {
        Safety::Safe => Tone::Good,
        Safety::Risky => Tone::Caution,
        Safety::Unsafe => Tone::Bad,
        Safety::NotChecked => Tone::Faint,
    }
}

/// The sines that are too large, and what they may be.
fn propose(proposal: &Proposal, terminal: &mut Terminal) {
    let too_large: Vec<&SafeSine> = proposal.sines.iter().filter(|sine| sine.safe_nm < sine.planned_nm).collect();
    if too_large.is_empty() {
        return;
    }
    terminal.gap();
    let mut table = Table::new(&[
        ("sine", Align::Right),
        ("planned", Align::Right),
        ("safe amplitude", Align::Right),
        ("as planned, reaches a limit (95 % interval)", Align::Left),
    ]);
    for sine in &too_large {
        table.row([
            value(sine.frequency_hz, "Hz").into(),
            value(sine.planned_nm, "Nm").into(),
            value(sine.safe_nm, "Nm").into(),
            number::proportion(&sine.reached).into(),
        ]);
    }
    terminal.table(&table);
    terminal.gap();
    terminal.paragraph(match proposal.holds {
        true => "With these amplitudes, and all others as planned, the test keeps the limits on the benches drawn.",
        false => "Even with these amplitudes a limit is not kept; the mean or the speed of the test is at fault.",
    });
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
        "thermal": checked.thermal,
        "sines": checked.sines,
        "assumptions": bench.stated.assumed_for(plan),
        "doubts": doubts,
    })
}
