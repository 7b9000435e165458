//! Recordings that were read.

use std::path::PathBuf;

use ident::{Dataset, Experiment, Source};
use recording::{Recording, RecordingError, Selection};
use work::Context;

use super::loaded::named;
use crate::error::Error;
use crate::files::Files;
use crate::find::InputFile;

/// Recordings, their names and the hashes of their bytes.
#[derive(Debug)]
pub struct RecordedFiles {
    all: Vec<File>,
    /// The time from row to row that text without a time column was read with; none where there is no such text.
    row_time_s: Option<f64>,
}

#[derive(Debug)]
struct File {
    file: InputFile,
    /// Name in results.
    name: String,
    recording: Recording,
    sha256: String,
}

impl RecordedFiles {
    /// Reads these channels of recordings, all where none are named. Text without a time column is read where the time
    /// from row to row is given.
    ///
    /// # Errors
    /// A file that cannot be read, or is named twice.
    pub fn read(
        paths: &[PathBuf],
        channels: &[&str],
        row_time_s: Option<f64>,
        files: &Files,
        context: &Context,
    ) -> Result<Self, Error> {
        let named = files.named(paths)?;
        check_once(&named)?;
        let names = short_names(&named);
        let step = context.step("reading", named.len() as u64);
        let (mut all, mut untimed) = (Vec::new(), false);
        for (file, name) in named.into_iter().zip(names) {
            let reading = step.step(format!("reading {}", file.name), 0);
            let (recording, is_untimed) = decode(&file, channels, row_time_s, &reading, files)?;
            let sha256 = files.sha256(&file)?;
            untimed |= is_untimed;
            all.push(File { file, name, recording, sha256 });
        }
        Ok(RecordedFiles { all, row_time_s: row_time_s.filter(|_| untimed) })
    }

    /// Tells whether reading them with this time from row to row would give the same.
    pub fn serves(&self, row_time_s: f64) -> bool {
        self.row_time_s.is_none_or(|used_s| used_s == row_time_s)
    }

    /// Tells whether one of them is text without a time column.
    pub fn are_untimed(&self) -> bool {
        self.row_time_s.is_some()
    }

    pub(super) fn recordings(&self) -> Vec<(&str, &Recording)> {
        self.all.iter().map(|f| (f.name.as_str(), &f.recording)).collect()
    }

    /// Where each experiment of the data comes from, one a recording.
    pub(super) fn sources(&self, data: &Dataset) -> Vec<Source> {
        let source = |(file, experiment): (&File, &Experiment)| Source {
            file: file.file.name.clone(),
            sha256: file.sha256.clone(),
            from_s: experiment.start_s,
            to_s: experiment.start_s + experiment.len().saturating_sub(1) as f64 * data.sample_time_s(),
        };
        self.all.iter().zip(data.experiments()).map(source).collect()
    }

    /// The recordings and the channels of data, as a message about them begins.
    pub(super) fn named(&self, data: &Dataset) -> String {
        named(data, &self.sources(data))
    }

    /// How the time of recordings was read, where only their numbers show it.
    pub(super) fn clocks(&self) -> Vec<String> {
        let said = |file: &File| {
            let about_time = file.recording.findings.iter().filter(|finding| finding.is_about_time());
            about_time.map(|finding| format!("{}: {finding}", file.name)).collect::<Vec<_>>()
        };
        self.all.iter().flat_map(said).collect()
    }

    /// A warning for each recording whose content was given before under another name.
    pub(super) fn doubles(&self) -> Vec<String> {
        let double = |(index, file): (usize, &File)| {
            let first = self.all[..index].iter().find(|before| before.sha256 == file.sha256)?;
            Some(format!("{} holds the same as {}, which counts it twice", file.file.name, first.file.name))
        };
        self.all.iter().enumerate().filter_map(double).collect()
    }
}

/// Refuses a file that is named twice: it would count twice.
fn check_once(files: &[InputFile]) -> Result<(), Error> {
    let place = |file: &InputFile| file.path.canonicalize().unwrap_or_else(|_| file.path.clone());
    let places: Vec<PathBuf> = files.iter().map(place).collect();
    match places.iter().enumerate().find(|(index, place)| places[..*index].contains(place)) {
        Some((index, _)) => Err(Error::RecordingTwice { name: files[index].name.clone() }),
        None => Ok(()),
    }
}

/// Names of recordings: their file's name alone if no two files share it.
fn short_names(files: &[InputFile]) -> Vec<String> {
    let short = |file: &InputFile| file.path.file_name().map(|n| n.to_string_lossy().into_owned());
    let names: Vec<Option<String>> = files.iter().map(short).collect();
    let is_unique = |name: &Option<String>| names.iter().filter(|n| *n == name).count() == 1;
    let all_unique = names.iter().all(is_unique);
    let name = |(file, name): (&InputFile, &Option<String>)| match name {
        Some(name) if all_unique => name.clone(),
        _ => file.name.clone(),
    };
    files.iter().zip(&names).map(name).collect()
}

/// A recording, and whether it is text without a time column, which is read where the time from row to row is given.
/// Where a channel that is named is not there, it holds all of them: what they are can be said then.
fn decode(
    file: &InputFile,
    channels: &[&str],
    row_time_s: Option<f64>,
    context: &Context,
    files: &Files,
) -> Result<(Recording, bool), Error> {
    let wanted = if channels.is_empty() { Selection::All } else { Selection::names(channels.iter().copied()) };
    let read = |wanted: &Selection| files.read_recording(file, wanted, row_time_s, context);
    let read = match read(&wanted) {
        Err(Error::Recording { source: RecordingError::NoSuchChannel { .. }, .. }) => read(&Selection::All)?,
        other => other?,
    };
    Ok((read.recording, read.is_untimed))
}
