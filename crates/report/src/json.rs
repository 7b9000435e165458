//! The study as one JSON document.

use bench_model::document::{BenchModelDocument, DocumentError};
use bench_model::model::AssembledModel;
use serde::{Deserialize, Serialize};
use study::Study;

/// Version of the JSON document's shape. It grows by one when a field changes its meaning or disappears.
pub const FORMAT_VERSION: u32 = 3;

/// The earliest version whose model is read; it had the series in the document.
const EARLIEST: u32 = 2;

/// What a file of another kind calls itself.
const FORMAT: &str = "dynoid-study";

#[derive(Serialize)]
struct Document<'a> {
    format: &'static str,
    format_version: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    series_file: Option<&'a str>,
    study: &'a Study,
}

/// The study as compact JSON: `{"format": "dynoid-study", "format_version": 3, "series_file": …, "study": {…}}`.
///
/// `series_file` is the name of the table that holds the values of [`study::series`], where there is one.
///
/// Numbers keep their full precision; one that is NaN or infinite is `null`. Should serialisation ever fail, the
/// document holds an `error` text in place of `study`, so that a reader of the file sees why.
pub fn json(study: &Study, series_file: Option<&str>) -> String {
    let document = Document { format: FORMAT, format_version: FORMAT_VERSION, series_file, study };
    serde_json::to_string(&document).unwrap_or_else(|error| {
        let reason = serde_json::Value::String(error.to_string());
        format!(r#"{{"format":"dynoid-study","format_version":{FORMAT_VERSION},"error":{reason}}}"#)
    })
}

/// Why a text holds no bench model.
#[derive(Debug, Clone, PartialEq)]
pub enum BenchModelError {
    /// The text is neither a bench model nor a study.
    NotAModel {
        /// The reader's words.
        reason: String,
    },
    /// A bench model that cannot be used.
    Document {
        /// Why.
        source: DocumentError,
    },
    /// A study of another version.
    OtherVersion {
        /// Its version.
        found: u64,
    },
    /// A study that keeps no model: it could not be assembled, or the study is older than that.
    NoModel,
}

impl std::fmt::Display for BenchModelError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            BenchModelError::NotAModel { reason } => write!(
                f,
                "this is neither a bench model nor a study ({reason}); `dynoid study bench.toml` writes both, model.json and study.json"
            ),
            BenchModelError::Document { source } => source.fmt(f),
            BenchModelError::OtherVersion { found } => write!(
                f,
                "this study is of version {found}, where {EARLIEST} to {FORMAT_VERSION} are read; run `dynoid study bench.toml` again"
            ),
            BenchModelError::NoModel => f.write_str(
                "this study holds no bench model: its recordings did not give one, or an earlier dynoid wrote it; run \
                 `dynoid study bench.toml` again and see what it says of the shaft",
            ),
        }
    }
}

impl std::error::Error for BenchModelError {}

/// What a study says of itself; looked at before anything else, since another version may have another shape.
#[derive(Deserialize)]
struct Header {
    format: String,
    #[serde(default)]
    format_version: u64,
}

#[derive(Deserialize)]
struct WithModel {
    study: ModelAlone,
}

#[derive(Deserialize)]
struct ModelAlone {
    model: Option<AssembledModel>,
}

/// Whether this is the `format` of a study.
#[must_use]
pub fn is_study(format: &str) -> bool {
    format == FORMAT
}

/// The bench model that a text holds: a model.json, or the study.json that [`json`] wrote.
///
/// # Errors
/// [`BenchModelError`] with what to do.
pub fn model(text: &str) -> Result<AssembledModel, BenchModelError> {
    let not_a_model = |reason: String| BenchModelError::NotAModel { reason };
    let header: Header = serde_json::from_str(text).map_err(|error| not_a_model(error.to_string()))?;
    if BenchModelDocument::is_format(&header.format) {
        let document = BenchModelDocument::from_json(text).map_err(|source| BenchModelError::Document { source })?;
        return Ok(document.assembled());
    }
    if header.format != FORMAT {
        return Err(not_a_model(format!("it calls itself “{}”", header.format)));
    }
    if !(u64::from(EARLIEST)..=u64::from(FORMAT_VERSION)).contains(&header.format_version) {
        return Err(BenchModelError::OtherVersion { found: header.format_version });
    }
    let document: WithModel = serde_json::from_str(text).map_err(|error| not_a_model(error.to_string()))?;
    document.study.model.ok_or(BenchModelError::NoModel)
}
