//! Recordings: which there are, their channels, and views of them.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use axum::extract::{Query, State};
use dynoid::paths::with_slashes;
use recording::{Catalogue, Envelope, Handle};
use serde::{Deserialize, Serialize};
use work::Context;

use crate::answer::{Answer, Fault, json, of_type};
use crate::blocking::blocking;
use crate::folder::{Folder, Which};
use crate::shared::Shared;

/// Folders within the open one, and files in all, that a page lists.
const DEEPEST: usize = 4;
const MOST_FILES: usize = 2000;
/// Columns of a view, at most.
const MOST_COLUMNS: usize = 8192;

/// A file of the folder.
#[derive(Debug, Serialize)]
struct Listed {
    file: String,
    bytes: u64,
    /// Milliseconds since 1970.
    changed_ms: Option<u128>,
}

/// The folder, and what is in it.
#[derive(Debug, Serialize)]
struct Contents {
    version: &'static str,
    folder: String,
    recordings: Vec<Listed>,
    benches: Vec<Listed>,
    reports: Vec<Listed>,
    models: Vec<Listed>,
}

/// The folder with its recordings, bench files, reports and models.
pub(crate) async fn state(State(shared): State<Shared>) -> Answer {
    blocking(move || {
        let root = shared.folder.root();
        let mut contents = Contents {
            version: env!("CARGO_PKG_VERSION"),
            folder: root.display().to_string(),
            recordings: Vec::new(),
            benches: Vec::new(),
            reports: Vec::new(),
            models: Vec::new(),
        };
        for (file, path) in files_of(&shared.folder) {
            let Ok(metadata) = path.metadata() else { continue };
            let changed = metadata.modified().ok().and_then(|at| at.duration_since(SystemTime::UNIX_EPOCH).ok());
            let listed = Listed { file, bytes: metadata.len(), changed_ms: changed.map(|at| at.as_millis()) };
            match path.extension().and_then(|ending| ending.to_str()) {
                Some("toml") if dynoid::is_bench_file(&path) => contents.benches.push(listed),
                Some("html") => contents.reports.push(listed),
                Some("json") if listed.file.contains("model") => contents.models.push(listed),
                _ if is_recording(&path) => contents.recordings.push(listed),
                _ => {}
            }
        }
        json(&contents)
    })
    .await
}

/// Names of the recordings of the folder, in order.
pub(crate) fn recordings_of(folder: &Folder) -> Vec<String> {
    files_of(folder).filter(|(_, path)| is_recording(path)).map(|(name, _)| name).collect()
}

/// The figures of a study are no recording.
fn is_recording(path: &Path) -> bool {
    dynoid::is_recording(path) && !path.ends_with(dynoid::SERIES)
}

/// The files of the folder with their names in it.
pub(crate) fn files_of(folder: &Folder) -> impl Iterator<Item = (String, PathBuf)> {
    let (root, mut files) = (folder.root().to_owned(), Vec::new());
    walk(&root, DEEPEST, &mut files);
    files.into_iter().filter_map(move |path| Some((with_slashes(path.strip_prefix(&root).ok()?), path)))
}

/// The files below a folder, in order; hidden folders and links are left out.
fn walk(folder: &Path, depth: usize, files: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut entries: Vec<_> = entries.collect();
    entries.sort_unstable_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
        let Ok(kind) = entry.file_type() else { continue };
        if is_hidden || files.len() >= MOST_FILES {
            continue;
        }
        if kind.is_dir() && depth > 0 {
            walk(&entry.path(), depth - 1, files);
        } else if kind.is_file() {
            files.push(entry.path());
        }
    }
}

/// The channels of a recording.
pub(crate) async fn channels(State(shared): State<Shared>, Query(which): Query<Which>) -> Answer {
    blocking(move || {
        let catalogue: Catalogue = handle(&shared, &which.file)?.catalogue().map_err(Fault::refused)?;
        json(&catalogue)
    })
    .await
}

/// A stretch of some channels, and how it is looked at.
#[derive(Deserialize)]
pub(crate) struct Asked {
    pub(crate) file: String,
    /// Names, as a list in JSON.
    channels: String,
    from_s: Option<f64>,
    to_s: Option<f64>,
    pub(crate) bins: Option<usize>,
    pub(crate) segment: Option<usize>,
    pub(crate) columns: Option<usize>,
    pub(crate) bands: Option<usize>,
    pub(crate) up_to_hz: Option<f64>,
}

impl Asked {
    /// Names of the channels.
    pub(crate) fn names(&self) -> Result<Vec<String>, Fault> {
        serde_json::from_str(&self.channels).map_err(Fault::refused)
    }

    /// Where the stretch begins, s; infinite where that is not said.
    pub(crate) fn begin_s(&self) -> f64 {
        self.from_s.unwrap_or(f64::NEG_INFINITY)
    }

    /// Where it ends.
    pub(crate) fn end_s(&self) -> f64 {
        self.to_s.unwrap_or(f64::INFINITY)
    }
}

/// Columns of a plot of some channels: of each channel how many there are, then of each column the first and last
/// stamp, the least and the largest sample, the first and the last sample: floats of 64 bits, the low byte first.
pub(crate) async fn view(State(shared): State<Shared>, Query(asked): Query<Asked>) -> Answer {
    blocking(move || {
        let (handle, names) = (handle(&shared, &asked.file)?, asked.names()?);
        let columns = asked.columns.unwrap_or(1000).clamp(1, MOST_COLUMNS);
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let mut bytes = Vec::new();
        for pyramid in handle.pyramids(&names, &Context::new()).map_err(Fault::refused)? {
            let view = pyramid.view(asked.begin_s(), asked.end_s(), columns).map_err(Fault::refused)?;
            bytes.extend((view.len() as f64).to_le_bytes());
            bytes.extend(view.iter().flat_map(numbers));
        }
        Ok(of_type("application/octet-stream", bytes))
    })
    .await
}

fn numbers(column: &Envelope) -> impl Iterator<Item = u8> + use<> {
    let Envelope { from_s, to_s, min, max, first, last, .. } = *column;
    let [min, max, first, last] = [min, max, first, last].map(|sample| sample.unwrap_or(f64::NAN));
    [from_s, to_s, min, max, first, last].into_iter().flat_map(f64::to_le_bytes)
}

/// The open recording of a file.
pub(crate) fn handle(shared: &Shared, file: &str) -> Result<Handle, Fault> {
    shared.handles.of(file, &shared.folder.existing(file)?)
}
