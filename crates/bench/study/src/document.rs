//! The study as one JSON document, written and read; and the documents of the analyses beside it.
//!
//! Numbers keep their full precision; one that is NaN or infinite is `null`, which is read as NaN, as infinite degrees
//! of freedom, or as not known. A study that is read and written again gives the same document. It equals the study
//! that was written but for the rounding of what is written in the unit people read, for errors, of which the document
//! has the words, and for the values of traces, which [`Study::take_series`] fills in from their table. The same holds
//! for [`ANALYSES`] and the documents of single analyses; no table holds the traces of these.

use bench_model::document::{JsonFault, ResultFormat, format_of, from_json};
use part_controller::speed_controller::SpeedControl;
use part_engine::EngineTorque;
use part_friction::Friction;
use part_lines::lines::RecordingLines;
use part_shaft::shaft_analysis::ShaftAnalysis;
use part_torque::model_comparison;
use part_torque::torque_signals::TorqueSignals;
use serde::{Deserialize, Serialize};

use crate::{Analyses, ModelComparison, NextExperiments, Study};
use part_controller::noise_test::NoiseTest;

/// Version of the JSON document's shape. It grows by one when a field changes its meaning or disappears.
pub const FORMAT_VERSION: u32 = 3;

/// Text of the `format` field of a study's file.
const FORMAT: &str = "dynoid-study";

/// All analyses beside a study.
pub const ANALYSES: ResultFormat<Analyses> = ResultFormat::new("dynoid-analyses", 1);
/// Experiments to record next.
pub const NEXT_EXPERIMENTS: ResultFormat<NextExperiments> = ResultFormat::new("dynoid-next-experiments", 1);
/// Two bench models, compared.
pub const MODEL_COMPARISON: ResultFormat<ModelComparison> = ResultFormat::new("dynoid-model-comparison", 1);
/// Effect of noise on the estimate of a PI.
pub const NOISE_TEST: ResultFormat<NoiseTest> = ResultFormat::new("dynoid-noise-test", 1);
/// Lines of the spectra, an entry a recording.
pub const LINES: ResultFormat<Vec<RecordingLines>> = ResultFormat::new("dynoid-lines", 1);
/// The torque signals against each other.
pub const TORQUE_SIGNALS: ResultFormat<TorqueSignals> = ResultFormat::new("dynoid-torque-signals", 1);
/// Models of the torque control, compared.
pub const TORQUE_CONTROL: ResultFormat<model_comparison::ModelComparison> =
    ResultFormat::new("dynoid-torque-control", 1);
/// The speed controller.
pub const SPEED_CONTROL: ResultFormat<SpeedControl> = ResultFormat::new("dynoid-speed-control", 1);
/// Friction of the dynamometer.
pub const FRICTION: ResultFormat<Friction> = ResultFormat::new("dynoid-friction", 1);
/// The shaft by band, by route, and beyond K and B.
pub const SHAFT: ResultFormat<ShaftAnalysis> = ResultFormat::new("dynoid-shaft", 1);
/// The engine's torque.
pub const ENGINE_TORQUE: ResultFormat<EngineTorque> = ResultFormat::new("dynoid-engine-torque", 1);

#[derive(Serialize)]
struct Written<'a> {
    format: &'static str,
    format_version: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    series_file: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    series_sha256: Option<&'a str>,
    study: &'a Study,
}

/// A study's document.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Document {
    /// Name of the table that holds the values of [`crate::series`], where there is one.
    pub series_file: Option<String>,
    /// SHA-256 of that table's bytes: another table is of another run.
    pub series_sha256: Option<String>,
    /// The study.
    pub study: Study,
}

/// Statements of a study's document on itself; looked at first, since another version may have another shape.
#[derive(Deserialize)]
struct Header {
    #[serde(default)]
    format_version: u64,
}

/// Why a text is no study.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DocumentError {
    /// The text has another `format`, or none.
    #[error("this is not a study: its `format` is not “{FORMAT}”; `dynoid study bench.toml` writes study.json")]
    NotAStudy,
    /// A study of another version.
    #[error("this study is of version {found}, where {FORMAT_VERSION} is read; run `dynoid study bench.toml` again")]
    OtherVersion {
        /// Its version.
        found: u64,
    },
    /// A study that is damaged.
    #[error("{fault}; copy the study again, or let `dynoid study bench.toml` write it again")]
    Damaged {
        /// Where, and what is wrong.
        fault: JsonFault,
    },
}

/// A table of series beside a study's document.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SeriesFile<'a> {
    /// Its name.
    pub name: &'a str,
    /// SHA-256 of its bytes, in hexadecimal digits.
    pub sha256: &'a str,
}

/// The study as compact JSON:
/// `{"format": "dynoid-study", "format_version": 3, "series_file": …, "series_sha256": …, "study": {…}}`.
///
/// `series` is the table that holds the values of [`crate::series`], where there is one.
///
/// Should serialisation ever fail, the document holds an `error` text in place of `study`, so that a reader of the file
/// sees why.
pub fn json(study: &Study, series: Option<SeriesFile<'_>>) -> String {
    let (series_file, series_sha256) = (series.map(|series| series.name), series.map(|series| series.sha256));
    let document = Written { format: FORMAT, format_version: FORMAT_VERSION, series_file, series_sha256, study };
    serde_json::to_string(&document).unwrap_or_else(|error| {
        let reason = serde_json::Value::String(error.to_string());
        format!(r#"{{"format":"dynoid-study","format_version":{FORMAT_VERSION},"error":{reason}}}"#)
    })
}

/// Tells whether this is the `format` of a study.
#[must_use]
pub fn is_study(format: &str) -> bool {
    format == FORMAT
}

/// Reads what [`json`] wrote.
///
/// # Errors
/// [`DocumentError`] with the place in the text, and what to do.
pub fn read(text: &str) -> Result<Document, DocumentError> {
    let damaged = |fault| DocumentError::Damaged { fault };
    match format_of(text) {
        Some(format) if is_study(&format) => {}
        _ => return Err(DocumentError::NotAStudy),
    }
    let header: Header = from_json(text).map_err(damaged)?;
    if header.format_version != u64::from(FORMAT_VERSION) {
        return Err(DocumentError::OtherVersion { found: header.format_version });
    }
    from_json(text).map_err(damaged)
}
