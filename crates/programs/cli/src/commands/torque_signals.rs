//! `dynoid torque-signals`: the torque signals held against each other, and the shaft torque rebuilt.

use std::path::Path;

use dynoid::analyses;
use dynoid::facts::TorqueSignalsFacts;
use part_torque::torque_signals::{TorqueRecording, TorqueSignals};
use report::wording::reasons;

use super::experiments::{self, Campaign, WithRefused};
use super::rebuilt::{self, Rebuilt};
use super::result::show_with;
use crate::cli::torque_signals::TorqueSignalsArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &TorqueSignalsArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    rebuilt::check(arguments.out.as_deref(), &terminal.files())?;
    let Campaign { bench, experiments, refused } = experiments::all(&arguments.given, &arguments.result, terminal)?;
    let signals = analyses::torque_signals(&experiments, &bench, terminal.work());
    if let Some(out) = &arguments.out {
        write(&signals, out, terminal)?;
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

/// Writes the shaft torque of the one recording there is.
fn write(signals: &TorqueSignals, out: &Path, terminal: &mut Terminal) -> Result<(), CliError> {
    let recording = rebuilt::only(&signals.recordings, "the shaft torque", out)?;
    let unusable = |why: String| CliError::Usage { what: format!("{}: {why}", recording.file) };
    let Some(shaft) = &recording.shaft else {
        return Err(unusable("the shaft is off, so there is no shaft torque".to_owned()));
    };
    let shaft = shaft.as_ref().map_err(|needs| unusable(format!("no shaft torque: {}", reasons(needs))))?;
    let rebuilt = Rebuilt {
        comment: format!("shaft torque rebuilt from {}", recording.file),
        start_s: shaft.start_s,
        sample_time_s: shaft.sample_time_s,
        channels: vec![
            ("shaft_torque", "by a fixed-interval smoother", &shaft.smoothed_nm),
            (
                "shaft_torque_standard_deviation",
                "of the smoother; a once-a-turn error of the encoder only as far as the speeds show it",
                &shaft.standard_deviation_nm,
            ),
            ("shaft_torque_zero_phase", "by a filter without phase shift", &shaft.zero_phase_nm),
        ],
    };
    rebuilt::write(&rebuilt, out, terminal)
}
