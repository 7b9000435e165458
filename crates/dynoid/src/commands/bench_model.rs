//! Bench models from files: a model.json, the study.json beside one, an FMU of dynoid.

use std::path::Path;

use bench_model::document::{BenchModelDocument, format_of};

use crate::error::CliError;
use crate::input::{read_bytes, read_text};

/// The bench model beside a study.
pub(in crate::commands) const MODEL: &str = "model.json";
const WANTED: &str = "a model.json as `dynoid study` writes, or an FMU of dynoid";

/// The bench model in a file.
pub(super) fn read(path: &Path) -> Result<BenchModelDocument, CliError> {
    let text = text(path, WANTED)?;
    if !is_study(&text) {
        return of_text(path, &text);
    }
    let beside = path.with_file_name(MODEL);
    match beside.is_file() {
        true => of_text(&beside, &read_text(&beside, WANTED)?),
        false => Err(CliError::IsStudy { path: path.to_owned() }),
    }
}

/// The text of a model file, which may be in an FMU. The error for a file that is not text names what is `wanted`.
pub(in crate::commands) fn text(path: &Path, wanted: &'static str) -> Result<String, CliError> {
    let is_fmu = crate::paths::ending(path).is_some_and(|ending| ending.eq_ignore_ascii_case("fmu"));
    if !is_fmu {
        return read_text(path, wanted);
    }
    let bytes = read_bytes(path)?;
    export::fmu::model_in(&bytes).ok_or_else(|| CliError::NoModelInside { path: path.to_owned() })
}

/// Whether the text is that of a study.
pub(super) fn is_study(text: &str) -> bool {
    format_of(text).is_some_and(|format| report::is_study(&format))
}

/// The bench model that the text of a file holds.
pub(in crate::commands) fn of_text(path: &Path, text: &str) -> Result<BenchModelDocument, CliError> {
    BenchModelDocument::from_json(text).map_err(|source| CliError::BenchModel {
        path: path.to_owned(),
        source: report::BenchModelError::Document { source },
    })
}
