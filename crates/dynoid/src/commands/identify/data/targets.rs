//! Where results go.

use std::path::{Path, PathBuf};

use crate::cli::identify::ResultArguments;
use crate::error::CliError;
use crate::input;
use crate::output::check_file;

/// Checks before any work that results can be written to these places, and refuses to write over a file that is read.
pub(in crate::commands) fn check_targets(targets: &[&Option<PathBuf>], read: &[&[PathBuf]]) -> Result<(), CliError> {
    let same = |a: &Path, b: &Path| matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b);
    for target in targets.iter().filter_map(|target| target.as_ref()) {
        if read.iter().flat_map(|list| list.iter()).any(|file| same(file, target)) {
            let what = format!("{}: this file is read; give the result another name", target.display());
            return Err(CliError::Usage { what });
        }
        check_file(target)?;
    }
    Ok(())
}

/// Checks before any work that a plot is of a kind that can be drawn, and that it can be written.
pub(in crate::commands) fn check_plot(arguments: &ResultArguments, read: &[&[PathBuf]]) -> Result<(), CliError> {
    check_targets(&[&arguments.plot], read)?;
    arguments.plot.as_ref().map_or(Ok(()), |path| kind(path).map(|_| ()))
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Page,
    Svg,
    Png,
}

fn kind(path: &Path) -> Result<Kind, CliError> {
    match input::ending(path).map(str::to_lowercase).as_deref() {
        Some("html" | "htm") => Ok(Kind::Page),
        Some("svg") => Ok(Kind::Svg),
        Some("png") => Ok(Kind::Png),
        _ => Err(CliError::PlotEnding { path: path.to_owned() }),
    }
}

/// A page, or the figures of one, as a file's ending asks for.
pub(in crate::commands::identify) fn draw(path: &Path, page: &page::Page) -> Result<Vec<u8>, CliError> {
    match kind(path)? {
        Kind::Page => Ok(page::html(page, crate::PROGRAM).into_bytes()),
        Kind::Svg => Ok(page::svg(page.figures()).into_bytes()),
        Kind::Png => page::png(page.figures()).map_err(CliError::internal),
    }
}
