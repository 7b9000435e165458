//! Where reference data lie that are no part of the project.
#![allow(clippy::print_stdout)]

use std::path::PathBuf;

/// A file or folder of the reference data; `None`, with a word about it, where there are none.
pub(crate) fn shared(path: &str) -> Option<PathBuf> {
    let root = std::env::var_os("DYNOID_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared"), PathBuf::from);
    let found = root.join("reference").join(path);
    if found.exists() {
        return Some(found);
    }
    println!("skipped: {} is absent", found.display());
    None
}
