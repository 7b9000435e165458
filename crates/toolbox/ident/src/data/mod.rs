//! [`Dataset`]: what estimators are given.

pub(crate) mod band_limited;
mod build;
pub(crate) mod excitation;
pub(crate) mod excited_lines;
mod filter;
mod missing;
pub(crate) mod origin;
pub(crate) mod regression;
mod resample;
mod select;
mod trend;

pub use filter::Prefilter;
pub use missing::Gap;
pub(crate) use missing::check_missing;
pub use select::Split;
pub(crate) use select::{check_clock, check_range};
pub use trend::{Line, Trend, TrendScope, TrendShape};

use faer::{Mat, MatRef};

use crate::IdentError;

/// Behaviour of the inputs between samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Intersample {
    /// Held until the next sample, as a computer's outputs are.
    #[default]
    ZeroOrderHold,
    /// Straight lines from sample to sample.
    FirstOrderHold,
    /// No content above half the sample rate, as after an anti-alias filter or with a multisine.
    BandLimited,
}

/// Name and unit of a channel. Carried along, never interpreted.
#[derive(Debug, Clone, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Label {
    /// Its name.
    pub name: String,
    /// Its unit, empty where unknown.
    pub unit: String,
}

impl Label {
    /// A label of a name and a unit.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Label { name: name.into(), unit: unit.into() }
    }
}

/// One channel of a data set, by its index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// An input.
    Input(usize),
    /// An output.
    Output(usize),
}

/// One uninterrupted record. Rows are time, columns are channels; NaN marks a missing sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// Name of the experiment.
    pub name: String,
    /// Instant of the first row, in seconds.
    pub start_s: f64,
    /// Inputs, samples × inputs.
    pub inputs: Mat<f64>,
    /// Outputs, samples × outputs.
    pub outputs: Mat<f64>,
}

impl Experiment {
    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.outputs.nrows()
    }

    /// Returns true if there is no row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// One input as a slice.
    #[must_use]
    pub fn input(&self, index: usize) -> &[f64] {
        column(self.inputs.as_ref(), index)
    }

    /// One output as a slice.
    #[must_use]
    pub fn output(&self, index: usize) -> &[f64] {
        column(self.outputs.as_ref(), index)
    }

    /// Returns true if any sample is missing.
    #[must_use]
    pub fn has_missing(&self) -> bool {
        let missing = |m: &Mat<f64>| (0..m.ncols()).any(|j| column(m.as_ref(), j).iter().any(|v| v.is_nan()));
        missing(&self.inputs) || missing(&self.outputs)
    }
}

/// A column of a matrix; empty where the matrix is.
pub(crate) fn column(m: MatRef<'_, f64>, index: usize) -> &[f64] {
    m.col(index).try_as_col_major().map_or(&[], |c| c.as_slice())
}

/// Inputs and outputs of one system over one or several experiments, on one sample time.
///
/// # Example
/// ```
/// let data = ident::Dataset::siso(0.1, &[1.0, 0.0, 0.0], &[0.0, 2.0, 1.0])?;
/// assert_eq!((data.samples(), data.inputs(), data.outputs()), (3, 1, 1));
/// # Ok::<(), ident::IdentError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Dataset {
    sample_time_s: f64,
    intersample: Intersample,
    input_labels: Vec<Label>,
    output_labels: Vec<Label>,
    experiments: Vec<Experiment>,
}

impl Dataset {
    /// One experiment that starts at zero: `inputs` is samples × inputs (no column for a time series), `outputs`
    /// samples × outputs. Inputs are held between samples; see [`Dataset::with_intersample`].
    ///
    /// # Errors
    /// [`IdentError::SampleTime`]; [`IdentError::Length`] where the rows differ in number; [`IdentError::NotFinite`]
    /// for an infinite value (NaN is a missing sample); [`IdentError::NoOutput`].
    pub fn new(sample_time_s: f64, inputs: Mat<f64>, outputs: Mat<f64>) -> Result<Self, IdentError> {
        if !(sample_time_s.is_finite() && sample_time_s > 0.0) {
            return Err(IdentError::SampleTime { sample_time_s });
        }
        let numbered = |letter: char, count: usize| match count {
            1 => vec![Label::new(letter, "")],
            _ => (1..=count).map(|k| Label::new(format!("{letter}{k}"), "")).collect(),
        };
        let data = Dataset {
            sample_time_s,
            intersample: Intersample::default(),
            input_labels: numbered('u', inputs.ncols()),
            output_labels: numbered('y', outputs.ncols()),
            experiments: Vec::new(),
        };
        data.with_experiment(Experiment { name: "1".into(), start_s: 0.0, inputs, outputs })
    }

