//! Parts of a data set, and data sets put together.

use std::borrow::Cow;
use std::ops::Range;

use faer::{Mat, MatRef};
use lti::LtiError;
use signal::SignalError;

use super::{Dataset, Experiment, Label};
use crate::IdentError;
use fitting::StructureError;

/// Stretches of one experiment at most.
const STRETCHES: usize = 4;
/// Samples from which a stretch is cut in two.
const LONG_STRETCH: usize = 10_000;

/// Data to estimate on and data to judge on.
#[derive(Debug, Clone, PartialEq)]
pub struct Split {
    /// Part that comes first in time.
    pub estimation: Dataset,
    /// Part that comes after it.
    pub validation: Dataset,
}

impl Dataset {
    /// The first `fraction` of the rows of every experiment to estimate on, the rest to judge on.
    ///
    /// An experiment too short to give a row to a part is absent from that part.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] unless the fraction lies between zero and one; [`IdentError::TooFewSamples`] where a
    /// part would be empty.
    ///
    /// # Example
    /// ```
    /// let data = ident::Dataset::siso(0.1, &[1.0; 10], &[2.0; 10])?;
    /// let parts = data.split(0.7)?;
    /// assert_eq!((parts.estimation.samples(), parts.validation.samples()), (7, 3));
    /// assert!((parts.validation.experiments()[0].start_s - 0.7).abs() < 1e-12);
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    pub fn split(&self, fraction: f64) -> Result<Split, IdentError> {
        check_range("fraction", fraction, 0.0, 1.0)?;
        let cut = |e: &Experiment| ((fraction * e.len() as f64).round() as usize).min(e.len());
        Ok(Split { estimation: self.parts(|e| 0..cut(e))?, validation: self.parts(|e| cut(e)..e.len())? })
    }

    /// The rows with these indices of every experiment, counted from zero, the end left out. An experiment that ends
    /// before them is absent; one that ends within them gives what it has.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] where nothing is left.
    pub fn rows(&self, range: Range<usize>) -> Result<Self, IdentError> {
        self.parts(|e| range.start.min(e.len())..range.end.min(e.len()))
    }

