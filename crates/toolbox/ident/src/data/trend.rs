//! Means, offsets and drifts: taken off before estimation, put back after simulation.

use faer::{Mat, MatRef};

use super::{Dataset, Experiment};
use crate::IdentError;

/// A level that may drift: `level + slope_per_s · (t − at_s)`.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Line {
    /// Value at `at_s`, in the channel's unit.
    pub level: f64,
    /// Rise per second.
    pub slope_per_s: f64,
    /// The instant where `level` holds, in seconds.
    pub at_s: f64,
}

impl Line {
    /// A level that does not drift.
    #[must_use]
    pub fn level(level: f64) -> Self {
        Line { level, slope_per_s: 0.0, at_s: 0.0 }
    }

    /// The value at an instant.
    #[must_use]
    pub fn at(&self, time_s: f64) -> f64 {
        self.level + self.slope_per_s * (time_s - self.at_s)
    }
}

/// Part of a channel that counts as its trend.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrendShape {
    /// Its mean.
    Mean,
    /// Its straight line of least squares over time.
    Line,
}

/// Experiments that share a trend: each alone, or all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrendScope {
    /// Each experiment has its own: its operating point differs from that of the others.
    PerExperiment,
    /// One for all, on the data's clock: levels that differ between experiments stay in the data.
    Common,
}

/// Offsets and drifts of every channel. A linear model holds about an operating point: take the trend off before
/// estimating, and put it back on what the model simulates.
///
/// # Example
/// ```
/// use ident::{Dataset, Trend, TrendScope, TrendShape};
/// let data = Dataset::siso(1.0, &[1.0, 2.0, 3.0], &[10.0, 10.0, 13.0])?;
/// let trend = Trend::estimate(&data, TrendShape::Mean, TrendScope::PerExperiment)?;
/// let about_zero = trend.remove(&data)?;
/// assert_eq!(about_zero.experiments()[0].output(0), [-1.0, -1.0, 2.0]);
/// assert_eq!(trend.restore(&about_zero)?, data);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, §14.1.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Trend {
    /// One list for all experiments, or one an experiment.
    inputs: Vec<Vec<Line>>,
    outputs: Vec<Vec<Line>>,
}

impl Trend {
    /// The trend of the data, missing samples left out.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] where a channel has fewer known samples than the trend has numbers.
    pub fn estimate(data: &Dataset, shape: TrendShape, scope: TrendScope) -> Result<Self, IdentError> {
        let all: Vec<&Experiment> = data.experiments().iter().collect();
        let groups: Vec<&[&Experiment]> = match scope {
            TrendScope::PerExperiment => all.chunks(1).collect(),
            TrendScope::Common => vec![&all],
        };
        let lines = |count: usize, channel: fn(&Experiment, usize) -> &[f64]| {
            let of_group = |group: &&[&Experiment]| {
                let of_channel = |k| {
                    let parts = group.iter().map(|e| (e.start_s, channel(e, k)));
                    line(parts, data.sample_time_s(), shape)
                };
                (0..count).map(of_channel).collect::<Result<Vec<Line>, _>>()
            };
            groups.iter().map(of_group).collect::<Result<Vec<_>, _>>()
        };
        let inputs = lines(data.inputs(), Experiment::input)?;
        Ok(Trend { inputs, outputs: lines(data.outputs(), Experiment::output)? })
    }

    /// Known levels, the same in all experiments: one an input and one an output.
    ///
    /// # Errors
    /// [`IdentError::NotFinite`].
    pub fn offsets(inputs: &[f64], outputs: &[f64]) -> Result<Self, IdentError> {
        for (what, values) in [("the input offsets", inputs), ("the output offsets", outputs)] {
            if let Some(index) = values.iter().position(|v| !v.is_finite()) {
                return Err(IdentError::NotFinite { what, index });
            }
        }
        let levels = |values: &[f64]| vec![values.iter().copied().map(Line::level).collect()];
        Ok(Trend { inputs: levels(inputs), outputs: levels(outputs) })
    }

    /// Known lines, one list an experiment: one line an input, and one an output.
    ///
    /// # Errors
    /// [`IdentError::Length`] for another number of experiments of the outputs than of the inputs.
    pub fn per_experiment(inputs: Vec<Vec<Line>>, outputs: Vec<Vec<Line>>) -> Result<Self, IdentError> {
        super::check_count("experiments of the outputs", inputs.len(), outputs.len())?;
        Ok(Trend { inputs, outputs })
    }

    /// Checks that every experiment has a line for each of so many inputs and outputs.
    pub(crate) fn check_channels(&self, inputs: usize, outputs: usize) -> Result<(), IdentError> {
        super::check_count("experiments of the trend", self.outputs.len(), self.inputs.len())?;
        self.inputs.iter().try_for_each(|lines| super::check_count("inputs of the trend", inputs, lines.len()))?;
        self.outputs.iter().try_for_each(|lines| super::check_count("outputs of the trend", outputs, lines.len()))
    }

