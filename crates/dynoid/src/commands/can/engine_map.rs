//! Tables of speeds and torques: engine maps, and cycles of one's own.

use std::path::{Path, PathBuf};

use cycle::{EngineMap, Reference, Rule, Scales, denormalised};
use recording::{Channel, Recording, Selection};
use units::{Quantity, RPM_RAD_S, parse_unit_of};

use crate::error::CliError;
use crate::input::{self, InputFile};
use crate::paths;

/// Names of the columns, the first of each the one that messages use.
const SPEED: &[&str] = &["speed", "engine_speed", "n"];
const TORQUE: &[&str] = &["torque", "engine_torque", "full_load_torque"];
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

/// The cycle in a file, if its columns are those of one: speed and torque, both in units or both in %.
pub(super) fn cycle(path: &Path, map: Option<&EngineMap>) -> Result<Option<Reference>, CliError> {
    let recording = table(path, None)?;
    let (Some(speed), Some(torque)) = (column(&recording, SPEED), column(&recording, TORQUE)) else { return Ok(None) };
    let fault = |reason: String| CliError::CycleTable { path: path.to_owned(), reason };
    let time_s = recording.time_s(speed).unwrap_or_default().to_vec();
    if recording.time_s(torque).unwrap_or_default() != time_s.as_slice() || time_s.len() < 3 {
        return Err(fault("speed and torque need one time, with three rows or more".to_owned()));
    }
    let course: Vec<(f64, f64)> = if speed.unit.trim() == "%" {
        let map =
            map.ok_or_else(|| fault("speed and torque are in %; give the engine's map with --engine-map".to_owned()))?;
        let motored = |torque: f64| if torque < 0.0 || torque.is_nan() { None } else { Some(torque) };
        let percent: Vec<_> = speed.samples.iter().zip(&torque.samples).map(|(n, t)| (*n, motored(*t))).collect();
        denormalised(&percent, Rule::Cfr1065, map)
    } else {
        let speed = si(speed, Quantity::AngularSpeed).map_err(fault)?;
        let torque = si(torque, Quantity::Torque).map_err(fault)?;
        speed.into_iter().zip(torque).collect()
    };
    let seconds = each_second(&time_s, &course).map_err(fault)?;
    let (speeds, torques): (Vec<f64>, Vec<f64>) = seconds.into_iter().unzip();
    let mut reference = Reference::of_itself(0.0, speeds, torques);
    if let Some(map) = map {
        reference.scales = Scales::of(map);
    }
    Ok(Some(reference))
}

/// The points at whole seconds from the first stamp on, straight in between.
fn each_second(time_s: &[f64], course: &[(f64, f64)]) -> Result<Vec<(f64, f64)>, String> {
    if let Some(row) = course.iter().position(|(n, t)| !n.is_finite() || !t.is_finite()) {
        return Err(format!("row {}: a value is missing; fill it in", row + 1));
    }
    if let Some(row) = time_s.windows(2).position(|pair| pair[1] <= pair[0]) {
        return Err(format!("row {}: time does not rise; sort the rows", row + 2));
    }
    let (first, last) = (time_s[0], time_s[time_s.len() - 1]);
    let at = |second: usize| {
        let time = first + second as f64;
        let above = time_s.partition_point(|stamp| *stamp <= time).clamp(1, time_s.len() - 1);
        let share = ((time - time_s[above - 1]) / (time_s[above] - time_s[above - 1])).clamp(0.0, 1.0);
        let (a, b) = (course[above - 1], course[above]);
        (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1))
    };
    Ok((0..=(last - first + 1e-6).floor() as usize).map(at).collect())
}

fn table(path: &Path, row_time_s: Option<f64>) -> Result<Recording, CliError> {
    let file = InputFile { path: PathBuf::from(path), name: paths::with_slashes(path) };
    Ok(input::read_recording(&file, &Selection::All, row_time_s, &|_, _| {})?.recording)
}

fn column<'a>(recording: &'a Recording, names: &[&str]) -> Option<&'a Channel> {
    let is_named = |channel: &&Channel| names.iter().any(|name| channel.name.trim().eq_ignore_ascii_case(name));
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

fn si(channel: &Channel, quantity: Quantity) -> Result<Vec<f64>, String> {
    let unit = parse_unit_of(&channel.unit, quantity).map_err(|error| format!("`{}`: {error}", channel.name))?;
    Ok(channel.samples.iter().map(|value| unit.to_si(*value)).collect())
}
