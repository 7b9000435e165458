//! Engine maps: tables of speed and torque.

use std::path::{Path, PathBuf};

use cycle::EngineMap;
use recording::{Channel, Recording, Selection};
use units::{Quantity, RPM_RAD_S, parse_unit_of};

use crate::error::Error;
use crate::files::Files;
use crate::find::InputFile;
use crate::paths;

/// Names of the columns, the first of each the one that messages use.
pub(super) const SPEED: &[&str] = &["speed", "engine_speed", "n", "drehzahl", "motordrehzahl"];
pub(super) const TORQUE: &[&str] = &["torque", "engine_torque", "full_load_torque", "drehmoment", "motormoment"];
const MOTORING: &[&str] = &["motoring_torque", "motoring", "drag_torque"];

/// The map in a file; rows need no time.
pub(super) fn read(path: &Path, idle_rpm: Option<f64>, files: &Files) -> Result<EngineMap, Error> {
    let recording = table(path, Some(1.0), files)?;
    let fault = |reason: String| Error::CycleTable { path: path.to_owned(), reason };
    let need = |names| column(&recording, names).ok_or_else(|| fault(missing(names)));
    let speed = si(need(SPEED)?, Quantity::AngularSpeed).map_err(fault)?;
    let torque = si(need(TORQUE)?, Quantity::Torque).map_err(fault)?;
    let motoring =
        column(&recording, MOTORING).map(|channel| si(channel, Quantity::Torque)).transpose().map_err(fault)?;
    for channel in [SPEED, TORQUE, MOTORING].into_iter().filter_map(|names| column(&recording, names)) {
        if let Some(row) = channel.samples.iter().position(|value| !value.is_finite()) {
            return Err(fault(format!("{}; fill it in, or delete the row", missing_cell(path, channel, row))));
        }
    }
    EngineMap::new(&speed, &torque, motoring.as_deref(), idle_rpm.map(|rpm| rpm * RPM_RAD_S))
        .map_err(|error| fault(error.to_string()))
}

/// A table as channels; its rows need no time where one is given.
pub(super) fn table(path: &Path, row_time_s: Option<f64>, files: &Files) -> Result<Recording, Error> {
    let file = InputFile { path: PathBuf::from(path), name: paths::with_slashes(path) };
    Ok(files.read_recording(&file, &Selection::All, row_time_s, &work::Context::new())?.recording)
}

pub(super) fn column<'a>(recording: &'a Recording, names: &[&str]) -> Option<&'a Channel> {
    let words = |name: &str| name.trim().to_lowercase().replace([' ', '-'], "_");
    let is_named = |channel: &&Channel| names.contains(&words(&channel.name).as_str());
    recording.channels.iter().find(is_named)
}

/// A cell without a value, in words: with its line where the file is a text, else with its row.
pub(super) fn missing_cell(path: &Path, channel: &Channel, row: usize) -> String {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let filled: Vec<usize> =
        (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty()).map(|(at, _)| at).collect();
    // Rows are the last lines, below the headings.
    let line = filled.len().checked_sub(channel.samples.len()).and_then(|headings| filled.get(headings + row));
    let place = line.map_or_else(|| format!("row {}", row + 1), |line| format!("line {line}"));
    format!("{place}, column `{}`: the value is missing", channel.name)
}

fn missing(names: &[&str]) -> String {
    format!(
        "a column `{}` is missing, with its unit, such as `{} [{}]`",
        names[0],
        names[0],
        if names == SPEED { "rpm" } else { "Nm" }
    )
}

/// The values of a channel in SI.
pub(super) fn si(channel: &Channel, quantity: Quantity) -> Result<Vec<f64>, String> {
    let unit = parse_unit_of(&channel.unit, quantity).map_err(|error| {
        let example = if quantity == Quantity::Torque { "Nm" } else { "rpm" };
        format!("`{0}`: {error}; write the unit into the heading, as in `{0} [{example}]`", channel.name)
    })?;
    Ok(channel.samples.iter().map(|value| unit.to_si(*value)).collect())
}
