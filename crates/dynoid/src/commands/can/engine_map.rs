//! Engine maps: tables of speed and torque.

use std::path::{Path, PathBuf};

use cycle::EngineMap;
use recording::{Channel, Recording, Selection};
use units::{Quantity, RPM_RAD_S, parse_unit_of};

use crate::error::CliError;
use crate::input::{self, InputFile};
use crate::paths;

/// Names of the columns, the first of each the one that messages use.
pub(super) const SPEED: &[&str] = &["speed", "engine_speed", "n", "drehzahl", "motordrehzahl"];
pub(super) const TORQUE: &[&str] = &["torque", "engine_torque", "full_load_torque", "drehmoment", "motormoment"];
const MOTORING: &[&str] = &["motoring_torque", "motoring", "drag_torque"];

/// The map in a file; rows need no time.
pub(super) fn read(path: &Path, idle_rpm: Option<f64>) -> Result<EngineMap, CliError> {
    let recording = table(path, Some(1.0))?;
    let fault = |reason: String| CliError::CycleTable { path: path.to_owned(), reason };
    let need = |names| column(&recording, names).ok_or_else(|| fault(missing(names)));
    let speed = si(need(SPEED)?, Quantity::AngularSpeed).map_err(fault)?;
    let torque = si(need(TORQUE)?, Quantity::Torque).map_err(fault)?;
    let motoring =
        column(&recording, MOTORING).map(|channel| si(channel, Quantity::Torque)).transpose().map_err(fault)?;
    EngineMap::new(&speed, &torque, motoring.as_deref(), idle_rpm.map(|rpm| rpm * RPM_RAD_S))
        .map_err(|error| fault(error.to_string()))
}

/// A table as channels; its rows need no time where one is given.
pub(super) fn table(path: &Path, row_time_s: Option<f64>) -> Result<Recording, CliError> {
    let file = InputFile { path: PathBuf::from(path), name: paths::with_slashes(path) };
    Ok(input::read_recording(&file, &Selection::All, row_time_s, &|_, _| {})?.recording)
}

pub(super) fn column<'a>(recording: &'a Recording, names: &[&str]) -> Option<&'a Channel> {
    let words = |name: &str| name.trim().to_lowercase().replace([' ', '-'], "_");
    let is_named = |channel: &&Channel| names.contains(&words(&channel.name).as_str());
    recording.channels.iter().find(is_named)
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
