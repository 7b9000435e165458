//! `dynoid torque-signals`: the torque signals held against each other, and the shaft torque rebuilt.

use std::path::Path;

use part_controller::SpeedControllers;
use part_torque::TorqueControls;
use rig::Experiment;
use part_torque::torque_signals::{TorqueRecording, TorqueSignals, torque_signals};
use report::wording::reasons;
use rig::results::Outcome;
use serde_json::json;

use super::experiments::{self, Campaign};
use super::identify::judge::{write_page, written};
use super::rebuilt::{self, Rebuilt};
use crate::cli::torque_signals::TorqueSignalsArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &TorqueSignalsArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    rebuilt::check(arguments.out.as_deref(), &arguments.given)?;
    let Campaign { bench, experiments, refused } = experiments::all((&arguments.given, &arguments.result), terminal)?;
    let progress = terminal.progress(experiments.len() as u64);
    let all: Vec<&Experiment> = experiments.iter().collect();
    let limit = bench.limits.torque_nm;
    let parts = (&SpeedControllers::of(&all, limit), &TorqueControls::of(&all, limit));
    let signals = torque_signals(parts, &bench, &|file| {
        progress.say(&format!("looking at the torques of {file}"));
        progress.step();
    });
    drop(progress);
    let page = report::pages::torque_signals(&signals);
    write_page(arguments.result.plot.as_ref(), &page)?;
    if let Some(out) = &arguments.out {
        write(&signals, out, terminal)?;
    }
    if arguments.result.json {
        let recordings: Vec<_> = signals.recordings.iter().map(short).collect();
        terminal.json(&json!({"recordings": recordings, "trust": signals.trust, "refused": refused}))?;
    } else if !terminal.is_quiet() {
        terminal.page(&page);
        [&arguments.out, &arguments.result.plot].into_iter().for_each(|path| written(path, terminal));
    }
    Ok(Outcome::of(signals.recordings.iter().any(tells) || signals.trust.is_some(), &refused))
}

/// Whether a recording tells anything at all.
fn tells(recording: &TorqueRecording) -> bool {
    let filter = recording.filter.as_ref().is_some_and(|told| told.estimated().is_some());
    let shaft = recording.shaft.as_ref().is_some_and(|told| told.estimated().is_some());
    recording.delays.estimated().is_some() || filter || shaft
}

/// A recording's results without the samples of the shaft torque.
fn short(recording: &TorqueRecording) -> serde_json::Value {
    let shaft = recording.shaft.as_ref().map(|told| match told {
        Outcome::Estimated(shaft) => json!({"found": {
            "start_s": shaft.start_s, "sample_time_s": shaft.sample_time_s, "samples": shaft.smoothed_nm.len(),
            "torque": shaft.torque, "noise": shaft.noise, "once_a_turn": shaft.once_a_turn,
        }}),
        Outcome::NotEstimated { needs } => json!({"untold": needs.first()}),
    });
    json!({"file": recording.file, "label": recording.label, "delays": recording.delays, "filter": recording.filter,
        "shaft": shaft})
}

/// Writes the shaft torque of the one recording there is.
fn write(signals: &TorqueSignals, out: &Path, terminal: &mut Terminal) -> Result<(), CliError> {
    let recording = rebuilt::only(&signals.recordings, "the shaft torque", out)?;
    let shaft = match &recording.shaft {
        Some(Outcome::Estimated(shaft)) => shaft,
        Some(Outcome::NotEstimated { needs }) => {
            return Err(CliError::Usage { what: format!("{}: no shaft torque: {}", recording.file, reasons(needs)) });
        }
        None => {
            return Err(CliError::Usage {
                what: format!("{}: the shaft is off, so there is no shaft torque", recording.file),
            });
        }
    };
    let rebuilt = Rebuilt {
        comment: format!("shaft torque rebuilt from {}", recording.file),
        start_s: shaft.start_s,
        sample_time_s: shaft.sample_time_s,
        channels: vec![
            ("shaft_torque", "by a fixed-interval smoother", &shaft.smoothed_nm),
            (
                "shaft_torque_standard_deviation_without_encoder_error",
                "of the smoother, without what a once-a-turn error of the encoder adds",
                &shaft.standard_deviation_nm,
            ),
            ("shaft_torque_zero_phase", "by a filter without phase shift", &shaft.zero_phase_nm),
        ],
    };
    rebuilt::write(&rebuilt, out, terminal)
}
