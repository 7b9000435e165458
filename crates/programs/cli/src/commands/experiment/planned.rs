//! Plans of experiments, with what is said of them.

use dynoid::KnownBench;
use dynoid::experiments::{PlanDoubt, Planned};
use rig::experiment::ExperimentPlan;
use serde::Serialize;

use crate::cli::experiment::{OnBenchArguments, PlanArguments};
use crate::error::CliError;
use crate::terminal::Terminal;

/// The bench as far as it is known; warns where bench file and model contradict each other.
pub(in crate::commands) fn known(on: &OnBenchArguments, terminal: &mut Terminal) -> Result<KnownBench, CliError> {
    let bench = KnownBench::load(&on.bench, on.plan.study.as_deref(), &terminal.files())?;
    bench.doubt().iter().for_each(|doubt| terminal.warning(doubt));
    Ok(bench)
}

/// The plan of an experiment by name, or of a file of demands; warns of columns that are left out.
pub(super) fn plan(experiment: &str, arguments: &PlanArguments, terminal: &mut Terminal) -> Result<Planned, CliError> {
    let planned = Planned::find(experiment, &arguments.given()?, &terminal.files(), terminal.work())?;
    planned.remark(experiment).iter().for_each(|remark| terminal.warning(remark));
    Ok(planned)
}

/// Warns of doubts about a plan, and returns them.
pub(super) fn doubts(plan: &ExperimentPlan, bench: &KnownBench, terminal: &mut Terminal) -> Vec<String> {
    let doubts: Vec<String> = PlanDoubt::of(plan, bench.file()).iter().map(in_options).collect();
    doubts.iter().for_each(|doubt| terminal.warning(doubt));
    doubts
}

/// A doubt with the option that removes it.
fn in_options(doubt: &PlanDoubt) -> String {
    let option = doubt.remedy().map(|given| format!(", as with --set {}={}", given.name, given.value));
    format!("{doubt}{}", option.unwrap_or_default())
}

/// A result in numbers, with the doubts about its plan.
#[derive(Serialize)]
pub(super) struct WithDoubts<'a, F> {
    #[serde(flatten)]
    pub(super) facts: F,
    pub(super) doubts: &'a [String],
}
