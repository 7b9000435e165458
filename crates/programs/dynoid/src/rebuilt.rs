//! Torques that were rebuilt, as recordings.

use std::path::Path;

use part_engine::{EngineTorque, RebuiltEngine};
use part_torque::torque_signals::{RebuiltShaft, TorqueSignals};
use recording::{Channel, Format, Raster, Recording};
use report::wording::reasons;
use rig::results::Reason;

use crate::error::Error;
use crate::files::Files;
use crate::formats::FileFormat;
use crate::mark::Mark;
use crate::output::check_file;

/// Checks before any work that a recording can be written there: by its ending, and that nothing that is read is lost.
///
/// # Errors
/// Another ending, or a file that must stay.
pub fn check_recording(path: &Path, files: &Files) -> Result<(), Error> {
    FileFormat::of_output(path)?;
    check_file(path, &Mark::of_run(files), files)
}

/// Writes a recording that a program made, its format by the ending. Returns notes on names that the format cannot
/// hold.
///
/// # Errors
/// Another ending, and a file that cannot be written.
pub fn write_recording(recording: &mut Recording, path: &Path, files: &Files) -> Result<Vec<String>, Error> {
    let format = FileFormat::of_output(path)?;
    // Of what text has no place for, the comment alone is there, and it says nothing that the file's name does not.
    let renamed = format.fit(recording).into_iter().filter(|note| !note.starts_with("text has no place")).collect();
    format.write(recording, path, files)?;
    Ok(renamed)
}

/// Writes the engine torque of the one recording there is. Returns notes on names that the format cannot hold.
///
/// # Errors
/// Several recordings, no engine torque, and a file that cannot be written.
pub fn write_engine_torque(found: &EngineTorque, path: &Path, files: &Files) -> Result<Vec<String>, Error> {
    let one = only(&found.recordings, "the engine torque", path)?;
    let missing = |needs: &[Reason]| not_rebuilt(&one.file, format!("no engine torque: {}", reasons(needs)));
    write_recording(&mut of_engine(&one.file, one.engine.as_ref().map_err(missing)?), path, files)
}

/// Writes the shaft torque of the one recording there is. Returns notes on names that the format cannot hold.
///
/// # Errors
/// Several recordings, no shaft torque, and a file that cannot be written.
pub fn write_shaft_torque(found: &TorqueSignals, path: &Path, files: &Files) -> Result<Vec<String>, Error> {
    let one = only(&found.recordings, "the shaft torque", path)?;
    let Some(shaft) = &one.shaft else {
        return Err(not_rebuilt(&one.file, "the shaft is off, so there is no shaft torque".to_owned()));
    };
    let missing = |needs: &[Reason]| not_rebuilt(&one.file, format!("no shaft torque: {}", reasons(needs)));
    write_recording(&mut of_shaft(&one.file, shaft.as_ref().map_err(missing)?), path, files)
}

fn not_rebuilt(file: &str, reason: String) -> Error {
    Error::NotRebuilt { file: file.to_owned(), reason }
}

/// The one recording whose torque is written.
fn only<'a, T>(recordings: &'a [T], what: &'static str, out: &Path) -> Result<&'a T, Error> {
    match recordings {
        [one] => Ok(one),
        _ => Err(Error::TorqueOfSeveral { path: out.to_owned(), what, count: recordings.len() }),
    }
}

fn of_engine(file: &str, engine: &RebuiltEngine) -> Recording {
    let channels = vec![
        torque("engine_torque", "by a fixed-interval smoother", &engine.smoothed_nm),
        torque(
            "engine_torque_standard_deviation",
            "of noise, masses and shaft; a once-a-turn error of the encoder only as far as the speeds show it",
            &engine.standard_deviation_nm,
        ),
        torque("engine_torque_zero_phase", "by a filter without phase shift", &engine.zero_phase_nm),
    ];
    rebuilt(format!("engine torque rebuilt from {file}"), engine.start_s, engine.sample_time_s, channels)
}

fn of_shaft(file: &str, shaft: &RebuiltShaft) -> Recording {
    let channels = vec![
        torque("shaft_torque", "by a fixed-interval smoother", &shaft.smoothed_nm),
        torque(
            "shaft_torque_standard_deviation",
            "of the smoother; a once-a-turn error of the encoder only as far as the speeds show it",
            &shaft.standard_deviation_nm,
        ),
        torque("shaft_torque_zero_phase", "by a filter without phase shift", &shaft.zero_phase_nm),
    ];
    rebuilt(format!("shaft torque rebuilt from {file}"), shaft.start_s, shaft.sample_time_s, channels)
}

fn torque(name: &str, comment: &str, samples_nm: &[f64]) -> Channel {
    Channel {
        name: name.to_owned(),
        unit: "Nm".to_owned(),
        comment: comment.to_owned(),
        raster: 0,
        samples: samples_nm.to_vec(),
    }
}

/// Channels on one clock.
fn rebuilt(comment: String, start_s: f64, sample_time_s: f64, channels: Vec<Channel>) -> Recording {
    let count = channels.first().map_or(0, |channel| channel.samples.len());
    let time_s = (0..count).map(|k| start_s + k as f64 * sample_time_s).collect();
    Recording {
        format: Format::Mdf { version: 410 },
        comment: Some(comment),
        start_time: None,
        rasters: vec![Raster { time_s, name: None }],
        channels,
        findings: Vec::new(),
    }
}
