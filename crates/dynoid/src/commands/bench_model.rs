//! Bench models from files.

use std::path::Path;

use bench_model::document::{BenchModelDocument, format_of};

use crate::error::CliError;
use crate::input::read_text;

/// The bench model in a file.
pub(super) fn read(path: &Path) -> Result<BenchModelDocument, CliError> {
    let text = read_text(path, "a model.json as `dynoid study` writes")?;
    if format_of(&text).is_some_and(|format| report::is_study(&format)) {
        return Err(CliError::IsStudy { path: path.to_owned() });
    }
    of_text(path, &text)
}

/// The bench model that the text of a file holds.
pub(super) fn of_text(path: &Path, text: &str) -> Result<BenchModelDocument, CliError> {
    BenchModelDocument::from_json(text).map_err(|source| CliError::BenchModel {
        path: path.to_owned(),
        source: report::BenchModelError::Document { source },
    })
}
