//! Data that were loaded.

use std::collections::BTreeSet;

use dataset::Adjustment;
use ident::{Dataset, Intersample, Label, Line, Source, Trend};

use super::note::Note;
use crate::error::CliError;

/// Data as an estimator gets them.
pub(in crate::commands::identify) struct Loaded {
    /// The data, trend taken off.
    pub(in crate::commands::identify) data: Dataset,
    /// Course of the inputs between the samples of their recordings.
    pub(in crate::commands::identify) between: Intersample,
    /// Trend that was taken off, per recording.
    pub(in crate::commands::identify) trend: Option<Trend>,
    /// The recordings they come from.
    pub(in crate::commands::identify) sources: Vec<Source>,
    /// Which of them each experiment is of, or is a part of.
    pub(in crate::commands::identify) recording: Vec<usize>,
    /// Adjustments of the channels on the way.
    pub(in crate::commands::identify) adjustments: Vec<Adjustment>,
    /// The same in words, and what should be known of the channels.
    pub(in crate::commands::identify) notes: Vec<Note>,
}

impl Loaded {
    /// The same without the recordings that no experiment is left of: nothing is known of them, and nothing rests on
    /// them.
    pub(in crate::commands::identify) fn without_unused(mut self) -> Result<Self, CliError> {
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
            self.trend = Some(left.map_err(|source| CliError::identify("the trend", source))?);
        }
        self.sources = used.into_iter().map(|n| self.sources[n].clone()).collect();
        Ok(self)
    }
}

/// Recordings and channels, as a message about them begins.
pub(in crate::commands::identify) fn named(data: &Dataset, sources: &[Source]) -> String {
    let files: Vec<&str> = sources.iter().map(|s| s.file.as_str()).collect();
    let names = |labels: &[Label]| labels.iter().map(|l| l.name.as_str()).collect::<Vec<_>>().join(", ");
    let (inputs, outputs) = (names(data.input_labels()), names(data.output_labels()));
    let arrow = if inputs.is_empty() { "" } else { " → " };
    format!("{} ({inputs}{arrow}{outputs})", files.join(", "))
}
