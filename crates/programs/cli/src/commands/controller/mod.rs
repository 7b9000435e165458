//! `dynoid controller`: the speed controller.

mod noise_test;

use dynoid::analyses;
use dynoid::facts::SpeedControlFacts;

use super::experiments::{self, Campaign, WithRefused};
use super::result::show;
use crate::cli::GivenRecordings;
use crate::cli::controller::{ControllerArguments, ControllerCommand};
use crate::cli::identify::ResultArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &ControllerArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    match (&arguments.command, &arguments.given) {
        (Some(ControllerCommand::NoiseTest(arguments)), _) => noise_test::run(arguments, terminal),
        (None, Some(given)) => identify(given, &arguments.result, terminal),
        (None, None) => {
            Err(CliError::Usage { what: "name a bench file; `dynoid controller --help` has examples".into() })
        }
    }
}

fn identify(given: &GivenRecordings, result: &ResultArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let Campaign { bench, experiments, refused } = experiments::all(given, result, terminal)?;
    let found = analyses::controller(&experiments, &bench, terminal.work());
    if found.controllers.is_empty() {
        return Err(CliError::NoHeldSpeed { path: given.bench.clone() });
    }
    let page = || report::pages::controller(&found);
    let json = || WithRefused::sorted(SpeedControlFacts::of(&found), &refused);
    show(result, page, json, terminal)?;
    let tells = found.controllers.iter().any(|one| one.found.estimated().is_some());
    Ok(Outcome::of(tells, &refused))
}
