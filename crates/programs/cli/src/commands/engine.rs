//! `dynoid engine`: the engine's torque, rebuilt.

use dynoid::analyses;
use dynoid::facts::EngineFacts;
use dynoid::{check_recording, write_engine_torque};

use super::experiments::{self, Campaign, WithRefused};
use super::result::show_with;
use crate::cli::engine::EngineArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &EngineArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    arguments.out.as_deref().map_or(Ok(()), |out| check_recording(out, &terminal.files()))?;
    let Campaign { bench, experiments, refused } = experiments::all(&arguments.given, &arguments.result, terminal)?;
    let found = analyses::engine(&experiments, &bench, terminal.work());
    if let Some(out) = &arguments.out {
        let renamed = write_engine_torque(&found, out, &terminal.files())?;
        renamed.iter().for_each(|note| terminal.warning(note));
    }
    let page = || report::pages::engine(&found);
    let json = || WithRefused::sorted(EngineFacts::of(&found), &refused);
    show_with(&arguments.result, &[&arguments.out], page, json, terminal)?;
    let tells = found.recordings.iter().any(|recording| recording.engine.estimated().is_some());
    Ok(Outcome::of(tells, &refused))
}
