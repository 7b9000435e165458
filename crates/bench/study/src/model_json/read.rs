//! The bench model that a JSON document holds.

use bench_model::document::{BenchModelDocument, DocumentError, JsonFault, Validity, format_of, from_json};
use bench_model::model::AssembledModel;
use serde::Deserialize;

use crate::document::{FORMAT_VERSION, is_study};

/// The earliest version whose model is read; it had the series in the document.
const EARLIEST: u32 = 2;

/// Why a text holds no bench model.
#[derive(Debug, Clone, PartialEq)]
pub enum BenchModelError {
    /// The text is neither a bench model nor a study.
    NotAModel {
        /// Reason, in words.
        reason: String,
    },
    /// A study that cannot be read.
    Study {
        /// Where, and what is wrong.
        fault: JsonFault,
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
            BenchModelError::Study { fault } => {
                write!(f, "{fault}; copy the study again, or let `dynoid study bench.toml` write it again")
            }
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

/// Statements of a study on itself; looked at before anything else, since another version may have another shape.
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
    #[serde(default)]
    validity: Validity,
}

/// The bench model that a text holds: a model.json, or the study.json that [`crate::document::json`] wrote.
///
/// # Errors
/// [`BenchModelError`] with what to do.
pub fn model(text: &str) -> Result<AssembledModel, BenchModelError> {
    model_with_validity(text).map(|(model, _)| model)
}

/// The same with the range of the recordings that the model is from; empty where the text does not state it.
///
/// # Errors
/// As [`model`].
pub fn model_with_validity(text: &str) -> Result<(AssembledModel, Validity), BenchModelError> {
    let format = format_of(text);
    let is_of = |of: fn(&str) -> bool| format.as_deref().is_some_and(of);
    if is_of(BenchModelDocument::is_format) {
        let document = BenchModelDocument::from_json(text).map_err(|source| BenchModelError::Document { source })?;
        let validity = document.validity;
        return Ok((document.assembled(), validity));
    }
    let unread = |fault: JsonFault| match is_of(is_study) {
        true => BenchModelError::Study { fault },
        false => BenchModelError::NotAModel { reason: fault.to_string() },
    };
    let header: Header = from_json(text).map_err(unread)?;
    if !is_study(&header.format) {
        return Err(BenchModelError::NotAModel { reason: format!("its `format` is “{}”", header.format) });
    }
    if !(u64::from(EARLIEST)..=u64::from(FORMAT_VERSION)).contains(&header.format_version) {
        return Err(BenchModelError::OtherVersion { found: header.format_version });
    }
    let document: WithModel = from_json(text).map_err(unread)?;
    let ModelAlone { model, validity } = document.study;
    model.map(|model| (model, validity)).ok_or(BenchModelError::NoModel)
}
