//! From recordings and channel names to data without trend.

use std::path::PathBuf;

use dataset::{Adjustment, CommonClock, DatasetOptions, dataset};
use ident::{Advice, Dataset, IdentError, Intersample, Source, Trend, TrendScope, TrendShape, advise};
use recording::Recording;
use toolbox_report::data::{self as words, Purpose};
use work::Context;

use super::faults;
use super::loaded::Loaded;
use super::note::Note;
use super::recorded::RecordedFiles;
use crate::error::Error;
use crate::files::Files;

/// Most names listed in a message.
const MOST_NAMES: usize = 20;

/// Channels, time and clock of data.
#[derive(Debug, Clone, PartialEq)]
pub struct DataOptions {
    /// Recordings, or folders of recordings, one experiment each.
    pub recordings: Vec<PathBuf>,
    /// Names of the input channels.
    pub inputs: Vec<String>,
    /// Names of the output channels.
    pub outputs: Vec<String>,
    /// Everything before this time is left out, s.
    pub from_s: Option<f64>,
    /// Everything after this time is left out, s.
    pub to_s: Option<f64>,
    /// Sample time of the data, and from row to row of text without a time column, s.
    pub sample_time_s: Option<f64>,
    /// Shape of what is taken off every channel first.
    pub detrend: Option<TrendShape>,
    /// Course of the inputs between their samples; held without it.
    pub between: Option<Intersample>,
}

impl DataOptions {
    /// Whole recordings without their means.
    pub fn of(recordings: &[PathBuf], inputs: &[&str], outputs: &[&str]) -> Self {
        let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        DataOptions {
            recordings: recordings.to_vec(),
            inputs: owned(inputs),
            outputs: owned(outputs),
            from_s: None,
            to_s: None,
            sample_time_s: None,
            detrend: Some(TrendShape::Mean),
            between: None,
        }
    }

    /// Reads the recordings named.
    ///
    /// # Errors
    /// A channel that is named twice, and a file that cannot be read.
    pub fn read(&self, files: &Files, context: &Context) -> Result<RecordedFiles, Error> {
        let all: Vec<&String> = self.inputs.iter().chain(&self.outputs).collect();
        if let Some(twice) = all.iter().enumerate().find(|(index, name)| all[..*index].contains(name)) {
            return Err(Error::ChannelTwice { channel: (*twice.1).clone() });
        }
        // Without outputs nothing is estimated, but what there is will be listed.
        let names: Vec<&str> =
            if self.outputs.is_empty() { Vec::new() } else { all.iter().map(|n| n.as_str()).collect() };
        RecordedFiles::read(&self.recordings, &names, self.sample_time_s, files, context)
    }

    fn check_window(&self) -> Result<(), Error> {
        match (self.from_s, self.to_s) {
            (Some(from_s), Some(to_s)) if from_s >= to_s => Err(Error::EmptyWindow { from_s, to_s }),
            _ => Ok(()),
        }
    }

    /// The outputs named, or an error that lists what there is.
    fn chosen_outputs(&self, recordings: &[(&str, &Recording)]) -> Result<Vec<String>, Error> {
        if !self.outputs.is_empty() {
            return Ok(self.outputs.clone());
        }
        let (file, recording) = recordings.first().copied().unzip();
        let channels = recording.map(|r| r.channels.as_slice()).unwrap_or_default();
        let mut names: Vec<&str> = channels.iter().map(|c| c.name.as_str()).take(MOST_NAMES).collect();
        if channels.len() > MOST_NAMES {
            names.push("…");
        }
        Err(Error::NoOutputNamed { file: file.unwrap_or_default().to_owned(), channels: names.join(", ") })
    }
}

impl Loaded {
    /// The channels of recordings that were read, trend taken off; on a clock of their own unless one is asked for.
    ///
    /// # Errors
    /// Channels that make no data.
    pub fn take(files: &RecordedFiles, usual: CommonClock, options: &DataOptions) -> Result<Self, Error> {
        let shape = options.detrend;
        Self::take_about(files, usual, options, Purpose::Estimate(shape), |data, _| trend(data, shape))
    }

    /// As [`Loaded::take`], with the trend that is found in the data and where they come from.
    ///
    /// # Errors
    /// Those of [`Loaded::take`].
    pub fn take_about(
        files: &RecordedFiles,
        usual: CommonClock,
        options: &DataOptions,
        purpose: Purpose,
        trend: impl FnOnce(&Dataset, &[Source]) -> Result<Option<Trend>, IdentError>,
    ) -> Result<Self, Error> {
        options.check_window()?;
        let recordings = files.recordings();
        let of_data = DatasetOptions {
            inputs: options.inputs.clone(),
            outputs: options.chosen_outputs(&recordings)?,
            from_s: options.from_s,
            to_s: options.to_s,
            clock: options.sample_time_s.map_or(usual, CommonClock::Every),
            intersample: options.between.unwrap_or(Intersample::ZeroOrderHold),
        };
        let (data, adjustments) = dataset(&recordings, &of_data).map_err(Error::from)?;
        faults::check_sizes(&data, &files.named(&data))?;
        let mut notes: Vec<Note> = files.doubles().into_iter().map(Note::Warning).collect();
        notes.extend(files.clocks().into_iter().map(Note::Done));
        // Inputs that stand in for outputs have their own adjustments.
        let is_stand_in = options.outputs.iter().all(|name| options.inputs.contains(name));
        let is_news = |a: &&Adjustment| !(is_stand_in && matches!(a, Adjustment::Sparse { .. }));
        let given = options.sample_time_s.is_some();
        notes.extend(adjustments.iter().filter(is_news).map(|a| Note::Done(words::adjustment(a, purpose, given))));
        let advice = if is_stand_in { Vec::new() } else { advise(&data) };
        let is_explained = |advice: &&Advice| words::is_explained(advice, &adjustments, &data);
        let advice = advice.iter().filter(|advice| words::matters(advice, purpose)).filter(|a| !is_explained(a));
        notes.extend(advice.map(|advice| Note::Warning(words::advice(advice, &data))));
        let sources = files.sources(&data);
        let trend = trend(&data, &sources).map_err(|source| Error::identify("the trend", source))?;
        let data = match &trend {
            Some(trend) => trend.remove(&data).map_err(|source| Error::identify("the trend", source))?,
            None => data,
        };
        let recording = (0..data.experiments().len()).collect();
        let between = of_data.intersample;
        Ok(Loaded { data, between, trend, sources, recording, adjustments, notes })
    }
}

/// The trend of data themselves.
pub(super) fn trend(data: &Dataset, shape: Option<TrendShape>) -> Result<Option<Trend>, IdentError> {
    shape.map(|shape| Trend::estimate(data, shape, TrendScope::PerExperiment)).transpose()
}
