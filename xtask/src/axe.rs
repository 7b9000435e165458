//! axe-core, which checks pages for accessibility: pinned, and installed once.

use std::env;
use std::path::PathBuf;

use crate::npm;

/// Names the script to the tests. Where it is set, that file is taken as it is.
pub(crate) const VARIABLE: &str = "DYNOID_AXE";

const PINNED: &str = "axe-core@4.14.1";

/// The script; `None`, with a word about it, where it cannot be had. The tests count what they skip without it.
pub(crate) fn script() -> Result<Option<PathBuf>, String> {
    if let Some(chosen) = env::var_os(VARIABLE) {
        return std::path::absolute(PathBuf::from(chosen)).map(Some).map_err(|error| error.to_string());
    }
    let script = npm::file(PINNED, "axe-core/axe.min.js");
    if script.is_none() {
        eprintln!(
            "!! NOT RUN: the check of pages for accessibility. It needs npm, and once the network; or {VARIABLE}."
        );
    }
    Ok(script)
}
