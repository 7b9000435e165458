//! The recordings of a bench as labelled experiments, one after the other.

use std::path::{Path, PathBuf};

use report::wording;
use rig::{BenchFile, Diagnostic, Experiment, Severity};
use study::experiment_of;
use work::Context;

use crate::bench::Bench;
use crate::error::Error;
use crate::files::Files;
use crate::find::{InputFile, listed};

/// A bench with recordings that are read one by one. A [`crate::Session`] holds all of them.
#[derive(Debug, Clone)]
pub struct BenchRecordings {
    path: PathBuf,
    bench: BenchFile,
    files: Vec<InputFile>,
}

/// Reason where no diagnostic says why a recording cannot be used.
pub(crate) const NOTHING_USABLE: &str = "nothing in it can be used";

/// Remark on the worst of the reasons why a recording cannot be used.
pub(crate) fn worst(reasons: &[Diagnostic]) -> Option<String> {
    let worst = reasons.iter().find(|reason| reason.severity == Severity::Error).or(reasons.first());
    worst.map(wording::remark)
}

/// Remarks on recordings that were read.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ReadRemarks {
    /// Recordings that cannot be used, each with the reason.
    pub refused: Vec<String>,
    /// Faults of the others.
    pub doubts: Vec<String>,
}

impl ReadRemarks {
    /// All of them, those on recordings that cannot be used first.
    pub fn all(&self) -> impl Iterator<Item = &str> {
        self.refused.iter().chain(&self.doubts).map(String::as_str)
    }
}

impl BenchRecordings {
    /// The recordings that are `named`, or else those that a bench file lists.
    ///
    /// # Errors
    /// A bench file that cannot be read or names no channels, and recordings that are not there.
    pub fn find(bench: &Path, named: &[PathBuf], files: &Files) -> Result<Self, Error> {
        let path = bench.to_owned();
        let bench = Bench::load(bench, files)?.into_file();
        if bench.channels.is_empty() {
            return Err(Error::NoChannelsNamed { path });
        }
        let files = if named.is_empty() { listed(&path, &bench.recordings.files)? } else { files.named(named)? };
        Ok(BenchRecordings { path, bench, files })
    }

    /// The bench.
    pub fn bench(&self) -> &BenchFile {
        &self.bench
    }

    /// Reads one recording after the other, and hands each on that can be used. The step of the work is called
    /// `doing`, such as `reading`.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn each(
        &self,
        doing: &str,
        files: &Files,
        context: &Context,
        mut work: impl FnMut(Experiment),
    ) -> Result<ReadRemarks, Error> {
        let step = context.step(doing, self.files.len() as u64);
        let mut remarks = ReadRemarks::default();
        for file in &self.files {
            let part = step.step(format!("{doing} {}", file.name), 0);
            match experiment_of(&self.bench, &files.read_source(file, &self.bench, &part)?) {
                Ok((experiment, diagnostics)) => {
                    let worth_knowing = diagnostics.iter().filter(|d| d.severity >= Severity::Warning);
                    remarks.doubts.extend(worth_knowing.map(wording::remark));
                    work(experiment);
                }
                Err(diagnostics) => {
                    let nothing = || format!("{}: {NOTHING_USABLE}", file.name);
                    remarks.refused.push(worst(&diagnostics).unwrap_or_else(nothing));
                }
            }
        }
        Ok(remarks)
    }

    /// Why there is nothing to look at, where no recording can be used.
    pub fn nothing(&self) -> Error {
        Error::NothingToLookAt { path: self.path.clone() }
    }
}
