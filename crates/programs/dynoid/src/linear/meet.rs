//! Recordings that models meet.

use std::path::{Path, PathBuf};

use dataset::{CommonClock, DatasetError};
use faer::Mat;
use ident::uncertainty::Dynamics;
use ident::{Experiment, Label, ModelDocument};
use toolbox_report::data::Purpose;
use units::may_be_same;
use work::Context;

use super::data::DataOptions;
use super::gaps::Gaps;
use super::loaded::Loaded;
use super::operating_point::{self, MeetingTrend};
use super::recorded::RecordedFiles;
use crate::error::Error;
use crate::files::Files;
use crate::models::model_name;

/// A linear model with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedModel {
    /// Its name.
    pub name: String,
    /// The model.
    pub document: ModelDocument,
}

impl NamedModel {
    /// Reads a model file; the model has its name.
    ///
    /// # Errors
    /// A file that cannot be read, or holds no linear model.
    pub fn read(path: &Path, files: &Files) -> Result<Self, Error> {
        Ok(NamedModel { name: model_name(path), document: files.linear_model(path)? })
    }
}

/// Recordings that a model meets. Channels and clock are those of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct MeetOptions {
    /// Recordings, or folders of recordings.
    pub recordings: Vec<PathBuf>,
    /// Everything before this time is left out, s.
    pub from_s: Option<f64>,
    /// Everything after this time is left out, s.
    pub to_s: Option<f64>,
    /// Sample time for a continuous model, and from row to row of text without a time column, s; that of the model
    /// without it.
    pub sample_time_s: Option<f64>,
    /// Levels that are taken off first, and put back onto the results.
    pub trend: MeetingTrend,
}

impl MeetOptions {
    /// Whole recordings at the operating point of the model.
    pub fn of(recordings: &[PathBuf]) -> Self {
        let recordings = recordings.to_vec();
        MeetOptions { recordings, from_s: None, to_s: None, sample_time_s: None, trend: MeetingTrend::Model }
    }

    /// The time from row to row of text without a time column.
    pub(super) fn row_time_s(&self, document: &ModelDocument) -> f64 {
        self.sample_time_s.unwrap_or(document.sample_time_s)
    }

    /// Reads the recordings with the channels of these models, for this one.
    pub(super) fn read(
        &self,
        all: &[&ModelDocument],
        document: &ModelDocument,
        files: &Files,
        context: &Context,
    ) -> Result<RecordedFiles, Error> {
        RecordedFiles::read(&self.recordings, &channels(all), Some(self.row_time_s(document)), files, context)
    }

    /// The model's channels out of recordings, on the model's clock or, for a continuous model, on the one given; cut
    /// where inputs are missing.
    pub(super) fn meet(&self, document: &ModelDocument, files: &RecordedFiles) -> Result<Loaded, Error> {
        let names = |labels: &[Label]| labels.iter().map(|label| label.name.clone()).collect();
        let options = DataOptions {
            recordings: self.recordings.clone(),
            inputs: names(&document.inputs),
            outputs: names(&document.outputs),
            from_s: self.from_s,
            to_s: self.to_s,
            sample_time_s: Some(self.clock_s(document, files)?),
            detrend: None,
            between: Some(document.intersample),
        };
        let about = |data: &_, sources: &_| operating_point::trend(document, self.trend, data, sources);
        let loaded = Loaded::take_about(files, CommonClock::Slowest, &options, Purpose::Judgement, about)?;
        check_units(document, &loaded)?;
        loaded.cut_at(Gaps::OfInputs)
    }

    /// As [`Self::meet`], but recordings without the outputs will do: a simulation needs the inputs alone. Unmeasured
    /// outputs are missing throughout.
    pub(super) fn meet_inputs(&self, document: &ModelDocument, files: &RecordedFiles) -> Result<Loaded, Error> {
        let is_output = |name: &str| document.outputs.iter().any(|label| label.name == name);
        let missing = match self.meet(document, files) {
            Err(Error::Dataset { source: DatasetError::NoChannel { channel, .. } }) if is_output(&channel) => channel,
            other => return other,
        };
        let failed = |source| Error::identify("the simulation", source);
        let Some(first) = document.inputs.first() else { return Err(Error::NothingToSimulateOn) };
        if matches!(self.trend, MeetingTrend::Own(_)) {
            return Err(Error::TrendOfMissing { channel: missing });
        }
        let mut inputs_only = document.clone();
        // A stand-in for every output, so that the data have the model's shape; its values are taken out again.
        inputs_only.outputs = vec![first.clone(); document.outputs.len()];
        let loaded = self.meet(&inputs_only, files)?;
        let unmeasured = |e: &Experiment| {
            let outputs = Mat::full(e.len(), document.outputs.len(), f64::NAN);
            Ok(Experiment { outputs, ..e.clone() })
        };
        let data = loaded.data.map_experiments(unmeasured).map_err(failed)?;
        let data = data.with_labels(document.inputs.clone(), document.outputs.clone()).map_err(failed)?;
        Ok(Loaded { data, ..loaded })
    }

    /// The clock of the data that a model meets.
    fn clock_s(&self, document: &ModelDocument, files: &RecordedFiles) -> Result<f64, Error> {
        let own_s = document.sample_time_s;
        let is_discrete = document.model.system().is_ok_and(|system| system.sample_time_s().is_some());
        match self.sample_time_s {
            Some(given_s) if !is_discrete => Ok(given_s),
            // With text of another time from row to row, the data are brought onto the model's clock.
            Some(given_s) if given_s != own_s && !files.are_untimed() => Err(Error::ClockOfModel { given_s, own_s }),
            _ => Ok(own_s),
        }
    }
}

/// The names of all channels of models, each once.
fn channels<'a>(documents: &[&'a ModelDocument]) -> Vec<&'a str> {
    let labels = documents.iter().flat_map(|document| document.inputs.iter().chain(&document.outputs));
    let mut names: Vec<&str> = labels.map(|label| label.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// Refuses channels in another unit than the model's.
fn check_units(document: &ModelDocument, loaded: &Loaded) -> Result<(), Error> {
    let found = loaded.data.input_labels().iter().chain(loaded.data.output_labels());
    let mut pairs = document.inputs.iter().chain(&document.outputs).zip(found);
    match pairs.find(|(expected, found)| !may_be_same(&expected.unit, &found.unit)) {
        None => Ok(()),
        Some((expected, found)) => Err(Error::UnitOfModel {
            data: loaded.sources.iter().map(|s| s.file.as_str()).collect::<Vec<_>>().join(", "),
            channel: found.name.clone(),
            found: found.unit.clone(),
            expected: expected.unit.clone(),
        }),
    }
}
