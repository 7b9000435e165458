//! Which file each recording becomes.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use dynoid::{FileFormat, Files, InputFile, Mark, OutputFolder, check_file, paths::ending};

use crate::cli::convert::ConvertArguments;
use crate::error::CliError;

/// A recording and the file it becomes.
pub(super) struct Target {
    pub(super) input: InputFile,
    pub(super) out: PathBuf,
    pub(super) format: FileFormat,
}

/// Where everything goes, so that nothing is written over that is read or written too.
pub(super) fn plan(files: Vec<InputFile>, arguments: &ConvertArguments, run: &Files) -> Result<Vec<Target>, CliError> {
    let usage = |what: String| Err(CliError::Usage { what });
    let Some(out) = &arguments.out else {
        return usage("give the file to write with --out, or a folder with --out and a format with --to".into());
    };
    let targets = match arguments.to {
        Some(format) => in_folder(files, out, format.into(), run)?,
        None => vec![alone(files, out)?],
    };
    check_apart(&targets)?;
    for target in targets.iter().filter(|target| arguments.to.is_none() || target.out.exists()) {
        check_file(&target.out, &Mark::of_run(run), run)?;
    }
    Ok(targets)
}

fn alone(files: Vec<InputFile>, out: &Path) -> Result<Target, CliError> {
    let count = files.len();
    match files.into_iter().next() {
        Some(input) if count == 1 && !out.is_dir() => {
            Ok(Target { input, out: out.to_owned(), format: FileFormat::of_output(out)? })
        }
        _ => {
            let what = format!(
                "{}: for a folder of recordings say their format with --to, as in --to mf4 --out FOLDER",
                out.display()
            );
            Err(CliError::Usage { what })
        }
    }
}

fn in_folder(files: Vec<InputFile>, out: &Path, format: FileFormat, run: &Files) -> Result<Vec<Target>, CliError> {
    if !out.is_dir() && ending(out).is_some_and(|_| FileFormat::of(out).is_some()) {
        let what = format!("{}: with --to, --out is a folder; leave --to out to write this file", out.display());
        return Err(CliError::Usage { what });
    }
    OutputFolder::check(out, run)?;
    let target = |input: InputFile| {
        // A name that is not UTF-8 stays as it is.
        let mut name = input.path.file_stem().unwrap_or_default().to_owned();
        name.push(format!(".{}", format.ending()));
        Target { out: out.join(name), input, format }
    };
    Ok(files.into_iter().map(target).collect())
}

/// Refuses two recordings of one target.
fn check_apart(targets: &[Target]) -> Result<(), CliError> {
    let mut by_target: HashMap<&Path, &str> = HashMap::new();
    for target in targets {
        if let Some(other) = by_target.insert(&target.out, &target.input.name) {
            let what = format!(
                "{} and {} would both become {}; convert them into different folders",
                other,
                target.input.name,
                target.out.display()
            );
            return Err(CliError::Usage { what });
        }
    }
    Ok(())
}
