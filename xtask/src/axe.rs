//! axe-core, which checks pages for accessibility: pinned, and installed once.

use std::path::PathBuf;
use std::process::Command;
use std::{env, fs};

/// Names the script to the tests. Where it is set, that file is taken as it is.
pub(crate) const VARIABLE: &str = "DYNOID_AXE";

const PINNED: &str = "axe-core@4.14.1";

/// The script; `None`, with a word about it, where it cannot be had. The tests count what they skip without it.
pub(crate) fn script() -> Result<Option<PathBuf>, String> {
    if let Some(chosen) = env::var_os(VARIABLE) {
        return std::path::absolute(PathBuf::from(chosen)).map(Some).map_err(|error| error.to_string());
    }
    let folder = crate::folder::target()?.join(PINNED);
    let script = folder.join("node_modules/axe-core/axe.min.js");
    if script.is_file() {
        return Ok(Some(script));
    }
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let npm = if cfg!(windows) { "npm.cmd" } else { "npm" };
    let install = ["install", "--no-save", "--no-audit", "--no-fund", "--ignore-scripts", "--silent", PINNED];
    let status = Command::new(npm).args(install).arg("--prefix").arg(&folder).current_dir(&folder).status();
    match status {
        Ok(status) if status.success() && script.is_file() => Ok(Some(script)),
        _ => {
            eprintln!(
                "!! NOT RUN: the check of pages for accessibility. It needs npm, and once the network; or {VARIABLE}."
            );
            Ok(None)
        }
    }
}
