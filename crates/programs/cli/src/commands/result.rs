//! Where results go: one page on the terminal and in the file of a plot, or JSON.

use std::path::{Path, PathBuf};

use dynoid::{Files, Mark, Staging, check_file, date, paths};
use page::{Day, Page, PdfOptions};
use serde::Serialize;

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

/// Writes a page, or its figures, as the file's ending asks for.
pub(super) fn write_page(path: &Path, page: &Page, terminal: &mut Terminal) -> Result<(), CliError> {
    let mut staging = Staging::of(&terminal.files());
    stage_page(path, page, &mut staging, terminal)?;
    Ok(staging.finish()?)
}

/// Writes a page as [`write_page`] does, to get its name together with other files.
pub(super) fn stage_page(
    path: &Path,
    page: &Page,
    staging: &mut Staging,
    terminal: &mut Terminal,
) -> Result<(), CliError> {
    staging.add_content(path, &draw(path, page, &terminal.files())?)?;
    match kind(path)? {
        Kind::Pdf | Kind::Png => warn_without_glyph(&path.display().to_string(), page, terminal),
        Kind::Page | Kind::Svg => Ok(()),
    }
}

/// Names the characters of a page that a file with fonts of its own cannot show.
pub(super) fn warn_without_glyph(file: &str, page: &Page, terminal: &mut Terminal) -> Result<(), CliError> {
    let missing = page::without_glyph(page).map_err(CliError::internal)?;
    if !missing.is_empty() {
        terminal.warning(&format!(
            "{file}: its fonts lack the characters {missing}; it shows \u{fffd} instead. An HTML page shows them."
        ));
    }
    Ok(())
}

/// Checks before any work that a plot is of a kind that can be drawn, and that it can be written.
pub(super) fn check_plot(arguments: &ResultArguments, files: &Files) -> Result<(), CliError> {
    let Some(path) = &arguments.plot else { return Ok(()) };
    check_file(path, &Mark::of_run(files), files)?;
    kind(path).map(|_| ())
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Page,
    Pdf,
    Svg,
    Png,
}

fn kind(path: &Path) -> Result<Kind, CliError> {
    match paths::ending(path).map(str::to_lowercase).as_deref() {
        Some("html" | "htm") => Ok(Kind::Page),
        Some("pdf") => Ok(Kind::Pdf),
        Some("svg") => Ok(Kind::Svg),
        Some("png") => Ok(Kind::Png),
        _ => Err(CliError::PlotEnding { path: path.to_owned() }),
    }
}

/// A page, or the figures of one, as a file's ending asks for.
fn draw(path: &Path, page: &Page, files: &Files) -> Result<Vec<u8>, CliError> {
    match kind(path)? {
        Kind::Page => Ok(html(page, files).into_bytes()),
        Kind::Pdf => pdf(page, PdfOptions::default(), files),
        Kind::Svg => Ok(dynoid::in_svg(&page::svg(page.figures()), files).into_bytes()),
        Kind::Png => page::png(page.figures()).map(|png| dynoid::in_png(&png, files)).map_err(CliError::internal),
    }
}

/// A page for a browser.
pub(super) fn html(page: &Page, files: &Files) -> String {
    page::html(page, &files.generator())
}

/// A page on paper, made today by this program.
pub(super) fn pdf(page: &Page, options: PdfOptions, files: &Files) -> Result<Vec<u8>, CliError> {
    let options = PdfOptions { generator: files.generator(), created: Day::parse(&date::today()), ..options };
    page::pdf(page, &options).map_err(CliError::internal)
}
