//! Which file each recording becomes.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::files::Files;
use crate::find::InputFile;
use crate::formats::FileFormat;
use crate::mark::Mark;
use crate::output::{OutputFolder, check_file};
use crate::paths::ending;

/// A recording and the file it becomes.
#[derive(Debug)]
pub(super) struct Target {
    pub(super) input: InputFile,
    pub(super) out: PathBuf,
    pub(super) format: FileFormat,
}

/// The one recording and its file.
pub(super) fn one_file(named: Vec<InputFile>, out: &Path, files: &Files) -> Result<Target, Error> {
    let count = named.len();
    match named.into_iter().next() {
        Some(input) if count == 1 && !out.is_dir() => {
            let target = Target { input, out: out.to_owned(), format: FileFormat::of_output(out)? };
            check_file(&target.out, &Mark::of_run(files), files)?;
            Ok(target)
        }
        _ => Err(Error::SeveralIntoOne { path: out.to_owned() }),
    }
}

/// Where everything goes in a folder, so that nothing is written over that is read or written too.
pub(super) fn in_folder(
    named: Vec<InputFile>,
    out: &Path,
    format: FileFormat,
    files: &Files,
) -> Result<Vec<Target>, Error> {
    if !out.is_dir() && ending(out).is_some_and(|_| FileFormat::of(out).is_some()) {
        return Err(Error::FileForSeveral { path: out.to_owned() });
    }
    OutputFolder::check(out, files)?;
    let target = |input: InputFile| {
        // A name that is not UTF-8 stays as it is.
        let mut name = input.path.file_stem().unwrap_or_default().to_owned();
        name.push(format!(".{}", format.ending()));
        Target { out: out.join(name), input, format }
    };
    let targets: Vec<Target> = named.into_iter().map(target).collect();
    check_apart(&targets)?;
    let mut there = targets.iter().filter(|target| target.out.exists());
    there.try_for_each(|target| check_file(&target.out, &Mark::of_run(files), files))?;
    Ok(targets)
}

/// Refuses two recordings of one target.
fn check_apart(targets: &[Target]) -> Result<(), Error> {
    let mut by_target: HashMap<&Path, &str> = HashMap::new();
    for target in targets {
        if let Some(other) = by_target.insert(&target.out, &target.input.name) {
            return Err(Error::OneTarget {
                one: other.to_owned(),
                other: target.input.name.clone(),
                path: target.out.clone(),
            });
        }
    }
    Ok(())
}
