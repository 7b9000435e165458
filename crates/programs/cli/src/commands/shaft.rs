//! `dynoid shaft`: the shaft of every recording and of all together.

use dynoid::analyses;
use dynoid::facts::ShaftFacts;

use super::experiments::{self, Campaign, WithRefused};
use super::result::show;
use crate::cli::shaft::ShaftArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &ShaftArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let Campaign { bench, experiments, refused } = experiments::all(&arguments.given, &arguments.result, terminal)?;
    let study = analyses::shaft(&experiments, &bench, terminal.work());
    let page = || report::pages::shaft(&study);
    let json = || WithRefused::sorted(ShaftFacts::of(&study), &refused);
    show(&arguments.result, page, json, terminal)?;
    let finds = study.recordings.iter().any(|recording| recording.shaft.estimated().is_some());
    Ok(Outcome::of(finds, &refused))
}
