//! Pages as files: for a browser, on paper, or their figures alone.

use std::path::Path;

use page::{Day, Page, PdfOptions};

use crate::error::Error;
use crate::files::Files;
use crate::mark::{Mark, in_png, in_svg};
use crate::output::{Staging, check_file};
use crate::{date, features, paths};

/// Writes a page, or its figures, as the file's ending asks for: .html, .pdf, .svg or .png. Returns in words which
/// characters the file does not show.
///
/// # Errors
/// Another ending, a file that must stay, or one that cannot be written.
pub fn write_page(path: &Path, page: &Page, files: &Files) -> Result<Option<String>, Error> {
    let mut staging = Staging::of(files);
    let missing = stage_page(path, page, &mut staging)?;
    staging.finish()?;
    Ok(missing)
}

/// Writes a page as [`write_page`] does, to get its name together with other files.
///
/// # Errors
/// Those of [`write_page`].
pub fn stage_page(path: &Path, page: &Page, staging: &mut Staging) -> Result<Option<String>, Error> {
    let content = draw(path, page, staging.files())?;
    staging.add_content(path, &content)?;
    match kind(path)? {
        Kind::Pdf | Kind::Png => without_glyph(&path.display().to_string(), page),
        Kind::Page | Kind::Svg => Ok(None),
    }
}

/// Checks before any work that a page can be written there, and is of a kind that can be drawn.
///
/// # Errors
/// A file that must stay, another ending, and a format that this build leaves out.
pub fn check_page(path: &Path, files: &Files) -> Result<(), Error> {
    check_file(path, &Mark::of_run(files), files)?;
    match kind(path)? {
        Kind::Pdf => features::PDF.check(path, "PDF"),
        Kind::Png => features::PDF.check(path, "PNG"),
        Kind::Page | Kind::Svg => Ok(()),
    }
}

/// The characters of a page that a file with fonts of its own cannot show, in words.
pub(crate) fn without_glyph(file: &str, page: &Page) -> Result<Option<String>, Error> {
    let missing = page::without_glyph(page).map_err(Error::internal)?;
    Ok((!missing.is_empty()).then(|| {
        format!("{file}: its fonts lack the characters {missing}; it shows \u{fffd} instead. An HTML page shows them.")
    }))
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Page,
    Pdf,
    Svg,
    Png,
}

fn kind(path: &Path) -> Result<Kind, Error> {
    match paths::ending(path).map(str::to_lowercase).as_deref() {
        Some("html" | "htm") => Ok(Kind::Page),
        Some("pdf") => Ok(Kind::Pdf),
        Some("svg") => Ok(Kind::Svg),
        Some("png") => Ok(Kind::Png),
        _ => Err(Error::PageEnding { path: path.to_owned() }),
    }
}

/// A page, or the figures of one, as a file's ending asks for.
fn draw(path: &Path, page: &Page, files: &Files) -> Result<Vec<u8>, Error> {
    match kind(path)? {
        Kind::Page => Ok(html(page, files).into_bytes()),
        Kind::Pdf => pdf(page, PdfOptions::default(), files),
        Kind::Svg => Ok(in_svg(&page::svg(page.figures()), files).into_bytes()),
        Kind::Png => page::png(page.figures()).map(|png| in_png(&png, files)).map_err(Error::internal),
    }
}

/// A page for a browser.
pub fn html(page: &Page, files: &Files) -> String {
    page::html(page, &files.generator())
}

/// A page on paper, made today by this program.
///
/// # Errors
/// A fault of dynoid.
pub fn pdf(page: &Page, options: PdfOptions, files: &Files) -> Result<Vec<u8>, Error> {
    let options = PdfOptions { generator: files.generator(), created: Day::parse(&date::today()), ..options };
    page::pdf(page, &options).map_err(Error::internal)
}
