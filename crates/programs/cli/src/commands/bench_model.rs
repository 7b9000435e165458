//! Bench models from files: a model.json, the study.json beside one, an FMU of dynoid.

use std::path::Path;

use bench_model::document::{BenchModelDocument, format_of, from_json};
use dynoid::Files;
use serde::Deserialize;

use crate::error::CliError;
pub(in crate::commands) use dynoid::Kind;

/// The bench model beside a study.
pub(in crate::commands) const MODEL: &str = "model.json";
const WANTED: &str = "a model.json as `dynoid study` writes, or an FMU of dynoid";

/// The bench model in a file, or beside a study.
pub(in crate::commands) fn read(path: &Path, files: &Files) -> Result<BenchModelDocument, CliError> {
    let text = text(path, WANTED, files)?;
    if Kind::of(&text) != Kind::Study {
        return of_text(path, &text);
    }
    let beside = path.with_file_name(MODEL);
    if !beside.is_file() {
        return Err(CliError::IsStudy { path: path.to_owned() });
    }
    let document = of_text(&beside, &files.read_text(&beside, WANTED)?)?;
    match is_of_study(&document, &text) {
        true => Ok(document),
        false => Err(CliError::OfTwoStudies { study: path.to_owned(), model: beside }),
    }
}

/// Tells whether the model of a study is that of a document. A study that this version cannot read is not compared.
fn is_of_study(document: &BenchModelDocument, study: &str) -> bool {
    const ROUNDING: f64 = 1e-9;
    let model = match study::model(study) {
        Ok(model) => model,
        Err(fault) => return fault != study::BenchModelError::NoModel,
    };
    let of_study = BenchModelDocument::new(model, document.bench.clone(), document.provenance.clone());
    let (ours, others) = (document.parameters(), of_study.parameters());
    let is_same = |one: f64, other: f64| (one - other).abs() <= ROUNDING * one.abs().max(other.abs());
    ours.len() == others.len() && ours.iter().zip(others).all(|(one, other)| is_same(one.value, other.value))
}

/// Tells whether a report is of the study of a model: it states the bench file, and the recordings that the model is
/// from.
pub(in crate::commands) fn is_reported(document: &BenchModelDocument, report: &[u8]) -> bool {
    // As many digits as a report has of each recording.
    const DIGITS: usize = 12;
    let text = String::from_utf8_lossy(report);
    let origin = &document.provenance;
    let recordings =
        origin.recordings.iter().map(|recording| recording.sha256.get(..DIGITS).unwrap_or(&recording.sha256));
    std::iter::once(origin.bench_file.sha256.as_str()).chain(recordings).all(|hash| text.contains(hash))
}

/// The text of a model file, which may be in an FMU. The error for a file that is not text names what is `wanted`.
pub(in crate::commands) fn text(path: &Path, wanted: &'static str, files: &Files) -> Result<String, CliError> {
    let is_fmu = dynoid::paths::ending(path).is_some_and(|ending| ending.eq_ignore_ascii_case("fmu"));
    if !is_fmu {
        return Ok(files.read_text(path, wanted)?);
    }
    let bytes = files.read_bytes(path)?;
    export::fmu::model_in(&bytes).ok_or_else(|| CliError::NoModelInside { path: path.to_owned() })
}

/// The bench model that the text of a file holds.
pub(in crate::commands) fn of_text(path: &Path, text: &str) -> Result<BenchModelDocument, CliError> {
    match Kind::of(text) {
        Kind::Bench => BenchModelDocument::from_json(text).map_err(|source| CliError::BenchModel {
            path: path.to_owned(),
            source: study::BenchModelError::Document { source },
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
