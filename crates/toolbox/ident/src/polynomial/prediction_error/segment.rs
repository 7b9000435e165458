//! Stretches of data without a break.

use std::borrow::Cow;

use crate::{Dataset, Experiment};

/// A stretch of one experiment with every input known, and one of the outputs.
#[derive(Debug, Clone)]
pub(super) struct Segment<'a> {
    pub(super) inputs: Vec<Cow<'a, [f64]>>,
    pub(super) output: Cow<'a, [f64]>,
    /// Rows whose output is missing; it is zero there.
    pub(super) missing: Vec<usize>,
    /// Response to an impulse at its first row, of the same length: the impulse response of the filter that inputs and
    /// output went through from there on, if they did. The initial state acts through it.
    pub(super) impulse: Option<Cow<'a, [f64]>>,
    /// Which experiment it is of.
    pub(super) experiment: usize,
    /// Its first row in the experiment.
    pub(super) first: usize,
}

impl Segment<'_> {
    pub(super) fn len(&self) -> usize {
        self.output.len()
    }

    /// Rows with a known output.
    pub(super) fn known(&self) -> usize {
        self.len() - self.missing.len()
    }

    /// The missing rows from `first` on, `rows` of them.
    pub(super) fn missing_in(&self, first: usize, rows: usize) -> &[usize] {
        let start = self.missing.partition_point(|t| *t < first);
        let end = self.missing.partition_point(|t| *t < first + rows);
        &self.missing[start..end]
    }

    /// The part of this length from `first` on.
    pub(super) fn part(&self, first: usize, rows: usize) -> Segment<'_> {
        Segment {
            inputs: self.inputs.iter().map(|u| Cow::Borrowed(&u[first..first + rows])).collect(),
            output: Cow::Borrowed(&self.output[first..first + rows]),
            missing: self.missing_in(first, rows).iter().map(|t| t - first).collect(),
            // Later on the filter has run in.
            impulse: self.impulse.as_ref().filter(|_| first == 0).map(|l| Cow::Borrowed(&l[..rows])),
            experiment: self.experiment,
            first: self.first + first,
        }
    }
}

/// Cuts the data of one output where an input is missing and, unless `skip_outputs`, where the output is.
pub(super) fn segments(data: &Dataset, output: usize, skip_outputs: bool) -> Vec<Segment<'_>> {
    let mut all = Vec::new();
    for (index, experiment) in data.experiments().iter().enumerate() {
        let y = experiment.output(output);
        let usable = |t: usize| inputs_known(experiment, t) && (skip_outputs || !y[t].is_nan());
        let mut first = 0;
        while first < y.len() {
            let end = (first..y.len()).find(|t| !usable(*t)).unwrap_or(y.len());
            if end > first {
                all.push(segment(experiment, index, output, first..end));
            }
            first = (end..y.len()).find(|t| usable(*t)).unwrap_or(y.len());
        }
    }
    all
}

fn inputs_known(experiment: &Experiment, t: usize) -> bool {
    (0..experiment.inputs.ncols()).all(|k| !experiment.inputs[(t, k)].is_nan())
}

fn segment(experiment: &Experiment, index: usize, output: usize, rows: std::ops::Range<usize>) -> Segment<'_> {
    let y = &experiment.output(output)[rows.clone()];
    let missing: Vec<usize> = (0..y.len()).filter(|t| y[*t].is_nan()).collect();
    let filled = if missing.is_empty() {
        Cow::Borrowed(y)
    } else {
        Cow::Owned(y.iter().map(|v| if v.is_nan() { 0.0 } else { *v }).collect())
    };
    Segment {
        inputs: (0..experiment.inputs.ncols()).map(|k| Cow::Borrowed(&experiment.input(k)[rows.clone()])).collect(),
        output: filled,
        missing,
        impulse: None,
        experiment: index,
        first: rows.start,
    }
}
