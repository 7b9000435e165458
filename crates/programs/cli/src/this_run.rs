//! This run of the program: its command, the files that it reads, and the leave to write over others.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// A run of the program.
#[derive(Debug, Default)]
struct Run {
    /// The words of the command, such as `experiment design`.
    command: String,
    overwrites: bool,
    /// Files that are read, as their canonical paths.
    read: Mutex<BTreeSet<PathBuf>>,
    /// The bench file, and the patterns by which it lists recordings.
    bench: Mutex<Option<Listing>>,
}

/// A bench file, and the patterns by which it lists recordings.
#[derive(Debug, Clone)]
pub(crate) struct Listing {
    pub(crate) bench: PathBuf,
    pub(crate) patterns: Vec<String>,
}

static RUN: OnceLock<Run> = OnceLock::new();

/// Notes what the command line asks for, once, before the command begins.
pub(crate) fn begin(command: String, overwrites: bool, inputs: &[PathBuf]) {
    RUN.get_or_init(|| Run { command, overwrites, ..Run::default() });
    inputs.iter().for_each(|path| reads(path));
}

fn run() -> &'static Run {
    RUN.get_or_init(Run::default)
}

/// The words of the command.
pub(crate) fn command() -> &'static str {
    &run().command
}

/// Maker of the results: program, command and version.
pub(crate) fn generator() -> String {
    format!("dynoid {} {}", command(), env!("CARGO_PKG_VERSION"))
}

/// Tells whether the user allows to replace files, whoever wrote them.
pub(crate) fn overwrites() -> bool {
    run().overwrites
}

/// Notes a file that is read.
pub(crate) fn reads(path: &Path) {
    if let Ok(path) = path.canonicalize() {
        locked(&run().read).insert(path);
    }
}

/// Tells whether a file is one that is read.
pub(crate) fn is_read(path: &Path) -> bool {
    path.canonicalize().is_ok_and(|path| locked(&run().read).contains(&path))
}

/// Notes a bench file that is read.
pub(crate) fn is_on(bench: &Path, patterns: &[String]) {
    *locked(&run().bench) = Some(Listing { bench: bench.to_owned(), patterns: patterns.to_vec() });
}

/// The bench file that was read last.
pub(crate) fn listing() -> Option<Listing> {
    locked(&run().bench).clone()
}

/// A set that is whole even if a thread failed.
fn locked<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}