    /// How many experiments have lines of their own; one where all share them.
    #[must_use]
    pub fn count(&self) -> usize {
        self.outputs.len()
    }

    /// The lines of the inputs in an experiment.
    #[must_use]
    pub fn inputs(&self, experiment: usize) -> &[Line] {
        of_experiment(&self.inputs, experiment)
    }

    /// The lines of the outputs in an experiment.
    #[must_use]
    pub fn outputs(&self, experiment: usize) -> &[Line] {
        of_experiment(&self.outputs, experiment)
    }

    /// The data less the trend.
    ///
    /// # Errors
    /// [`IdentError::Length`] where the trend is of other channels, or has its own lines for another number of
    /// experiments.
    pub fn remove(&self, data: &Dataset) -> Result<Dataset, IdentError> {
        self.apply(data, -1.0)
    }

    /// The data with the trend put back.
    ///
    /// # Errors
    /// Those of [`Trend::remove`].
    pub fn restore(&self, data: &Dataset) -> Result<Dataset, IdentError> {
        self.apply(data, 1.0)
    }

    /// Simulated or predicted outputs (rows are time, columns outputs) with the trend put back; `start_s` is the
    /// instant of their first row.
    ///
    /// # Errors
    /// [`IdentError::Length`] for another number of outputs or an experiment the trend does not have.
    pub fn restore_outputs(
        &self,
        outputs: MatRef<'_, f64>,
        experiment: usize,
        start_s: f64,
        sample_time_s: f64,
    ) -> Result<Mat<f64>, IdentError> {
        let lines = self.outputs(experiment);
        super::check_count("trends of outputs", outputs.ncols(), lines.len())?;
        Ok(shifted(outputs, lines, start_s, sample_time_s, 1.0))
    }

    fn apply(&self, data: &Dataset, sign: f64) -> Result<Dataset, IdentError> {
        let count = data.experiments().len();
        if self.outputs.len() > 1 {
            super::check_count("experiments of the trend", count, self.outputs.len())?;
        }
        let mut index = 0;
        data.map_experiments(|e| {
            let (inputs, outputs) = (self.inputs(index), self.outputs(index));
            super::check_count("trends of inputs", data.inputs(), inputs.len())?;
            super::check_count("trends of outputs", data.outputs(), outputs.len())?;
            index += 1;
            let change = |m: &Mat<f64>, lines| shifted(m.as_ref(), lines, e.start_s, data.sample_time_s(), sign);
            let (inputs, outputs) = (change(&e.inputs, inputs), change(&e.outputs, outputs));
            Ok(Experiment { name: e.name.clone(), start_s: e.start_s, inputs, outputs })
        })
    }
}

fn of_experiment(lines: &[Vec<Line>], experiment: usize) -> &[Line] {
    let index = if lines.len() == 1 { 0 } else { experiment };
    lines.get(index).map_or(&[], Vec::as_slice)
}

fn shifted(m: MatRef<'_, f64>, lines: &[Line], start_s: f64, sample_time_s: f64, sign: f64) -> Mat<f64> {
    Mat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] + sign * lines[j].at(start_s + i as f64 * sample_time_s))
}

/// The trend of one channel over stretches that each start at an instant.
fn line<'a>(
    parts: impl Iterator<Item = (f64, &'a [f64])> + Clone,
    sample_time_s: f64,
    shape: TrendShape,
) -> Result<Line, IdentError> {
    let known = || {
        parts.clone().flat_map(|(start_s, x)| {
            let timed = x.iter().enumerate().map(move |(i, v)| (start_s + i as f64 * sample_time_s, *v));
            timed.filter(|(_, v)| !v.is_nan())
        })
    };
    let count = known().count();
    let parameters = if shape == TrendShape::Line { 2 } else { 1 };
    if count < parameters {
        return Err(IdentError::TooFewSamples { samples: count, parameters });
    }
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / count as f64;
    // Twice, so that a large offset does not cost the digits of what is around it.
    let rough = mean(&mut known().map(|(_, v)| v));
    let level = rough + mean(&mut known().map(|(_, v)| v - rough));
    if shape == TrendShape::Mean {
        return Ok(Line::level(level));
    }
    let at_s = mean(&mut known().map(|(t, _)| t));
    let spread: f64 = known().map(|(t, _)| (t - at_s).powi(2)).sum();
    if spread <= 0.0 {
        return Err(IdentError::TooFewSamples { samples: 1, parameters });
    }
    let slope_per_s = known().map(|(t, v)| (t - at_s) * (v - level)).sum::<f64>() / spread;
    Ok(Line { level, slope_per_s, at_s })
}
