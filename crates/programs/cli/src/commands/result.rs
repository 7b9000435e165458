//! Where results go: one page on the terminal and in the file of a plot, or JSON.

use std::path::{Path, PathBuf};

use dynoid::{Files, pages};
use page::Page;
use serde::ser::Error as _;
use serde::{Serialize, Serializer};

use crate::cli::identify::ResultArguments;
use crate::error::CliError;
use crate::terminal::Terminal;

/// Writes the page where a plot is asked for, and prints the JSON or else the page.
pub(super) fn show<J: Serialize>(
    result: &ResultArguments,
    page: impl FnOnce() -> Page,
    json: impl FnOnce() -> J,
    terminal: &mut Terminal,
) -> Result<(), CliError> {
    show_with(result, &[], page, json, terminal)
}

/// As [`show`], naming the other files that were written.
pub(super) fn show_with<J: Serialize>(
    result: &ResultArguments,
    written: &[&Option<PathBuf>],
    page: impl FnOnce() -> Page,
    json: impl FnOnce() -> J,
    terminal: &mut Terminal,
) -> Result<(), CliError> {
    let is_printed = !result.json && !terminal.is_quiet();
    let page = (is_printed || result.plot.is_some()).then(page);
    if let (Some(path), Some(page)) = (&result.plot, &page) {
        write_page(path, page, terminal)?;
    }
    if result.json {
        return terminal.json(&json());
    }
    if let Some(page) = page.filter(|_| is_printed) {
        terminal.page(&page);
        for path in written.iter().copied().chain([&result.plot]).flatten() {
            terminal.line(&format!("written: {}", path.display()));
        }
    }
    Ok(())
}

/// A result whose keys are printed in the order of the alphabet.
pub(super) struct Sorted<T>(pub(super) T);

impl<T: Serialize> Serialize for Sorted<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serde_json::to_value(&self.0).map_err(S::Error::custom)?.serialize(serializer)
    }
}

/// Writes a page, or its figures, as the file's ending asks for.
pub(super) fn write_page(path: &Path, page: &Page, terminal: &mut Terminal) -> Result<(), CliError> {
    pages::write_page(path, page, &terminal.files())?.iter().for_each(|missing| terminal.warning(missing));
    Ok(())
}

/// Checks before any work that a plot is of a kind that can be drawn, and that it can be written.
pub(super) fn check_plot(arguments: &ResultArguments, files: &Files) -> Result<(), CliError> {
    Ok(arguments.plot.as_deref().map_or(Ok(()), |path| pages::check_page(path, files))?)
}
