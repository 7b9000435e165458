//! `dynoid engine`: the engine's torque, rebuilt.

use std::path::Path;

use dynoid::analyses;
use dynoid::facts::EngineFacts;
use part_engine::EngineTorque;
use report::wording::reasons;
use rig::results::Reason;

use super::experiments::{self, Campaign, WithRefused};
use super::rebuilt::{self, Rebuilt};
use super::result::show_with;
use crate::cli::engine::EngineArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &EngineArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    rebuilt::check(arguments.out.as_deref(), &terminal.files())?;
    let Campaign { bench, experiments, refused } = experiments::all(&arguments.given, &arguments.result, terminal)?;
    let found = analyses::engine(&experiments, &bench, terminal.work());
    if let Some(out) = &arguments.out {
        write(&found, out, terminal)?;
    }
    let page = || report::pages::engine(&found);
    let json = || WithRefused::sorted(EngineFacts::of(&found), &refused);
    show_with(&arguments.result, &[&arguments.out], page, json, terminal)?;
    let tells = found.recordings.iter().any(|recording| recording.engine.estimated().is_some());
    Ok(Outcome::of(tells, &refused))
}

/// Writes the engine torque of the one recording there is.
fn write(found: &EngineTorque, out: &Path, terminal: &mut Terminal) -> Result<(), CliError> {
    let recording = rebuilt::only(&found.recordings, "the engine torque", out)?;
    let missing = |needs: &[Reason]| CliError::Usage {
        what: format!("{}: no engine torque: {}", recording.file, reasons(needs)),
    };
    let engine = recording.engine.as_ref().map_err(missing)?;
    let rebuilt = Rebuilt {
        comment: format!("engine torque rebuilt from {}", recording.file),
        start_s: engine.start_s,
        sample_time_s: engine.sample_time_s,
        channels: vec![
            ("engine_torque", "by a fixed-interval smoother", &engine.smoothed_nm),
            (
                "engine_torque_standard_deviation",
                "of noise, masses and shaft; a once-a-turn error of the encoder only as far as the speeds show it",
                &engine.standard_deviation_nm,
            ),
            ("engine_torque_zero_phase", "by a filter without phase shift", &engine.zero_phase_nm),
        ],
    };
    rebuilt::write(&rebuilt, out, terminal)
}
