//! `dynoid torque-signals`: the torque signals held against each other, and the shaft torque rebuilt.

use dynoid::analyses;
use dynoid::facts::TorqueSignalsFacts;
use dynoid::{check_recording, write_shaft_torque};
use part_torque::torque_signals::TorqueRecording;

use super::experiments::{self, Campaign, WithRefused};
use super::result::show_with;
use crate::cli::torque_signals::TorqueSignalsArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &TorqueSignalsArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    arguments.out.as_deref().map_or(Ok(()), |out| check_recording(out, &terminal.files()))?;
    let Campaign { bench, experiments, refused } = experiments::all(&arguments.given, &arguments.result, terminal)?;
    let signals = analyses::torque_signals(&experiments, &bench, terminal.work());
    if let Some(out) = &arguments.out {
        let renamed = write_shaft_torque(&signals, out, &terminal.files())?;
        renamed.iter().for_each(|note| terminal.warning(note));
    }
    let page = || report::pages::torque_signals(&signals);
    let json = || WithRefused::sorted(TorqueSignalsFacts::of(&signals), &refused);
    show_with(&arguments.result, &[&arguments.out], page, json, terminal)?;
    Ok(Outcome::of(signals.recordings.iter().any(shows) || signals.trust.is_some(), &refused))
}

/// Tells whether a recording gives any result.
fn shows(recording: &TorqueRecording) -> bool {
    let filter = recording.filter.as_ref().is_some_and(|outcome| outcome.estimated().is_some());
    let shaft = recording.shaft.as_ref().is_some_and(|outcome| outcome.estimated().is_some());
    recording.delays.estimated().is_some() || filter || shaft
}
