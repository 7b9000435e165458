//! `dynoid torque-control`: models of the torque control, compared.

use part_torque::TorqueControls;
use part_torque::model_comparison::{ModelComparison, OrdersTried, compare_models};
use rig::{BenchFile, Experiment};
use serde_json::json;

use super::experiments::{self, Campaign};
use super::result::show;
use crate::cli::torque_control::TorqueControlArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &TorqueControlArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let Campaign { bench, experiments, refused } = experiments::all((&arguments.given, &arguments.result), terminal)?;
    let orders = OrdersTried { highest: arguments.highest_order, longest_delay: arguments.longest_delay };
    let studied = studied(&experiments, &bench, orders, terminal)?;
    let page = || report::pages::torque_control(&studied);
    let json = || {
        json!({
            "recordings": studied.recordings, "judgements": studied.judgements, "visibility": studied.visibility,
            "unusable": studied.unusable, "refused": refused,
        })
    };
    show(&arguments.result, page, json, terminal)?;
    Ok(if refused.is_empty() { Outcome::Done } else { Outcome::SomeUnreadable })
}

fn studied(
    experiments: &[Experiment],
    bench: &BenchFile,
    orders: OrdersTried,
    terminal: &Terminal,
) -> Result<ModelComparison, CliError> {
    let all: Vec<&Experiment> = experiments.iter().collect();
    compare_models(&TorqueControls::of(&all, bench.limits.torque_nm), orders, terminal.work())
        .map_err(|source| CliError::TorqueControl { source })
}
