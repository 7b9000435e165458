//! Resources of tests from outside the project: recordings and reference data, and a Python to compare with.
//!
//! A test that cannot have them does not pass in silence: it is counted as skipped, and `cargo xtask check` prints how
//! many were, and why.
#![allow(clippy::print_stderr, reason = "a test says that it is skipped")]

use std::ffi::OsString;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Names the folder of recordings and reference data. Without it, `shared` beside the repository is taken.
pub const SHARED: &str = "DYNOID_SHARED";

/// Names a Python interpreter that has the packages of `xtask/python.txt`.
pub const PYTHON: &str = "DYNOID_PYTHON";

/// Names a GNU Octave that has the package control.
pub const OCTAVE: &str = "DYNOID_OCTAVE";

/// Names the script of axe-core, which checks pages for accessibility.
pub const AXE: &str = "DYNOID_AXE";

/// Names the file that gets a line for each skipped test.
pub const SKIPPED: &str = "DYNOID_SKIPPED";

/// A file or folder of the shared data; where it is absent, `None`, and the running test counts as skipped.
pub fn shared(path: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../shared");
    let file = std::env::var_os(SHARED).map_or_else(beside, PathBuf::from).join(path);
    if file.exists() {
        return Some(file);
    }
    skip(&format!("no shared {path}"));
    None
}

/// The Python to compare with; where none is named, `None`, and the running test counts as skipped.
pub fn python() -> Option<OsString> {
    let python = std::env::var_os(PYTHON);
    if python.is_none() {
        skip("no Python packages to compare with");
    }
    python
}

/// The Octave to compare with; where none is named, `None`, and the running test counts as skipped.
pub fn octave() -> Option<OsString> {
    let octave = std::env::var_os(OCTAVE);
    if octave.is_none() {
        skip("no Octave to compare with");
    }
    octave
}

/// The script of axe-core; where none is named, `None`, and the running test counts as skipped.
pub fn axe() -> Option<PathBuf> {
    let axe = std::env::var_os(AXE).map(PathBuf::from);
    if axe.is_none() {
        skip("no axe-core to check accessibility with");
    }
    axe
}

/// Counts the running test as skipped, for `reason`. The test returns after it.
pub fn skip(reason: &str) {
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("a test");
    eprintln!("skipped: {test}: {reason}");
    let Some(file) = std::env::var_os(SKIPPED) else { return };
    // One write a line, so that tests at the same time do not mix their lines.
    let line = format!("{reason}\t{test}\n");
    let written =
        OpenOptions::new().create(true).append(true).open(&file).and_then(|mut f| f.write_all(line.as_bytes()));
    if let Err(error) = written {
        eprintln!("{}: {error}", Path::new(&file).display());
    }
}
