//! Where data of others are found, if they are there.

use std::path::{Path, PathBuf};

/// A file of the shared folder, which `DYNOID_SHARED` or the place beside the repository gives; `None` where it is absent.
pub(crate) fn shared(path: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let folder = std::env::var_os("DYNOID_SHARED").map_or_else(beside, PathBuf::from);
    let file = folder.join(path);
    file.exists().then_some(file)
}
