//! The files of one run: those that it reads, and the leave to write over others.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The files of one run of a program: finds and reads recordings, and writes results whole or not at all.
///
/// It remembers what it reads, so that no result replaces it. Copies share that memory; two runs that were made by
/// [`Files::new`] do not know of each other.
#[derive(Debug, Clone)]
pub struct Files {
    run: Arc<Run>,
}

#[derive(Debug)]
struct Run {
    /// Maker of the results, in words such as `experiment design`.
    maker: String,
    overwrites: bool,
    /// Files that are read, as their canonical paths.
    read: Mutex<BTreeSet<PathBuf>>,
    /// The bench file, and the patterns by which it lists recordings.
    bench: Mutex<Option<Listing>>,
    /// Pipes and devices that were opened before the work, and are written to after it.
    streams: Mutex<BTreeMap<PathBuf, File>>,
}

/// A bench file, and the patterns by which it lists recordings.
#[derive(Debug, Clone)]
pub(crate) struct Listing {
    pub(crate) bench: PathBuf,
    pub(crate) patterns: Vec<String>,
}

impl Files {
    /// The files of a run that has read nothing.
    ///
    /// The results name their `maker`, in words such as `experiment design`, and are replaced by those of the same
    /// maker. A run that `overwrites` replaces other files too, but never one that it reads.
    pub fn new(maker: &str, overwrites: bool) -> Self {
        let letter = |letter: char| if letter.is_ascii_lowercase() { letter } else { '-' };
        let word = |word: &str| word.to_lowercase().chars().map(letter).collect::<String>();
        let maker = maker.split_whitespace().map(word).collect::<Vec<_>>().join(" ");
        let run = Run { maker, overwrites, read: Mutex::default(), bench: Mutex::default(), streams: Mutex::default() };
        Files { run: Arc::new(run) }
    }

    /// The words for who makes the results.
    pub fn maker(&self) -> &str {
        &self.run.maker
    }

    /// Maker of the results as they state it: dynoid, the maker's words and the version.
    pub fn generator(&self) -> String {
        format!("dynoid {} {}", self.maker(), env!("CARGO_PKG_VERSION"))
    }

    /// Tells whether files may be replaced, whoever wrote them.
    pub fn overwrites(&self) -> bool {
        self.run.overwrites
    }

    /// Notes a file that is read, which no result may replace.
    pub fn reads(&self, path: &Path) {
        if let Ok(path) = path.canonicalize() {
            locked(&self.run.read).insert(path);
        }
    }

    /// Tells whether a file is one that is read.
    pub fn is_read(&self, path: &Path) -> bool {
        path.canonicalize().is_ok_and(|path| locked(&self.run.read).contains(&path))
    }

    /// Notes a bench file that is read, and the patterns by which it lists recordings. No result gets a place among
    /// them.
    pub fn is_on(&self, bench: &Path, patterns: &[String]) {
        *locked(&self.run.bench) = Some(Listing { bench: bench.to_owned(), patterns: patterns.to_vec() });
    }

    /// The bench file that was read last.
    pub(crate) fn listing(&self) -> Option<Listing> {
        locked(&self.run.bench).clone()
    }

    /// Pipes and devices that are open.
    pub(crate) fn streams(&self) -> MutexGuard<'_, BTreeMap<PathBuf, File>> {
        locked(&self.run.streams)
    }
}

/// A set that is whole even if a thread failed.
fn locked<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::Files;

    #[test]
    fn exact_a_maker_is_lower_case_words() {
        let files = Files::new("  Fleet Report_2", false);
        assert_eq!(files.maker(), "fleet report--");
        assert!(files.generator().starts_with("dynoid fleet report-- "));
    }
}