    /// One input `u` and one output `y` in one experiment.
    ///
    /// # Errors
    /// Those of [`Dataset::new`].
    pub fn siso(sample_time_s: f64, u: &[f64], y: &[f64]) -> Result<Self, IdentError> {
        let one = |x: &[f64]| Mat::from_fn(x.len(), 1, |i, _| x[i]);
        Self::new(sample_time_s, one(u), one(y))
    }

    /// The same data and a further experiment with the same channels.
    ///
    /// # Errors
    /// Those of [`Dataset::new`].
    pub fn with_experiment(mut self, experiment: Experiment) -> Result<Self, IdentError> {
        check_experiment(&experiment, self.inputs(), self.outputs())?;
        self.experiments.push(experiment);
        Ok(self)
    }

    /// The same data with these names and units.
    ///
    /// # Errors
    /// [`IdentError::Length`] where there is not one label a channel.
    pub fn with_labels(mut self, inputs: Vec<Label>, outputs: Vec<Label>) -> Result<Self, IdentError> {
        check_count("input labels", self.inputs(), inputs.len())?;
        check_count("output labels", self.outputs(), outputs.len())?;
        (self.input_labels, self.output_labels) = (inputs, outputs);
        Ok(self)
    }

    /// The same data with another behaviour of the inputs between samples.
    #[must_use]
    pub fn with_intersample(mut self, intersample: Intersample) -> Self {
        self.intersample = intersample;
        self
    }

    /// The sample time, in seconds.
    #[must_use]
    pub fn sample_time_s(&self) -> f64 {
        self.sample_time_s
    }

    /// Behaviour of the inputs between samples.
    #[must_use]
    pub fn intersample(&self) -> Intersample {
        self.intersample
    }

    /// Number of inputs; zero for a time series.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.input_labels.len()
    }

    /// Number of outputs.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.output_labels.len()
    }

    /// Number of rows, over all experiments.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.experiments.iter().map(Experiment::len).sum()
    }

    /// Names and units of the inputs.
    #[must_use]
    pub fn input_labels(&self) -> &[Label] {
        &self.input_labels
    }

    /// Names and units of the outputs.
    #[must_use]
    pub fn output_labels(&self) -> &[Label] {
        &self.output_labels
    }

    /// The experiments.
    #[must_use]
    pub fn experiments(&self) -> &[Experiment] {
        &self.experiments
    }

    /// The same channels with every experiment replaced by what `change` makes of it.
    ///
    /// # Errors
    /// Those of `change`, and those of [`Dataset::new`] for what it returns.
    pub fn map_experiments(
        &self,
        mut change: impl FnMut(&Experiment) -> Result<Experiment, IdentError>,
    ) -> Result<Self, IdentError> {
        let mut mapped = Dataset { experiments: Vec::new(), ..self.clone() };
        for experiment in &self.experiments {
            mapped = mapped.with_experiment(change(experiment)?)?;
        }
        Ok(mapped)
    }
}

fn check_experiment(experiment: &Experiment, inputs: usize, outputs: usize) -> Result<(), IdentError> {
    if outputs == 0 {
        return Err(IdentError::NoOutput);
    }
    check_count("input columns", inputs, experiment.inputs.ncols())?;
    check_count("output columns", outputs, experiment.outputs.ncols())?;
    if inputs > 0 {
        check_count("input rows", experiment.outputs.nrows(), experiment.inputs.nrows())?;
    }
    for (what, m) in [("the inputs", &experiment.inputs), ("the outputs", &experiment.outputs)] {
        for j in 0..m.ncols() {
            if let Some(index) = column(m.as_ref(), j).iter().position(|v| v.is_infinite()) {
                return Err(IdentError::NotFinite { what, index });
            }
        }
    }
    Ok(())
}

pub(crate) fn check_count(what: &'static str, expected: usize, found: usize) -> Result<(), IdentError> {
    if expected == found { Ok(()) } else { Err(IdentError::Length { what, expected, found }) }
}
