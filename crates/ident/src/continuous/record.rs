//! What one output of one experiment gives to the search.

use crate::{Dataset, IdentError};

/// Inputs and one output of one experiment, from the first sample on at which every delayed input is known.
#[derive(Debug, Clone)]
pub(crate) struct Record<'a> {
    pub(crate) inputs: Vec<&'a [f64]>,
    pub(crate) output: &'a [f64],
    pub(crate) first: usize,
}

impl<'a> Record<'a> {
    /// Samples of the output that are there, from the first on.
    pub(crate) fn rows(&self) -> usize {
        self.output.iter().skip(self.first).filter(|y| !y.is_nan()).count()
    }

    /// Keeps of a series that starts at the first sample what stands where the output is there.
    pub(crate) fn keep(&self, series: &mut Vec<f64>) {
        let mut measured = self.output.iter().skip(self.first);
        series.retain(|_| measured.next().is_some_and(|y| !y.is_nan()));
    }

    /// At most so many samples from the start.
    pub(crate) fn shortened(&self, most: usize) -> Record<'a> {
        let end = self.output.len().min(self.first + most);
        let inputs = self.inputs.iter().map(|u| &u[..end]).collect();
        Record { inputs, output: &self.output[..end], first: self.first }
    }
}

/// The records of one output, each from sample `first` on.
///
/// # Errors
/// No input; a missing sample or no variation in an input.
pub(crate) fn records(data: &Dataset, output: usize, first: usize) -> Result<Vec<Record<'_>>, IdentError> {
    if data.inputs() == 0 {
        return Err(IdentError::Structure { what: "a transfer function needs an input; model a time series as noise" });
    }
    for k in 0..data.inputs() {
        check_input(data, k)?;
    }
    let record = |e: &'_ crate::Experiment| e.len() > first;
    let chosen = data.experiments().iter().filter(|e| record(e));
    Ok(chosen
        .map(|e| Record { inputs: (0..data.inputs()).map(|k| e.input(k)).collect(), output: e.output(output), first })
        .collect())
}

fn check_input(data: &Dataset, k: usize) -> Result<(), IdentError> {
    let mut all_constant = true;
    for e in data.experiments() {
        let u = e.input(k);
        if let Some(index) = u.iter().position(|v| v.is_nan()) {
            return Err(IdentError::Missing { what: "an input", index });
        }
        all_constant &= u.iter().all(|v| *v == u[0]);
    }
    if all_constant { Err(IdentError::Constant { what: "an input" }) } else { Ok(()) }
}
