//! Models from files: a model.json of a bench, the study.json beside one, a model of any channels, an FMU of dynoid.

use std::path::Path;

use bench_model::document::{BenchModelDocument, format_of, from_json};
use ident::{DocumentHeader, Label, ModelDocument};
use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::files::Files;
use crate::mark::{Kind, Mark};
use crate::output::check_file;
use crate::paths;

/// The file of the bench model beside a study.
pub const MODEL: &str = "model.json";
const BENCH: &str = "a model.json as `dynoid study` writes, or an FMU of dynoid";
const LINEAR: &str = "a model file as `dynoid fit … --out model.json` writes";
const ANY: &str = "a model file as `dynoid fit` or `dynoid study` writes, or an FMU of dynoid";

/// A model of either kind.
#[derive(Debug, Clone)]
pub enum Model {
    /// A model of a bench.
    Bench(Box<BenchModelDocument>),
    /// A linear model of any channels.
    Linear(Box<ModelDocument>),
}

/// A model of a file in short.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ModelFacts {
    /// A model of a bench.
    Bench {
        /// Name of the bench.
        bench: String,
        /// Day of its study.
        date: String,
    },
    /// A linear model of any channels.
    Linear {
        /// Names of its inputs.
        inputs: Vec<String>,
        /// Names of its outputs.
        outputs: Vec<String>,
        /// Method and orders of its estimate; none of a model that was written down.
        method: Option<String>,
        /// Recordings that it was estimated from.
        recordings: Vec<String>,
        /// Its sample time, s.
        sample_time_s: f64,
    },
}

impl Model {
    /// The model in short.
    pub fn facts(&self) -> ModelFacts {
        match self {
            Model::Bench(document) => {
                ModelFacts::Bench { bench: document.bench.name.clone(), date: document.provenance.date.clone() }
            }
            Model::Linear(document) => {
                let names = |labels: &[Label]| labels.iter().map(|label| label.name.clone()).collect();
                let estimate = document.estimate.as_ref();
                let sources = estimate.iter().flat_map(|estimate| &estimate.sources);
                ModelFacts::Linear {
                    inputs: names(&document.inputs),
                    outputs: names(&document.outputs),
                    method: estimate.map(|estimate| estimate.method.clone()),
                    recordings: sources.map(|source| source.file.clone()).collect(),
                    sample_time_s: document.sample_time_s,
                }
            }
        }
    }
}

impl Files {
    /// The model in a file, whichever kind it is.
    ///
    /// # Errors
    /// A file that cannot be read, or is no model.
    pub fn model(&self, path: &Path) -> Result<Model, Error> {
        let text = self.model_text(path, ANY)?;
        match Kind::of(&text) {
            Kind::Bench => Ok(Model::Bench(Box::new(bench_model(path, &text)?))),
            Kind::Linear => Ok(Model::Linear(Box::new(linear_model(path, &text)?))),
            Kind::Study => Ok(Model::Bench(Box::new(self.bench_model(path)?))),
            Kind::Other => Err(no_model(path, &text, ANY)),
        }
    }

    /// The bench model in a file, or beside a study.
    ///
    /// # Errors
    /// A file that cannot be read, or holds none; a study that is another one than that of the model beside it.
    pub fn bench_model(&self, path: &Path) -> Result<BenchModelDocument, Error> {
        let text = self.model_text(path, BENCH)?;
        if Kind::of(&text) != Kind::Study {
            return bench_model(path, &text);
        }
        let beside = path.with_file_name(MODEL);
        if !beside.is_file() {
            return Err(Error::IsStudy { path: path.to_owned() });
        }
        let document = bench_model(&beside, &self.read_text(&beside, BENCH)?)?;
        match is_of_study(&document, &text) {
            true => Ok(document),
            false => Err(Error::OfTwoStudies { study: path.to_owned(), model: beside }),
        }
    }

