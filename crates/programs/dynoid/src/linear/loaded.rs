//! Data that were loaded.

use std::collections::BTreeSet;

use dataset::Adjustment;
use ident::{Dataset, Intersample, Label, Line, Source, Trend};

use super::note::Note;
use crate::error::Error;

/// Data as an estimator gets them.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The data, trend taken off.
    pub data: Dataset,
    /// Course of the inputs between the samples of their recordings.
    pub between: Intersample,
    /// Trend that was taken off, per recording.
    pub trend: Option<Trend>,
    /// The recordings they come from.
    pub sources: Vec<Source>,
    /// Which of them each experiment is of, or is a part of.
    pub recording: Vec<usize>,
    /// Adjustments of the channels on the way.
    pub adjustments: Vec<Adjustment>,
    /// The same in words, and what should be known of the channels.
    pub notes: Vec<Note>,
}

impl Loaded {
    /// The same without the recordings that no experiment is left of: nothing is known of them, and nothing rests on
    /// them.
    pub(super) fn without_unused(mut self) -> Result<Self, Error> {
        let used: BTreeSet<usize> = self.recording.iter().copied().collect();
        if used.len() == self.sources.len() {
            return Ok(self);
        }
        let place = |of: &usize| used.range(..of).count();
        self.recording = self.recording.iter().map(place).collect();
        if let Some(trend) = self.trend.take() {
            let lines = |of: &dyn Fn(usize) -> Vec<Line>| used.iter().copied().map(of).collect();
            let (inputs, outputs) = (lines(&|n| trend.inputs(n).to_vec()), lines(&|n| trend.outputs(n).to_vec()));
            let left = Trend::per_experiment(inputs, outputs);
            self.trend = Some(left.map_err(|source| Error::identify("the trend", source))?);
        }
        self.sources = used.into_iter().map(|n| self.sources[n].clone()).collect();
        Ok(self)
    }
}

/// Recordings and channels, as a message about them begins.
pub(super) fn named(data: &Dataset, sources: &[Source]) -> String {
    let files: Vec<&str> = sources.iter().map(|s| s.file.as_str()).collect();
    let names = |labels: &[Label]| labels.iter().map(|l| l.name.as_str()).collect::<Vec<_>>().join(", ");
    let (inputs, outputs) = (names(data.input_labels()), names(data.output_labels()));
    let arrow = if inputs.is_empty() { "" } else { " → " };
    format!("{} ({inputs}{arrow}{outputs})", files.join(", "))
}
