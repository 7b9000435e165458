//! What one output of one experiment gives to the search.

use crate::band_limited::Ground;
use crate::structure_error::{Count, StructureError};
use crate::{Dataset, IdentError};

/// Inputs and one output of one experiment, from the first sample on at which every delayed input is known.
#[derive(Debug, Clone)]
pub(crate) struct Record<'a> {
    /// Each as one column of samples, or as the coefficients of its course.
    pub(crate) inputs: Vec<Vec<&'a [f64]>>,
    pub(crate) output: &'a [f64],
    pub(crate) first: usize,
}

impl<'a> Record<'a> {
    /// Samples of the output that are there, from the first on.
    pub(crate) fn rows(&self) -> usize {
        self.output.iter().skip(self.first).filter(|y| !y.is_nan()).count()
    }

    /// Sum of squares of the output from the first sample on.
    pub(crate) fn energy(&self) -> f64 {
        self.output.iter().skip(self.first).filter(|y| !y.is_nan()).map(|y| y * y).sum()
    }

    /// Keeps of a series that starts at the first sample what stands where the output is there.
    pub(crate) fn keep(&self, series: &mut Vec<f64>) {
        let mut measured = self.output.iter().skip(self.first);
        series.retain(|_| measured.next().is_some_and(|y| !y.is_nan()));
    }

    /// At most so many samples from the start.
    pub(crate) fn shortened(&self, most: usize) -> Record<'a> {
        let end = self.output.len().min(self.first + most);
        let inputs = self.inputs.iter().map(|u| u.iter().map(|column| &column[..end]).collect()).collect();
        Record { inputs, output: &self.output[..end], first: self.first }
    }
}

/// The records of one output, each from sample `first` on.
///
/// # Errors
/// No input; a missing sample or no variation in an input.
pub(crate) fn records<'a>(ground: &'a Ground<'_>, output: usize, first: usize) -> Result<Vec<Record<'a>>, IdentError> {
    let inputs = ground.plain.inputs();
    if inputs == 0 {
        return Err(StructureError::inputs("a transfer function", Count::AtLeast(1), 0).into());
    }
    for k in 0..inputs {
        check_input(ground.plain, k)?;
    }
    let columns = |e: &'a crate::Experiment, k: usize| -> Vec<&'a [f64]> {
        (0..ground.width).map(|j| e.input(ground.width * k + j)).collect()
    };
    let chosen = ground.data.experiments().iter().filter(|e| e.len() > first);
    Ok(chosen
        .map(|e| Record { inputs: (0..inputs).map(|k| columns(e, k)).collect(), output: e.output(output), first })
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
