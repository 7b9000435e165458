//! Cycles of one's own: tables of time, speed and torque.

use std::path::Path;

use cycle::{EngineMap, Reference, Rule, Scales, SpeedScale};
use numerics::order::upper_median;
use recording::{Channel, Recording, Selection};
use units::{Quantity, parse_unit_of};

use super::engine_map::{self, SPEED, TORQUE};
use crate::error::Error;
use crate::files::Files;
use crate::paths;

/// Value read for a cell that marks motoring: no torque in Nm or % is so large.
const MOTORED: f64 = -99_999.0;
/// Words of such a cell.
const MARKS: [&str; 4] = ["m", "motoring", "motored", "closed throttle"];
/// Endings of files in which a word can stand for a number.
const TEXTS: [&str; 3] = ["csv", "tsv", "txt"];
/// Time between points at least, s: cycles are simulated in steps of this.
const LEAST_STEP_S: f64 = 0.005;
/// A step that is so many times the usual one is a gap.
const GAP: f64 = 1.9;
/// Share of the steps that are the usual one in a table that is even but for gaps.
const EVEN: f64 = 0.9;

/// The cycle in a file, if its columns are those of one: speed in a unit or in %, torque in a unit or in %. Its gaps
/// are there in words.
pub(super) fn read(
    path: &Path,
    map: Option<&EngineMap>,
    files: &Files,
) -> Result<Option<(Reference, Option<String>)>, Error> {
    let recording = table(path, files)?;
    let find = |names| engine_map::column(&recording, names);
    let (Some(speed), Some(torque)) = (find(SPEED), find(TORQUE)) else { return Ok(None) };
    let fault = |reason: String| Error::CycleTable { path: path.to_owned(), reason };
    let time_s = recording.time_s(speed).unwrap_or_default().to_vec();
    if recording.time_s(torque).unwrap_or_default() != time_s.as_slice() || time_s.len() < 3 {
        return Err(fault("speed and torque need one time, with three rows or more".to_owned()));
    }
    let motored = "fill it in, or write m where the engine is motored";
    for (channel, remedy) in [(speed, "fill it in"), (torque, motored)] {
        if let Some(row) = channel.samples.iter().position(|value| !value.is_finite()) {
            return Err(fault(format!("{}; {remedy}", engine_map::missing_cell(path, channel, row))));
        }
    }
    let course = course(speed, torque, map).map_err(|unread| match unread {
        Unread::Fault(reason) => fault(reason),
        Unread::NeedsMap(what) => Error::NeedsMap { path: path.to_owned(), what },
    })?;
    let usual_s = usual_s(&time_s).map_err(fault)?;
    // Points further apart than a second have points each second in between.
    let step_s = 1.0 / (1.0 / usual_s).round().clamp(1.0, 1.0 / LEAST_STEP_S);
    let gaps = gaps(&time_s, usual_s).map(|words| format!("{}: {words}", paths::with_slashes(path)));
    let (speeds, torques) = evenly(&time_s, &course, step_s).into_iter().unzip();
    let mut reference = Reference { step_s, ..Reference::of_itself(0.0, speeds, torques) };
    if let Some(map) = map {
        reference.scales = Scales::of(map);
    }
    Ok(Some((reference, gaps)))
}

/// The table, with a number in place of each word that marks motoring.
fn table(path: &Path, files: &Files) -> Result<Recording, Error> {
    if !paths::ending(path).is_some_and(|ending| TEXTS.iter().any(|text| ending.eq_ignore_ascii_case(text))) {
        return engine_map::table(path, None, files);
    }
    let text = files.read_bytes(path)?;
    let Ok(text) = String::from_utf8(text) else { return engine_map::table(path, None, files) };
    let is_mark = |cell: &str| MARKS.iter().any(|mark| cell.trim().trim_matches('"').eq_ignore_ascii_case(mark));
    let separator = |c: char| matches!(c, ';' | ',' | '\t');
    let line = |line: &str| -> String {
        let cell = |cell: &str| {
            let end = cell.trim_end_matches(separator);
            if is_mark(end) { format!("{MOTORED}{}", &cell[end.len()..]) } else { cell.to_owned() }
        };
        line.split_inclusive(separator).map(cell).collect()
    };
    let marked: Vec<String> = text.lines().map(line).collect();
    recording::decode(&paths::with_slashes(path), marked.join("\n").as_bytes(), &Selection::All)
        .map_err(|source| Error::Recording { source, untimed: false })
}

