//! The formats that recordings are written in.

use std::io::{self, Cursor, Write};
use std::path::Path;

use recording::{Recording, RecordingError};

use crate::error::Error;
use crate::features;
use crate::files::Files;
use crate::mark::Mark;
use crate::output::Staging;
use crate::paths::ending;

/// A format of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileFormat {
    /// MDF 4.10
    Mf4,
    /// Text, commas between the columns
    Csv,
    /// Text, tabs between the columns
    Tsv,
    /// MATLAB -v7
    Mat,
    /// Parquet
    Parquet,
    /// Arrow, Feather
    Arrow,
}

const ENDINGS: &str = ".mf4, .csv, .tsv, .mat, .parquet or .arrow";

impl FileFormat {
    /// The ending of its files.
    pub fn ending(self) -> &'static str {
        match self {
            FileFormat::Mf4 => "mf4",
            FileFormat::Csv => "csv",
            FileFormat::Tsv => "tsv",
            FileFormat::Mat => "mat",
            FileFormat::Parquet => "parquet",
            FileFormat::Arrow => "arrow",
        }
    }

    /// The format that a file's ending says.
    pub fn of(path: &Path) -> Option<Self> {
        Some(match ending(path)?.to_lowercase().as_str() {
            "mf4" | "mdf" => FileFormat::Mf4,
            "csv" => FileFormat::Csv,
            "tsv" => FileFormat::Tsv,
            "mat" => FileFormat::Mat,
            "parquet" => FileFormat::Parquet,
            "arrow" | "feather" => FileFormat::Arrow,
            _ => return None,
        })
    }

    /// As [`Self::of`], of a file to be written. Fails for a format that this build leaves out.
    pub fn of_output(path: &Path) -> Result<Self, Error> {
        let format = Self::of(path).ok_or_else(|| Error::OutputEnding { path: path.to_owned(), endings: ENDINGS })?;
        match format {
            FileFormat::Parquet => features::PARQUET.check(path, "Parquet")?,
            FileFormat::Arrow => features::PARQUET.check(path, "Arrow")?,
            FileFormat::Mf4 | FileFormat::Csv | FileFormat::Tsv | FileFormat::Mat => {}
        }
        Ok(format)
    }

    /// Tells whether its files are text.
    pub fn is_text(self) -> bool {
        matches!(self, FileFormat::Csv | FileFormat::Tsv)
    }

    /// Writes a recording in this format, piece by piece.
    pub fn write(self, recording: &Recording, path: &Path, files: &Files) -> Result<(), Error> {
        let mut staging = Staging::of(files);
        self.stage(recording, path, &mut staging)?;
        staging.finish()
    }

    /// Writes a recording as [`Self::write`] does, to get its name together with other files.
    pub fn stage(self, recording: &Recording, path: &Path, staging: &mut Staging) -> Result<(), Error> {
        let program = staging.files().generator();
        let mark = Mark::of_run(staging.files());
        staging.add(path, Some(&mark), |out| {
            let written = match self {
                FileFormat::Mf4 => recording::write_mdf4(recording, &program, out),
                FileFormat::Csv => recording::write_csv(recording, out),
                FileFormat::Tsv => recording::write_tsv(recording, out),
                FileFormat::Mat => recording::write_mat5(recording, &program, out),
                FileFormat::Parquet => parquet(recording, &program, out),
                FileFormat::Arrow => arrow(recording, out),
            };
            written.map_err(|source| match source {
                RecordingError::Unwritable { kind, detail } => Error::write(path, io::Error::new(kind, detail)),
                source => Error::Encode { source },
            })
        })
    }

    /// Gives channels names that the format can hold. Returns what was done, and what it has no place for.
    pub fn fit(self, recording: &mut Recording) -> Vec<String> {
        let mut notes = Vec::new();
        if !self.is_text() {
            return notes;
        }
        for (number, channel) in recording.channels.iter_mut().enumerate() {
            let (name, unit) = (text_name(&channel.name, number), in_one_line(&channel.unit).replace(['[', ']'], ""));
            let unit = if recording::fits_text("x", &channel.unit) { channel.unit.clone() } else { unit };
            if !recording::fits_text(&channel.name, &channel.unit) {
                let before = (std::mem::replace(&mut channel.name, name), std::mem::replace(&mut channel.unit, unit));
                notes.push(format!(
                    "the channel \"{}\" in \"{}\" is written as \"{}\" in \"{}\", since a heading of text would be read as something else",
                    before.0, before.1, channel.name, channel.unit
                ));
            }
        }
        notes.extend(lost_in_text(recording));
        notes
    }
}

/// A name that is read back from a heading.
fn text_name(name: &str, number: usize) -> String {
    let plain = in_one_line(name);
    match plain.as_str() {
        "" => format!("channel {}", number + 1),
        plain if recording::fits_text(plain, "") => plain.to_owned(),
        plain => format!("{plain}_channel"),
    }
}

fn in_one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Content that text has no place for.
fn lost_in_text(recording: &Recording) -> Option<String> {
    let count = |count: usize, what: &str, one: &str| match count {
        0 => None,
        1 => Some(format!("the {what} of 1 {one}")),
        _ => Some(format!("the {what}s of {count} {one}s")),
    };
    let comments = recording.channels.iter().filter(|c| !c.comment.trim().is_empty()).count();
    let names = recording.rasters.iter().filter(|r| r.name.is_some()).count();
    let lost: Vec<String> = [
        recording.start_time.map(|_| "the start time".to_owned()),
        recording.comment.as_ref().map(|_| "the file's comment".to_owned()),
        count(comments, "comment", "channel"),
        count(names, "name", "raster"),
    ]
    .into_iter()
    .flatten()
    .collect();
    (!lost.is_empty()).then(|| format!("text has no place for {}", lost.join(", ")))
}

/// A recording as a table for data frames; where this build leaves Parquet out, as MDF.
pub fn encode_table(recording: &Recording, files: &Files) -> Result<Vec<u8>, Error> {
    #[cfg(feature = "parquet")]
    {
        let mut bytes = Vec::new();
        parquet(recording, &files.generator(), &mut bytes).map_err(Error::internal)?;
        Ok(bytes)
    }
    #[cfg(not(feature = "parquet"))]
    encode_mdf4(recording, files)
}

/// A recording as MDF, in memory.
pub fn encode_mdf4(recording: &Recording, files: &Files) -> Result<Vec<u8>, Error> {
    let mut bytes = Cursor::new(Vec::new());
    recording::write_mdf4(recording, &files.generator(), &mut bytes).map_err(Error::internal)?;
    Ok(bytes.into_inner())
}

#[cfg(feature = "parquet")]
fn parquet(recording: &Recording, program: &str, out: impl Write + Send) -> Result<(), RecordingError> {
    recording::write_parquet(recording, program, out)
}

#[cfg(feature = "parquet")]
fn arrow(recording: &Recording, out: impl Write) -> Result<(), RecordingError> {
    recording::write_arrow(recording, out)
}

#[cfg(not(feature = "parquet"))]
fn parquet(_: &Recording, _: &str, _: impl Write) -> Result<(), RecordingError> {
    Err(left_out("Parquet"))
}

#[cfg(not(feature = "parquet"))]
fn arrow(_: &Recording, _: impl Write) -> Result<(), RecordingError> {
    Err(left_out("Arrow"))
}

#[cfg(not(feature = "parquet"))]
fn left_out(format: &str) -> RecordingError {
    RecordingError::CannotExpress {
        format: format.into(),
        name: "the recording".into(),
        what: "anything: this build of dynoid lacks the feature `parquet`".into(),
    }
}