    /// The linear model in a file.
    ///
    /// # Errors
    /// A file that cannot be read, or holds none.
    pub fn linear_model(&self, path: &Path) -> Result<ModelDocument, Error> {
        linear_model(path, &self.model_text(path, LINEAR)?)
    }

    /// The text of a model file, which may be in an FMU. The error for a file that is not text names what is `wanted`.
    pub(crate) fn model_text(&self, path: &Path, wanted: &'static str) -> Result<String, Error> {
        let is_fmu = paths::ending(path).is_some_and(|ending| ending.eq_ignore_ascii_case("fmu"));
        if !is_fmu {
            return self.read_text(path, wanted);
        }
        let bytes = self.read_bytes(path)?;
        export::fmu::model_in(&bytes).ok_or_else(|| Error::NoModelInside { path: path.to_owned() })
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
pub(crate) fn is_reported(document: &BenchModelDocument, report: &[u8]) -> bool {
    // As many digits as a report has of each recording.
    const DIGITS: usize = 12;
    let text = String::from_utf8_lossy(report);
    let origin = &document.provenance;
    let recordings =
        origin.recordings.iter().map(|recording| recording.sha256.get(..DIGITS).unwrap_or(&recording.sha256));
    std::iter::once(origin.bench_file.sha256.as_str()).chain(recordings).all(|hash| text.contains(hash))
}

/// The bench model that the text of a file holds.
fn bench_model(path: &Path, text: &str) -> Result<BenchModelDocument, Error> {
    match Kind::of(text) {
        Kind::Bench => BenchModelDocument::from_json(text).map_err(|source| Error::BenchModel {
            path: path.to_owned(),
            source: study::BenchModelError::Document { source },
        }),
        Kind::Linear => Err(Error::IsLinearModel { path: path.to_owned() }),
        Kind::Study => Err(Error::IsStudy { path: path.to_owned() }),
        Kind::Other => Err(no_model(path, text, BENCH)),
    }
}

/// The linear model that the text of a file holds.
fn linear_model(path: &Path, text: &str) -> Result<ModelDocument, Error> {
    match Kind::of(text) {
        Kind::Linear => {}
        Kind::Bench => return Err(Error::IsBenchModel { path: path.to_owned() }),
        Kind::Study => return Err(Error::IsStudy { path: path.to_owned() }),
        Kind::Other => return Err(no_model(path, text, LINEAR)),
    }
    let wrong = |reason: String| Error::ModelFile { path: path.to_owned(), reason };
    // First of all what it is: a later version may have another layout.
    let header: DocumentHeader = from_json(text).map_err(|fault| wrong(fault.to_string()))?;
    header.check().map_err(|source| Error::ModelVersion { path: path.to_owned(), source })?;
    let document: ModelDocument = from_json(text).map_err(|fault| wrong(fault.to_string()))?;
    document.checked().map_err(|error| wrong(error.to_string()))
}

/// That a text is none of the files of dynoid, and what it is instead.
pub(crate) fn no_model(path: &Path, text: &str, wanted: &'static str) -> Error {
    let reason = match (format_of(text), from_json::<Named>(text)) {
        (Some(format), _) => format!("its `format` is “{format}”"),
        (None, Err(fault)) => fault.to_string(),
        (None, Ok(_)) => "it has no `format`".to_owned(),
    };
    Error::NoModel { path: path.to_owned(), reason, wanted }
}

/// First entry of every file of dynoid.
#[derive(Deserialize)]
struct Named {
    #[serde(rename = "format")]
    _format: String,
}

/// Name of a model: that of its file.
pub fn model_name(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Checks that a linear model can be written there: under the ending .json, but for what is no file.
///
/// # Errors
/// Another ending, or a file that must stay.
pub fn check_model_file(path: &Path, files: &Files) -> Result<(), Error> {
    let is_json = paths::ending(path).is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
    let is_device = || std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir());
    match is_json || is_device() {
        true => check_file(path, &Mark::Document(Kind::Linear), files),
        false => Err(Error::ModelEnding { path: path.to_owned() }),
    }
}