/// Why a table has no course.
enum Unread {
    Fault(String),
    /// A fact of the table for which the engine's map is needed.
    NeedsMap(&'static str),
}

/// Speed, rad/s, and torque, Nm, of each row.
fn course(speed: &Channel, torque: &Channel, map: Option<&EngineMap>) -> Result<Vec<(f64, f64)>, Unread> {
    let need_map = |what: &'static str| map.ok_or(Unread::NeedsMap(what));
    let speeds = match percent(speed) {
        Some(values) => {
            let scale = SpeedScale::of(Rule::Cfr1065, need_map("the speed is in %")?);
            values.into_iter().map(|value| scale.speed_rad_s(value)).collect()
        }
        None => engine_map::si(speed, Quantity::AngularSpeed).map_err(Unread::Fault)?,
    };
    let parts = percent(torque);
    let torques = match parts {
        None => engine_map::si(torque, Quantity::Torque).map_err(Unread::Fault)?,
        Some(_) => Vec::new(),
    };
    let row = |k: usize| {
        let (speed, recorded) = (speeds[k], torque.samples[k]);
        let torque = match &parts {
            _ if recorded == MOTORED => need_map("a row marks motoring")?.motoring_nm(speed),
            Some(parts) if parts[k] < 0.0 => need_map("the torque is in %")?.motoring_nm(speed),
            Some(parts) => 0.01 * parts[k] * need_map("the torque is in %")?.full_load_nm(speed),
            None => torques[k],
        };
        Ok((speed, torque))
    };
    (0..speeds.len()).map(row).collect()
}

/// The values in %, if the unit is one of ratios.
fn percent(channel: &Channel) -> Option<Vec<f64>> {
    let unit = parse_unit_of(channel.unit.trim(), Quantity::Ratio).ok().filter(|_| !channel.unit.trim().is_empty())?;
    Some(channel.samples.iter().map(|value| 100.0 * unit.to_si(*value)).collect())
}

/// The median time from row to row, s.
fn usual_s(time_s: &[f64]) -> Result<f64, String> {
    if let Some(row) = time_s.windows(2).position(|pair| pair[1] <= pair[0]) {
        return Err(format!("row {}: time does not rise; sort the rows", row + 2));
    }
    let mut steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    upper_median(&mut steps).ok_or_else(|| "there are no rows".to_owned())
}

/// Gaps of an even table, in words. A table with steps of many lengths gives the corners of its course on purpose.
fn gaps(time_s: &[f64], usual_s: f64) -> Option<String> {
    let steps = || time_s.windows(2).map(|pair| pair[1] - pair[0]);
    let is_usual = |step: f64| (step - usual_s).abs() < 0.1 * usual_s;
    let usual = steps().filter(|step| is_usual(*step)).count();
    let gaps: Vec<(usize, f64)> = steps().enumerate().filter(|(_, step)| *step > GAP * usual_s).collect();
    let (row, gap_s) = *gaps.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let is_even = usual as f64 >= EVEN * (time_s.len() - 1) as f64;
    let gap_s = (1e3 * gap_s).round() / 1e3;
    let which = match gaps.len() {
        1 => format!("a gap of {gap_s} s"),
        count => format!("{count} gaps in time, the longest of {gap_s} s"),
    };
    is_even.then(|| format!("{which} after row {}; speed and torque are straight across it", row + 1))
}

/// The points at even steps from the first stamp on, straight in between.
fn evenly(time_s: &[f64], course: &[(f64, f64)], step_s: f64) -> Vec<(f64, f64)> {
    let (first, last) = (time_s[0], time_s[time_s.len() - 1]);
    let at = |step: usize| {
        let time = first + step as f64 * step_s;
        let above = time_s.partition_point(|stamp| *stamp <= time).clamp(1, time_s.len() - 1);
        let share = ((time - time_s[above - 1]) / (time_s[above] - time_s[above - 1])).clamp(0.0, 1.0);
        let (a, b) = (course[above - 1], course[above]);
        (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1))
    };
    (0..=((last - first) / step_s + 1e-6).floor() as usize).map(at).collect()
}
