//! Missing samples: where they are, and what can be done about them.

use std::ops::Range;

use signal::runs;

use super::{Channel, Dataset, Experiment, column};
use crate::IdentError;

/// A run of missing samples in one channel.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Gap {
    /// Index of the experiment.
    pub experiment: usize,
    /// The channel.
    pub channel: Channel,
    /// The rows, the end left out.
    pub rows: Range<usize>,
}

impl Dataset {
    /// Every run of missing samples, experiment by experiment, inputs before outputs.
    #[must_use]
    pub fn gaps(&self) -> Vec<Gap> {
        let mut found = Vec::new();
        for (experiment, e) in self.experiments.iter().enumerate() {
            for channel in self.all_channels() {
                let values = e.channel(channel);
                let runs = runs(values.len(), |t| values[t].is_nan());
                found.extend(runs.map(|rows| Gap { experiment, channel, rows }));
            }
        }
        found
    }

    /// The uninterrupted stretches of at least `shortest` rows in which no channel misses a sample, each an experiment
    /// of its own. Estimators give each its own initial state.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] where no stretch is long enough.
    ///
    /// # Example
    /// ```
    /// let y = [1.0, 2.0, f64::NAN, 4.0, 5.0, 6.0];
    /// let data = ident::Dataset::siso(0.1, &[0.0; 6], &y)?.without_gaps(3)?;
    /// assert_eq!(data.experiments()[0].output(0), [4.0, 5.0, 6.0]);
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    pub fn without_gaps(&self, shortest: usize) -> Result<Self, IdentError> {
        self.stretches(shortest, true)
    }

    /// The stretches of at least `shortest` rows in which no input misses a sample, each an experiment of its own.
    /// Outputs may miss samples: this is for methods that see through them.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] where no stretch is long enough.
    ///
    /// # Example
    /// ```
    /// let (u, y) = ([1.0, f64::NAN, 3.0, 4.0], [1.0, 2.0, f64::NAN, 4.0]);
    /// let data = ident::Dataset::siso(0.1, &u, &y)?.without_input_gaps(2)?;
    /// assert_eq!(data.experiments()[0].input(0), [3.0, 4.0]);
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    pub fn without_input_gaps(&self, shortest: usize) -> Result<Self, IdentError> {
        self.stretches(shortest, false)
    }

    fn stretches(&self, shortest: usize, outputs_too: bool) -> Result<Self, IdentError> {
        let (mut experiments, mut longest) = (Vec::new(), 0);
        for e in &self.experiments {
            let complete = e.complete_stretches(outputs_too);
            let pieces = complete.len();
            for (piece, rows) in complete.into_iter().enumerate() {
                longest = longest.max(rows.len());
                if rows.len() < shortest.max(1) {
                    continue;
                }
                let mut part = e.rows(rows, self.sample_time_s);
                if pieces > 1 {
                    part.name = format!("{} part {}", e.name, piece + 1);
                }
                experiments.push(part);
            }
        }
        if experiments.is_empty() {
            return Err(IdentError::TooFewSamples { samples: longest, parameters: shortest });
        }
        self.with_experiments(experiments)
    }

    /// Gaps of at most `longest` samples between two known ones filled by a straight line; longer gaps and those at the
    /// ends stay as they are ([`Dataset::gaps`] lists them).
    ///
    /// Filled samples are invented: they lower the noise, and their inputs were not those of the system. Fill a few,
    /// split the data at the rest.
    ///
    /// # Errors
    /// None for data that were checked.
    pub fn fill_gaps(&self, longest: usize) -> Result<Self, IdentError> {
        self.map_columns(|x| {
            let mut filled = x.to_vec();
            for gap in runs(x.len(), |t| x[t].is_nan()) {
                if gap.len() > longest || gap.start == 0 || gap.end == x.len() {
                    continue;
                }
                let (before, after) = (x[gap.start - 1], x[gap.end]);
                let steps = (gap.len() + 1) as f64;
                for (i, slot) in filled[gap].iter_mut().enumerate() {
                    let share = (i + 1) as f64 / steps;
                    *slot = before * (1.0 - share) + after * share;
                }
            }
            Ok(filled)
        })
    }

    /// Every channel, inputs first.
    pub(crate) fn all_channels(&self) -> impl Iterator<Item = Channel> + use<> {
        (0..self.inputs()).map(Channel::Input).chain((0..self.outputs()).map(Channel::Output))
    }

    /// An error for the first missing sample.
    pub(crate) fn refuse_missing(&self) -> Result<(), IdentError> {
        for e in &self.experiments {
            for (what, m) in [("an input", &e.inputs), ("an output", &e.outputs)] {
                for j in 0..m.ncols() {
                    if let Some(index) = column(m.as_ref(), j).iter().position(|v| v.is_nan()) {
                        return Err(IdentError::Missing { what, index });
                    }
                }
            }
        }
        Ok(())
    }
}

impl Experiment {
    /// A channel as a slice.
    #[must_use]
    pub fn channel(&self, channel: Channel) -> &[f64] {
        match channel {
            Channel::Input(index) => self.input(index),
            Channel::Output(index) => self.output(index),
        }
    }

    fn complete_stretches(&self, outputs_too: bool) -> Vec<Range<usize>> {
        let mut complete = vec![1.0; self.len()];
        for m in [&self.inputs, &self.outputs].into_iter().take(1 + usize::from(outputs_too)) {
            for j in 0..m.ncols() {
                complete.iter_mut().zip(column(m.as_ref(), j)).for_each(|(c, v)| *c *= f64::from(!v.is_nan()));
            }
        }
        runs(complete.len(), |t| complete[t] > 0.0).collect()
    }
}

/// Counts the instants at which an output is missing.
///
/// # Errors
/// [`IdentError::MissingInput`].
pub(crate) fn check_missing(data: &Dataset) -> Result<usize, IdentError> {
    let mut missing = 0;
    for (index, experiment) in data.experiments().iter().enumerate() {
        for (k, label) in data.input_labels().iter().enumerate() {
            if let Some(at) = experiment.input(k).iter().position(|v| v.is_nan()) {
                return Err(IdentError::MissingInput { experiment: index, channel: label.name.clone(), index: at });
            }
        }
        let incomplete = |t: &usize| (0..data.outputs()).any(|i| experiment.output(i)[*t].is_nan());
        missing += (0..experiment.len()).filter(incomplete).count();
    }
    Ok(missing)
}
