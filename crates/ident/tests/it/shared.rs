//! Reference data measured and published by others; tests that need it are skipped where it is absent.

use std::path::{Path, PathBuf};

/// A file or folder of the reference data, if it is there.
#[allow(clippy::print_stdout, reason = "a skipped test says so")]
pub(crate) fn shared(path: &str) -> Option<PathBuf> {
    let root = std::env::var_os("DYNOID_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"), PathBuf::from);
    let whole = root.join(path);
    if whole.exists() {
        return Some(whole);
    }
    println!("skipped: {} is not there", whole.display());
    None
}
