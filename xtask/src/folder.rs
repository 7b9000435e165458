//! Where things are.

use std::path::{Path, PathBuf};

/// Where cargo puts what it builds.
pub(crate) fn target() -> Result<PathBuf, String> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target");
    let folder = std::env::var_os("CARGO_TARGET_DIR").map_or(beside, PathBuf::from);
    std::path::absolute(folder).map_err(|error| error.to_string())
}
