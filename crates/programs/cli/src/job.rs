//! The process of a job of the app: a command that outlives the page that started it.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use crate::error;

/// The folder of a job, where the arguments are those that the app gives to its process.
pub(crate) fn folder(arguments: &[OsString]) -> Option<PathBuf> {
    match arguments {
        [_, command, option, folder] if command == "app" && option == "--job" => Some(folder.into()),
        _ => None,
    }
}

/// Runs the command of a job by `main`, and returns its exit code.
pub(crate) fn run(folder: &Path, main: fn(Vec<OsString>) -> u8) -> u8 {
    dynoid_app::run_job(folder, main).unwrap_or(error::INTERNAL)
}
