//! Recordings of a folder beside a bench file: which it uses, the experiment of each, and what the data say of it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use recording::{Recording, Selection};
use rig::bench_file::{RunChannels, StretchUse, names_same_file};
use rig::channels::guess_roles;
use rig::prepare::recognised;
use rig::{ExperimentLabel, Role, prepare_run};
use serde::Serialize;
use toml::Value;
use work::Context;

use crate::error::Error;
use crate::files::Files;
use crate::find::{InputFile, listed};
use crate::paths;

/// Roles that show an experiment: of each list the first that is there.
const SHOWING: [&[Role]; 5] = [
    &[Role::DynoSpeed],
    &[Role::EngineSpeed],
    &[Role::DynoTorqueDemand],
    &[Role::DynoSpeedDemand],
    &[Role::AirGapTorque, Role::LoadCellTorque, Role::FlangeTorque],
];
/// Roles that a small plot shows: of each list the first that is there.
const DRAWN: [&[Role]; 2] = [
    &[Role::DynoSpeed, Role::EngineSpeed],
    &[Role::AirGapTorque, Role::LoadCellTorque, Role::FlangeTorque, Role::DynoTorqueDemand],
];

/// A recording as a bench file uses it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordingUse {
    /// Its name in the bench file.
    pub name: String,
    /// True where the bench file lists it.
    pub is_used: bool,
    /// The label that the bench file states.
    pub stated: Option<String>,
    /// Place of that label among those of the bench file.
    pub place: Option<usize>,
    /// The label in its file's name.
    pub in_name: Option<String>,
    /// Its stretches that the bench file states.
    pub stretches: Vec<PlacedStretch>,
}

/// A stretch of a recording, as the text of a bench file has it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlacedStretch {
    /// Its place among the stretches of the bench file.
    pub place: usize,
    /// Key of its use, such as `leave_out`.
    pub usage: &'static str,
    /// Its beginning, s of the recording's clock.
    pub from_s: f64,
    /// Its end, s of the recording's clock.
    pub to_s: f64,
}

/// The experiment that a recording shows by itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SeenLabel {
    /// The label, if the data show one.
    pub label: Option<String>,
    /// Reasons for it, or against one.
    pub reasons: Vec<String>,
    /// Channels that show it at a glance: a speed and a torque.
    pub channels: Vec<String>,
}

/// How the text of a bench file at `bench` uses recordings, whose paths are given. The text may have gaps and faults.
pub fn uses(bench: &Path, text: &str, recordings: &[PathBuf]) -> Vec<RecordingUse> {
    let table: toml::Table = text.parse().unwrap_or_default();
    let section = table.get("recordings");
    let list = |key: &str| section.and_then(|found| found.get(key)).and_then(Value::as_array).into_iter().flatten();
    let patterns: Vec<String> = list("files").filter_map(|pattern| Some(pattern.as_str()?.to_owned())).collect();
    let real = |path: &PathBuf| path.canonicalize().unwrap_or_else(|_| path.clone());
    // A pattern that matches nothing says nothing of the others.
    let used: BTreeSet<PathBuf> = patterns
        .iter()
        .filter_map(|pattern| listed(bench, std::slice::from_ref(pattern)).ok())
        .flatten()
        .map(|file| real(&file.path))
        .collect();
    let labels: Vec<(&str, &str)> = list("label")
        .map(|label| ["file", "label"].map(|key| label.get(key).and_then(Value::as_str).unwrap_or_default()).into())
        .collect();
    let stretches: Vec<(&str, PlacedStretch)> = list("stretch").enumerate().filter_map(placed).collect();
    let folder = paths::folder_of(bench);
    let of = |path: &PathBuf| {
        let name = paths::with_slashes(&paths::relative_to(path, &folder));
        let place = labels.iter().position(|(file, _)| names_same_file(&name, file));
        RecordingUse {
            is_used: used.contains(&real(path)),
            stated: place.map(|place| labels[place].1.to_owned()),
            place,
            in_name: label_in(path).map(|label| label.to_string()),
            stretches: stretches
                .iter()
                .filter(|(file, _)| names_same_file(&name, file))
                .map(|(_, stretch)| stretch.clone())
                .collect(),
            name,
        }
    };
    recordings.iter().map(of).collect()
}

/// A stretch of the text, with its file; none where it has faults.
fn placed((place, stretch): (usize, &Value)) -> Option<(&str, PlacedStretch)> {
    let number = |value: &Value| value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
    let times = |usage: &StretchUse| Some((usage.key(), stretch.get(usage.key())?.as_array()?));
    let (usage, times) = StretchUse::ALL.iter().find_map(times)?;
    let (from_s, to_s) = (times.first().and_then(number)?, times.get(1).and_then(number)?);
    Some((stretch.get("file")?.as_str()?, PlacedStretch { place, usage, from_s, to_s }))
}

/// The experiment that a recording shows by itself. The text of a bench file names the channels; where it names none,
/// they are guessed.
///
/// # Errors
/// A recording that cannot be read.
pub fn seen_label(text: &str, file: &InputFile, files: &Files, context: &Context) -> Result<SeenLabel, Error> {
    let stated = text.parse::<RunChannels>().ok().filter(|run| !run.channels.is_empty());
    let (recording, run) = match stated {
        Some(run) => (decoded(file, &run, files, context)?, run),
        None => {
            let recording = whole(file, files, context)?;
            let channels = guess_roles(&[(&file.name, &recording)]).mappings();
            (recording, RunChannels { channels, speed_limit_rad_s: None })
        }
    };
    // The label is what is sought; nothing here looks at it.
    let unknown = ExperimentLabel::BS_T_NT;
    let (label, reasons) = match prepare_run(&file.name, &recording, &run, &SHOWING, unknown) {
        Ok((experiment, _)) => recognised(&experiment),
        Err(_) => (None, Vec::new()),
    };
    let channel = |roles: &&[Role]| {
        let names = roles.iter().filter_map(|role| Some(run.channels.get(role)?.name.clone()));
        names.into_iter().find(|name| recording.channel(name).is_some())
    };
    Ok(SeenLabel {
        label: label.map(|label| label.to_string()),
        reasons: reasons.iter().map(ToString::to_string).collect(),
        channels: DRAWN.iter().filter_map(channel).collect(),
    })
}

fn whole(file: &InputFile, files: &Files, context: &Context) -> Result<Recording, Error> {
    let read = files.decode(file, &Selection::All, context)?;
    read.map_err(|source| Error::Recording { source, untimed: false })
}

/// The channels that show an experiment.
fn decoded(file: &InputFile, run: &RunChannels, files: &Files, context: &Context) -> Result<Recording, Error> {
    let catalogue = files.catalogue(file)?;
    let is_there = |name: &str| catalogue.channels.iter().any(|channel| channel.name == name);
    let wanted = SHOWING.iter().chain(&DRAWN).flat_map(|roles| roles.iter());
    let names: BTreeSet<&str> = wanted.filter_map(|role| Some(run.channels.get(role)?.name.as_str())).collect();
    let selection = Selection::names(names.into_iter().filter(|name| is_there(name)));
    let read = files.decode(file, &selection, context)?;
    read.map_err(|source| Error::Recording { source, untimed: false })
}

fn label_in(path: &Path) -> Option<ExperimentLabel> {
    path.file_name()?.to_string_lossy().parse().ok()
}
