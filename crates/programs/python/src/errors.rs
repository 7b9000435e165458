//! Exceptions: each error of the library becomes one of `dynoid.errors`, with its fields.

use std::fmt::{Debug, Display};

use ::dataset::DatasetError;
use dynoid::Error;
use ident::IdentError;
use lti::LtiError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use recording::RecordingError;
use serde_json::{Value, json};

use crate::results::to_python;

/// An exception that a function raises.
pub(crate) enum Fault {
    /// An exception of Python's.
    Raised(PyErr),
    /// An exception of `dynoid.errors`.
    Own {
        /// Its class.
        class: &'static str,
        /// The fault, its place, and the remedy.
        message: String,
        /// Fields beside the message, as an object.
        fields: Value,
    },
}

impl Fault {
    fn new(class: &'static str, error: &(impl Debug + Display), fields: Value) -> Self {
        let mut fields = fields;
        fields["kind"] = kind(error).into();
        Fault::Own { class, message: error.to_string(), fields }
    }

    /// An argument that cannot be used.
    pub(crate) fn argument(message: impl Into<String>) -> Self {
        Fault::Own { class: "ArgumentError", message: message.into(), fields: json!({ "kind": "Argument" }) }
    }
}

/// Name of an error's variant, with which its debug form begins.
fn kind(error: &impl Debug) -> String {
    let text = format!("{error:?}");
    text.split(|letter: char| !letter.is_alphanumeric()).next().unwrap_or_default().to_owned()
}

impl From<PyErr> for Fault {
    fn from(raised: PyErr) -> Self {
        Fault::Raised(raised)
    }
}

impl From<IdentError> for Fault {
    fn from(error: IdentError) -> Self {
        match &error {
            IdentError::Structure(inner) => Fault::new("EstimateError", inner, json!({})),
            IdentError::Lti(inner) => Fault::new("EstimateError", inner, json!({})),
            IdentError::Signal(inner) => Fault::new("EstimateError", inner, json!({})),
            IdentError::TooFewSamples { samples, parameters } => {
                Fault::new("EstimateError", &error, json!({ "samples": samples, "parameters": parameters }))
            }
            IdentError::RankDeficient { rank, parameters, condition } => {
                let fields = json!({ "rank": rank, "parameters": parameters, "condition": condition });
                Fault::new("EstimateError", &error, fields)
            }
            IdentError::Length { what, expected, found } => {
                Fault::new("DataError", &error, json!({ "what": what, "expected": expected, "found": found }))
            }
            IdentError::NotFinite { what, index } | IdentError::Missing { what, index } => {
                Fault::new("DataError", &error, json!({ "channel": what, "sample": index }))
            }
            IdentError::MissingInput { channel, index, .. } => {
                Fault::new("DataError", &error, json!({ "channel": channel, "sample": index }))
            }
            IdentError::Constant { what } => Fault::new("DataError", &error, json!({ "channel": what })),
            IdentError::SampleTime { .. } | IdentError::NoOutput => Fault::new("DataError", &error, json!({})),
            _ => Fault::new("EstimateError", &error, json!({})),
        }
    }
}

impl From<LtiError> for Fault {
    fn from(error: LtiError) -> Self {
        IdentError::from(error).into()
    }
}

impl From<DatasetError> for Fault {
    fn from(error: DatasetError) -> Self {
        let fields = match &error {
            DatasetError::NoChannel { file, channel, closest } => {
                json!({ "file": file, "channel": channel, "closest": closest })
            }
            DatasetError::TimeNotRising { file, channel, sample } => {
                json!({ "file": file, "channel": channel, "sample": sample })
            }
            DatasetError::Ambiguous { file, channel, .. } | DatasetError::NothingLeft { file, channel, .. } => {
                json!({ "file": file, "channel": channel })
            }
            _ => json!({}),
        };
        Fault::new("DataError", &error, fields)
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        let error = match error {
            Error::Dataset { source } => return source.into(),
            error => error,
        };
        let path = |path: &std::path::Path| json!({ "file": path.display().to_string() });
        match &error {
            Error::Recording { source, .. } | Error::Encode { source } => {
                let fields = match source {
                    RecordingError::NoSuchChannel { file, .. } => json!({ "file": file }),
                    _ => json!({}),
                };
                Fault::new("RecordingError", source, fields)
            }
            Error::Read { path: of, .. }
            | Error::Write { path: of, .. }
            | Error::IsFolder { path: of, .. }
            | Error::IsStream { path: of }
            | Error::NotText { path: of, .. }
            | Error::InTheWay { path: of, .. }
            | Error::Occupied { path: of, .. }
            | Error::IsRead { path: of }
            | Error::IsReadOnly { path: of }
            | Error::IsDevice { path: of }
            | Error::AmongRecordings { path: of, .. }
            | Error::OutputEnding { path: of, .. }
            | Error::LeftOut { path: of, .. }
            | Error::PageEnding { path: of }
            | Error::Study { path: of, .. }
            | Error::BenchModel { path: of, .. }
            | Error::ModelFile { path: of, .. } => Fault::new("FileError", &error, path(of)),
            Error::BenchFile { path: of, .. }
            | Error::NoChannelsNamed { path: of }
            | Error::NoRecordingsListed { path: of }
            | Error::NothingUsable { bench: of, .. }
            | Error::NothingMatches { bench: of, .. }
            | Error::NotPredicted { path: of, .. }
            | Error::VirtualBench { path: of, .. }
            | Error::Next { path: of, .. } => Fault::new("BenchError", &error, path(of)),
            Error::Identify { .. } | Error::NotEstimated { .. } => Fault::new("EstimateError", &error, json!({})),
            Error::Friction { .. } | Error::TorqueControl { .. } => Fault::new("BenchError", &error, json!({})),
            Error::Catalogue { .. }
            | Error::UnknownTest { .. }
            | Error::NeedsEngineMap { .. }
            | Error::NeedsVehicle { .. }
            | Error::NeedsMap { .. }
            | Error::Requirement { .. }
            | Error::NoRegressions { .. }
            | Error::NothingToJudgeBy { .. }
            | Error::NotDesigned { .. } => Fault::new("ArgumentError", &error, json!({})),
            _ => Fault::new("DynoidError", &error, json!({})),
        }
    }
}

impl From<Fault> for PyErr {
    fn from(fault: Fault) -> Self {
        match fault {
            Fault::Raised(raised) => raised,
            Fault::Own { class, message, fields } => {
                Python::attach(|py| exception(py, class, message, &fields).unwrap_or_else(|error| error))
            }
        }
    }
}

fn exception(py: Python<'_>, class: &str, message: String, fields: &Value) -> PyResult<PyErr> {
    let fields = to_python(py, fields)?.cast_into::<PyDict>()?;
    let class = py.import("dynoid.errors")?.getattr(class)?;
    Ok(PyErr::from_value(class.call((message,), Some(&fields))?))
}
