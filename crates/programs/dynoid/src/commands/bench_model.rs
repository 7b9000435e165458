//! Bench models from files: a model.json, the study.json beside one, an FMU of dynoid.

use std::path::Path;

use bench_model::document::{BenchModelDocument, format_of, from_json};
use serde::Deserialize;

use crate::error::CliError;
use crate::input::{read_bytes, read_text};
pub(in crate::commands) use crate::mark::Kind;

/// The bench model beside a study.
pub(in crate::commands) const MODEL: &str = "model.json";
const WANTED: &str = "a model.json as `dynoid study` writes, or an FMU of dynoid";

/// The bench model in a file, or beside a study.
pub(in crate::commands) fn read(path: &Path) -> Result<BenchModelDocument, CliError> {
    let text = text(path, WANTED)?;
    if Kind::of(&text) != Kind::Study {
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

/// The bench model that the text of a file holds.
pub(in crate::commands) fn of_text(path: &Path, text: &str) -> Result<BenchModelDocument, CliError> {
    match Kind::of(text) {
        Kind::Bench => BenchModelDocument::from_json(text).map_err(|source| CliError::BenchModel {
            path: path.to_owned(),
            source: report::BenchModelError::Document { source },
        }),
        Kind::Linear => Err(CliError::IsLinearModel { path: path.to_owned() }),
        Kind::Study => Err(CliError::IsStudy { path: path.to_owned() }),
        Kind::Other => Err(no_model(path, text, WANTED)),
    }
}

/// That a text is none of the files of dynoid, and what it is instead.
pub(in crate::commands) fn no_model(path: &Path, text: &str, wanted: &'static str) -> CliError {
    let reason = match (format_of(text), from_json::<Named>(text)) {
        (Some(format), _) => format!("its `format` is “{format}”"),
        (None, Err(fault)) => fault.to_string(),
        (None, Ok(_)) => "it has no `format`".to_owned(),
    };
    CliError::NoModel { path: path.to_owned(), reason, wanted }
}

/// First entry of every file of dynoid.
#[derive(Deserialize)]
struct Named {
    #[serde(rename = "format")]
    _format: String,
}
