//! Packages of npm that the check takes: pinned, and installed once.

use std::path::PathBuf;
use std::process::Command;

/// A file of a package, such as `axe-core@4.14.1`; none where npm is not there, or has no network.
pub(crate) fn file(package: &str, path: &str) -> Option<PathBuf> {
    let folder = crate::folder::target().ok()?.join(package);
    let file = folder.join("node_modules").join(path);
    if file.is_file() {
        return Some(file);
    }
    std::fs::create_dir_all(&folder).ok()?;
    let npm = if cfg!(windows) { "npm.cmd" } else { "npm" };
    let install = ["install", "--no-save", "--no-audit", "--no-fund", "--ignore-scripts", "--silent", package];
    let status = Command::new(npm).args(install).arg("--prefix").arg(&folder).current_dir(&folder).status();
    (status.is_ok_and(|status| status.success()) && file.is_file()).then_some(file)
}
