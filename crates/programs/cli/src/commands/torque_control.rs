//! `dynoid torque-control`: models of the torque control, compared.

use dynoid::facts::TorqueControlFacts;
use dynoid::{Error, analyses};
use part_torque::model_comparison::OrdersTried;

use super::experiments::{self, Campaign, WithRefused};
use super::result::show;
use crate::cli::torque_control::TorqueControlArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &TorqueControlArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let Campaign { bench, experiments, refused } = experiments::all(&arguments.given, &arguments.result, terminal)?;
    let orders = OrdersTried { highest: arguments.highest_order, longest_delay: arguments.longest_delay };
    let studied = analyses::torque_control(&experiments, &bench, orders, terminal.work()).map_err(Error::from)?;
    let page = || report::pages::torque_control(&studied);
    let json = || WithRefused::sorted(TorqueControlFacts::of(&studied), &refused);
    show(&arguments.result, page, json, terminal)?;
    Ok(if refused.is_empty() { Outcome::Done } else { Outcome::SomeUnreadable })
}
