//! Finding recordings: by the patterns of a bench file, by name, and in folders.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

use crate::error::Error;
use crate::files::{Files, Listing};
use crate::mark::Mark;
use crate::paths;
use crate::patterns::{self, PatternFault};

/// Endings of files that are taken for recordings in a folder.
const ENDINGS: [&str; 11] = ["mf4", "mdf", "dat", "csv", "tsv", "mat", "h5", "hdf5", "parquet", "arrow", "feather"];

/// A recording that was found.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct InputFile {
    /// Where it is.
    pub path: PathBuf,
    /// Name that the user gives it.
    pub name: String,
}

/// The recordings a bench file lists, each once, in the order of its patterns; names are relative to the bench file.
pub fn listed(bench: &Path, patterns: &[String]) -> Result<Vec<InputFile>, Error> {
    if patterns.is_empty() {
        return Err(Error::NoRecordingsListed { path: bench.to_owned() });
    }
    let folder = paths::folder_of(bench);
    let mut seen = BTreeSet::new();
    let mut files = Vec::new();
    for pattern in patterns {
        let found = matches(bench, &folder, pattern)?;
        if found.is_empty() {
            let folder = folder.join(fixed_part(pattern));
            return Err(Error::NothingMatches { bench: bench.to_owned(), pattern: pattern.clone(), folder });
        }
        for path in found {
            if seen.insert(path.canonicalize().unwrap_or_else(|_| path.clone())) {
                let name = paths::name_in(&path, &folder);
                files.push(InputFile { path, name });
            }
        }
    }
    Ok(files)
}

impl Files {
    /// The recordings that a user names: files as they are, folders for the recordings in them.
    pub fn named(&self, arguments: &[PathBuf]) -> Result<Vec<InputFile>, Error> {
        let mut files = Vec::new();
        for argument in arguments {
            let found = match std::fs::metadata(argument) {
                Ok(kind) if kind.is_dir() => recordings_in(argument)?,
                Ok(_) => vec![argument.clone()],
                Err(source) => return Err(Error::read(argument, source)),
            };
            found.iter().for_each(|path| self.reads(path));
            files.extend(found.into_iter().map(|path| InputFile { name: paths::with_slashes(&path), path }));
        }
        Ok(files)
    }

    /// The bench file of this run, if it would list a file of this name, or lists one that leads to the same.
    pub(crate) fn bench_that_lists(&self, file: &Path) -> Option<PathBuf> {
        let Listing { bench, patterns } = self.listing()?;
        let folder = std::path::absolute(paths::folder_of(&bench)).ok()?;
        let real = file.canonicalize().ok();
        let file = std::path::absolute(file).ok()?;
        let is_listed = |real: &PathBuf| {
            let files = listed(&bench, &patterns).unwrap_or_default();
            files.iter().any(|listed| listed.path.canonicalize().is_ok_and(|path| path == *real))
        };
        let lists = |pattern: &String| {
            let place = folder.join(pattern);
            place == file
                || file.parent() == Some(&place)
                || glob::Pattern::new(&full_pattern(&folder, pattern))
                    .is_ok_and(|full| full.matches(&file.to_string_lossy()))
        };
        (patterns.iter().any(lists) || real.as_ref().is_some_and(is_listed)).then_some(bench)
    }

    /// As [`Files::bench_that_lists`], if it lists a measured recording already: one that no other command of this
    /// program made.
    pub(crate) fn bench_with_measured(&self, file: &Path) -> Option<PathBuf> {
        let bench = self.bench_that_lists(file)?;
        let is_measured = |mark: Option<Mark>| mark.is_none_or(|mark| mark == Mark::Command("convert".to_owned()));
        let files = listed(&bench, &self.listing()?.patterns).ok()?;
        files.iter().any(|input| is_measured(Mark::of_file(&input.path))).then_some(bench)
    }
}

/// The files a pattern of a bench file stands for: a file of exactly this name, the recordings of a folder, or else
/// what the pattern matches.
fn matches(bench: &Path, folder: &Path, pattern: &str) -> Result<Vec<PathBuf>, Error> {
    let literal = folder.join(pattern);
    if literal.is_file() {
        return Ok(vec![literal]);
    }
    if literal.is_dir() {
        return recordings_in(&literal);
    }
    patterns::files(folder, pattern).map_err(|fault| match fault {
        PatternFault::Pattern(error) => {
            Error::BadPattern { bench: bench.to_owned(), pattern: pattern.to_owned(), reason: error.msg }
        }
        PatternFault::Unreadable { path, source } => Error::Read { path, source },
    })
}

/// A pattern of a bench file in this folder, with its folders.
fn full_pattern(folder: &Path, pattern: &str) -> String {
    match Path::new(pattern).is_absolute() {
        true => pattern.to_owned(),
        false => format!("{}/{pattern}", glob::Pattern::escape(&folder.to_string_lossy())),
    }
}

/// The folders of a pattern that hold no wildcard.
fn fixed_part(pattern: &str) -> PathBuf {
    let is_fixed = |part: &Component<'_>| !part.as_os_str().to_string_lossy().contains(['*', '?', '[']);
    let mut parts: Vec<Component<'_>> = Path::new(pattern).components().collect();
    parts.pop();
    parts.iter().take_while(|part| is_fixed(part)).collect()
}

/// Tells whether a file has an ending of recordings.
pub fn is_recording(path: &Path) -> bool {
    paths::ending(path).is_some_and(|ending| ENDINGS.contains(&ending.to_lowercase().as_str()))
}

/// The recordings in a folder, by their endings, in order; an error if there is none.
pub fn recordings_in(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let unreadable = |source| Error::read(folder, source);
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if is_recording(&path) && path.is_file() {
            files.push(path);
        }
    }
    if files.is_empty() {
        let endings = ENDINGS.map(|ending| format!("*.{ending}")).join(", ");
        return Err(Error::EmptyFolder { path: folder.to_owned(), endings });
    }
    files.sort();
    Ok(files)
}
