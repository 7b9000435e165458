//! A study that was written, without its recordings.

use std::path::{Path, PathBuf};

use recording::Selection;
use study::Origin;
use study::{Study, document};
use work::Context;

use crate::error::Error;
use crate::files::Files;
use crate::find::InputFile;
use crate::read::sha256_of_text;

const WANTED: &str = "a study.json as `dynoid study` writes";
/// In place of the day of a study whose file does not state it.
const UNKNOWN_DAY: &str = "an unknown day";

/// A study from its file.
#[derive(Debug)]
pub struct StudyFile {
    /// The study; its traces have values where their table was read.
    pub study: Study,
    /// Its day, and the hash of its bench file.
    pub origin: Origin,
    /// The table that holds the values of its traces, and why it was not read.
    pub unread: Option<(PathBuf, String)>,
}

impl StudyFile {
    /// Reads a study.json, and the table of series that it names if that is beside it.
    ///
    /// # Errors
    /// A file that cannot be read, or is no study of this version.
    pub fn load(path: &Path, files: &Files, context: &Context) -> Result<Self, Error> {
        let text = files.read_text(path, WANTED)?;
        let read = document::read(&text).map_err(|source| Error::Study { path: path.to_owned(), source })?;
        let mut study = read.study;
        let provenance = &study.provenance;
        let origin = Origin {
            date: provenance.studied_on.clone().unwrap_or_else(|| UNKNOWN_DAY.to_owned()),
            bench_file_sha256: sha256_of_text(&provenance.bench_file),
        };
        let unread = read.series_file.and_then(|name| {
            let sum = read.series_sha256.as_deref();
            let taken = beside(path, &name).and_then(|table| take_series(&mut study, &table, sum, files, context));
            Some((PathBuf::from(name), taken.err()?))
        });
        Ok(StudyFile { study, origin, unread })
    }
}

/// The file of this name in the folder of another; a name must not lead elsewhere.
fn beside(path: &Path, name: &str) -> Result<PathBuf, String> {
    match Path::new(name).file_name().is_some_and(|own| own == name) {
        true => Ok(path.with_file_name(name)),
        false => Err("a table of series must lie beside its study".to_owned()),
    }
}

/// Fills in the values of a study's traces, or says why not.
fn take_series(
    study: &mut Study,
    table: &Path,
    sha256: Option<&str>,
    files: &Files,
    context: &Context,
) -> Result<(), String> {
    if !table.is_file() {
        return Err("it is not there".to_owned());
    }
    let input = InputFile { path: table.to_owned(), name: table.display().to_string() };
    let is_other = |sum: &str| files.sha256(&input).map(|own| own != sum);
    if sha256.map_or(Ok(false), is_other).map_err(|error| error.to_string())? {
        return Err("it is of another run; run `dynoid study bench.toml` again".to_owned());
    }
    let read = files.decode(&input, &Selection::All, context).map_err(|error| error.to_string())?;
    study.take_series(&read.map_err(|error| error.to_string())?);
    if study.lacks_series() { Err("it is of another study".to_owned()) } else { Ok(()) }
}
