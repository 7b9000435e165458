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
    let samples_nm = [&engine.smoothed_nm, &engine.standard_deviation_nm, &engine.zero_phase_nm];
    rebuilt(file, "engine", "of noise, masses and shaft", samples_nm, (engine.start_s, engine.sample_time_s))
}

fn of_shaft(file: &str, shaft: &RebuiltShaft) -> Recording {
    let samples_nm = [&shaft.smoothed_nm, &shaft.standard_deviation_nm, &shaft.zero_phase_nm];
    rebuilt(file, "shaft", "of the smoother", samples_nm, (shaft.start_s, shaft.sample_time_s))
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

/// The torque of an engine or a shaft on one clock, from its start and sample time: smoothed, with its standard
/// deviation, whose `causes` are named, and filtered without phase shift.
fn rebuilt(
    file: &str,
    part: &str,
    causes: &str,
    [smoothed_nm, standard_deviation_nm, zero_phase_nm]: [&Vec<f64>; 3],
    (start_s, sample_time_s): (f64, f64),
) -> Recording {
    let doubts = format!("{causes}; a once-a-turn error of the encoder only as far as the speeds show it");
    let channels = vec![
        torque(&format!("{part}_torque"), "by a fixed-interval smoother", smoothed_nm),
        torque(&format!("{part}_torque_standard_deviation"), &doubts, standard_deviation_nm),
        torque(&format!("{part}_torque_zero_phase"), "by a filter without phase shift", zero_phase_nm),
    ];
    let time_s = (0..smoothed_nm.len()).map(|k| start_s + k as f64 * sample_time_s).collect();
    Recording {
        format: Format::Mdf { version: 410 },
        comment: Some(format!("{part} torque rebuilt from {file}")),
        start_time: None,
        rasters: vec![Raster { time_s, name: None }],
        channels,
        findings: Vec::new(),
    }
}