    /// About `most` samples of longer data: of every experiment its share, in up to four stretches spread evenly over
    /// it, each as an experiment of its own. Data with no more samples are given back as they are.
    ///
    /// # Example
    /// ```
    /// let data = ident::Dataset::siso(0.1, &[1.0; 100_000], &[2.0; 100_000])?;
    /// let some = data.excerpts(40_000);
    /// assert_eq!((some.samples(), some.experiments().len()), (40_000, 4));
    /// assert!((some.experiments()[1].start_s - 3250.0).abs() < 1e-6);
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    #[must_use]
    pub fn excerpts(&self, most: usize) -> Cow<'_, Self> {
        let all = self.samples();
        if all <= most.max(1) {
            return Cow::Borrowed(self);
        }
        let of = |e: &Experiment| -> Vec<Experiment> {
            let share = (most as f64 * (e.len() as f64 / all as f64)) as usize;
            let count = (share / LONG_STRETCH).clamp(1, STRETCHES);
            let (length, apart) = ((share / count).max(1).min(e.len()), e.len() / count);
            let first = |k: usize| (k * apart + (apart - length.min(apart)) / 2).min(e.len() - length);
            (0..count).map(|k| e.rows(first(k)..first(k) + length, self.sample_time_s)).collect()
        };
        let experiments = self.experiments.iter().filter(|e| !e.is_empty()).flat_map(of).collect();
        Cow::Owned(Dataset { experiments, ..self.without_experiments() })
    }

    /// So many samples from the start of every experiment.
    pub(crate) fn starts(&self, count: impl Fn(&Experiment) -> usize) -> Result<Self, IdentError> {
        self.parts(|e| 0..count(e).min(e.len()))
    }

    /// A stretch of every experiment; experiments whose stretch is empty are left out.
    fn parts(&self, mut stretch: impl FnMut(&Experiment) -> Range<usize>) -> Result<Self, IdentError> {
        let parts = self.experiments.iter().map(|e| e.rows(stretch(e), self.sample_time_s));
        let experiments: Vec<_> = parts.filter(|e| !e.is_empty()).collect();
        self.with_experiments(experiments)
    }

    /// The data with these inputs and outputs alone, in this order.
    ///
    /// # Errors
    /// [`LtiError::Index`] for a channel that does not exist; [`IdentError::NoOutput`].
    ///
    /// # Example
    /// ```
    /// use faer::Mat;
    /// let data = ident::Dataset::new(0.1, Mat::from_fn(5, 3, |_, j| j as f64), Mat::zeros(5, 2))?;
    /// let part = data.channels(&[2, 0], &[1])?;
    /// assert_eq!((part.experiments()[0].input(0)[0], part.output_labels()[0].name.as_str()), (2.0, "y2"));
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    pub fn channels(&self, inputs: &[usize], outputs: &[usize]) -> Result<Self, IdentError> {
        check_indices("input", inputs, self.inputs())?;
        check_indices("output", outputs, self.outputs())?;
        if outputs.is_empty() {
            return Err(IdentError::NoOutput);
        }
        let labels = |all: &[Label], wanted: &[usize]| wanted.iter().map(|i| all[*i].clone()).collect();
        let experiment = |e: &Experiment| Experiment {
            name: e.name.clone(),
            start_s: e.start_s,
            inputs: columns(e.inputs.as_ref(), inputs),
            outputs: columns(e.outputs.as_ref(), outputs),
        };
        Ok(Dataset {
            sample_time_s: self.sample_time_s,
            intersample: self.intersample,
            input_labels: labels(&self.input_labels, inputs),
            output_labels: labels(&self.output_labels, outputs),
            experiments: self.experiments.iter().map(experiment).collect(),
        })
    }

    /// The experiments with these indices, in this order.
    ///
    /// # Errors
    /// [`LtiError::Index`] for one that does not exist; [`IdentError::TooFewSamples`] for none at all.
    pub fn only_experiments(&self, indices: &[usize]) -> Result<Self, IdentError> {
        check_indices("experiment", indices, self.experiments.len())?;
        self.with_experiments(indices.iter().map(|i| self.experiments[*i].clone()).collect())
    }

    /// The experiments of both; the labels are those of `self`.
    ///
    /// # Errors
    /// [`IdentError::Length`] where the channels differ in number, [`LtiError::SampleTimesDiffer`], and
    /// [`IdentError::Structure`] where the inputs behave differently between samples.
    pub fn merge(&self, other: &Self) -> Result<Self, IdentError> {
        crate::data::check_clock(self.sample_time_s, other.sample_time_s)?;
        if self.intersample != other.intersample {
            return Err(StructureError::IntersampleDiffers.into());
        }
        other.experiments.iter().try_fold(self.clone(), |merged, e| merged.with_experiment(e.clone()))
    }

    /// Other experiments of the same channels, which are taken as they are.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] for none.
    pub(crate) fn with_experiments(&self, experiments: Vec<Experiment>) -> Result<Self, IdentError> {
        if experiments.is_empty() {
            return Err(IdentError::TooFewSamples { samples: 0, parameters: 1 });
        }
        Ok(Dataset { experiments, ..self.without_experiments() })
    }

    /// The channels alone.
    fn without_experiments(&self) -> Self {
        Dataset {
            sample_time_s: self.sample_time_s,
            intersample: self.intersample,
            input_labels: self.input_labels.clone(),
            output_labels: self.output_labels.clone(),
            experiments: Vec::new(),
        }
    }
}

impl Experiment {
    /// A stretch of rows; the range must lie within the experiment.
    pub(super) fn rows(&self, range: Range<usize>, sample_time_s: f64) -> Self {
        let part = |m: &Mat<f64>| m.get(range.clone(), ..).to_owned();
        let start_s = self.start_s + range.start as f64 * sample_time_s;
        // A time series has no rows of inputs to cut.
        let inputs = if self.inputs.ncols() == 0 { Mat::zeros(range.len(), 0) } else { part(&self.inputs) };
        Experiment { name: self.name.clone(), start_s, inputs, outputs: part(&self.outputs) }
    }
}

fn columns(m: MatRef<'_, f64>, wanted: &[usize]) -> Mat<f64> {
    Mat::from_fn(m.nrows(), wanted.len(), |i, j| m[(i, wanted[j])])
}

pub(super) fn check_indices(what: &'static str, indices: &[usize], count: usize) -> Result<(), IdentError> {
    match indices.iter().find(|i| **i >= count) {
        Some(index) => Err(LtiError::Index { what, index: *index, count }.into()),
        None => Ok(()),
    }
}

/// Checks `low <= value <= high`; NaN fails.
pub(crate) fn check_range(name: &'static str, value: f64, low: f64, high: f64) -> Result<(), IdentError> {
    if value >= low && value <= high { Ok(()) } else { Err(SignalError::Parameter { name, value, low, high }.into()) }
}

/// Sample times are compared with a tolerance, since they are often written in decimal.
pub(crate) fn check_clock(model_s: f64, data_s: f64) -> Result<(), LtiError> {
    if (model_s - data_s).abs() <= 1e-9 * data_s {
        return Ok(());
    }
    Err(LtiError::SampleTimesDiffer { first: Some(model_s), second: Some(data_s) })
}
