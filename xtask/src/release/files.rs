//! Files of a release, read and written, and what all of them say of the project.

use std::fs;
use std::path::Path;

/// The version of all crates.
pub(super) const VERSION: &str = env!("CARGO_PKG_VERSION");
/// The address of the project.
pub(super) const REPOSITORY: &str = env!("CARGO_PKG_REPOSITORY");

/// The bytes of a file; an error names it.
pub(super) fn read(file: &Path) -> Result<Vec<u8>, String> {
    fs::read(file).map_err(|error| format!("{}: {error}", file.display()))
}

/// Writes a file; an error names it.
pub(super) fn write(file: &Path, bytes: &[u8]) -> Result<(), String> {
    fs::write(file, bytes).map_err(|error| format!("{}: {error}", file.display()))
}
