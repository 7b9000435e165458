//! Where data of others are found, if they are there.
#![allow(clippy::print_stdout)]

use std::path::{Path, PathBuf};

/// A file of the shared folder, which `DYNOID_SHARED` or the place beside the repository gives; `None` with a word about it,
/// where it is absent.
pub(crate) fn shared(path: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let folder = std::env::var_os("DYNOID_SHARED").map_or_else(beside, PathBuf::from);
    let file = folder.join(path);
    if file.exists() {
        return Some(file);
    }
    println!("skipped: {path} is not there");
    None
}
