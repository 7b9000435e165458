//! The Python packages that the tests compare with: pinned, and installed once, in a virtual environment.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// Names the interpreter to the tests. Where it is set, that interpreter is taken as it is.
pub(crate) const VARIABLE: &str = "DYNOID_PYTHON";

const PINNED: &str = include_str!("../python.txt");

/// The interpreter to compare with; `None`, with a loud word about it, where there is none and no need of it.
pub(crate) fn interpreter() -> Result<Option<PathBuf>, String> {
    if let Some(chosen) = env::var_os(VARIABLE) {
        return located(chosen.into()).map(Some);
    }
    match environment() {
        Ok(python) => Ok(Some(python)),
        // On a machine of continuous integration a comparison that is left out would go unseen.
        Err(error) if env::var_os("CI").is_some() => Err(error),
        Err(error) => {
            eprintln!("{error}");
            warn();
            Ok(None)
        }
    }
}

/// A path from anywhere, since tests are started in the folders of their crates; a mere name is left to be searched
/// for.
fn located(chosen: PathBuf) -> Result<PathBuf, String> {
    match chosen.components().count() {
        0 | 1 => Ok(chosen),
        _ => std::path::absolute(chosen).map_err(|error| error.to_string()),
    }
}

/// Says that the comparisons are not run.
pub(crate) fn warn() {
    eprintln!(
        "!! NOT RUN: the comparisons with asammdf, scipy, pandas, pyarrow and h5py, and the tests of the module dynoid. They need python3 (3.11 or later)\n\
         !! with venv, and once the network; or {VARIABLE}, the name of an interpreter that has these packages."
    );
}

fn environment() -> Result<PathBuf, String> {
    let folder = crate::folder::target()?.join("python");
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let stamp = folder.join("installed.txt");
    if fs::read_to_string(&stamp).is_ok_and(|installed| installed == PINNED) {
        return Ok(python);
    }
    let pinned = Path::new(env!("CARGO_MANIFEST_DIR")).join("python.txt");
    run(OsStr::new("python3"), &["-m", "venv", "--clear"], &folder)?;
    // Without further dependencies: all of them are pinned.
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--requirement"];
    run(python.as_os_str(), &install, &pinned)?;
    fs::write(&stamp, PINNED).map_err(|e| format!("{}: {e}", stamp.display()))?;
    Ok(python)
}

fn run(python: &OsStr, arguments: &[&str], last: &Path) -> Result<(), String> {
    let what = format!("{} {} {}", python.display(), arguments.join(" "), last.display());
    let status = Command::new(python).args(arguments).arg(last).status();
    let status = status.map_err(|error| format!("{what}: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("{what} failed")) }
}
