//! Data of one output of one experiment for the search.

use crate::data::band_limited::Ground;
use crate::{Dataset, IdentError};
use fitting::{Count, StructureError};

/// Where the rows that count begin, and what the inputs are before the record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Beginning {
    /// The first row that counts.
    pub(crate) first: usize,
    /// True if inputs before the record have their values at its first sample; otherwise they are zero.
    pub(crate) is_held: bool,
    /// True if the outputs refute that, and no estimate can do without it.
    pub(crate) is_refuted: bool,
}

/// An input over one record.
#[derive(Debug, Clone)]
pub(crate) struct Course<'a> {
    /// One column of samples, or the coefficients of its course between them.
    pub(crate) columns: Vec<&'a [f64]>,
    /// Value before the record.
    pub(crate) before: f64,
}

/// Inputs and one output of one experiment.
#[derive(Debug, Clone)]
pub(crate) struct Record<'a> {
    pub(crate) inputs: Vec<Course<'a>>,
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

    /// At most so many samples: of all stretches that long, the one in which the inputs vary most where the output is
    /// measured. A rest says nothing of the dynamics, however long it is.
    pub(crate) fn liveliest(&self, most: usize) -> Record<'a> {
        let begin = if self.output.len() > self.first + most { self.begin_of_liveliest(most) } else { self.first };
        let end = self.output.len().min(begin + most);
        let cut = |u: &Course<'a>| Course { columns: u.columns.iter().map(|column| &column[..end]).collect(), ..*u };
        Record { inputs: self.inputs.iter().map(cut).collect(), output: &self.output[..end], first: begin }
    }

    /// The first stretch of `length` samples whose sum of the inputs' variances, each over that of the record, is
    /// largest.
    fn begin_of_liveliest(&self, length: usize) -> usize {
        let running: Vec<Vec<[f64; 3]>> = self.inputs.iter().map(|u| self.running_sums(u.columns[0])).collect();
        let scatter = |sums: &[[f64; 3]], from: usize, to: usize| {
            let [count, sum, squares] = [0, 1, 2].map(|k| sums[to][k] - sums[from][k]);
            if count > 0.0 { squares - sum * sum / count } else { 0.0 }
        };
        let all = self.output.len() - self.first;
        let liveliness = |from: usize| {
            let part = |sums: &Vec<[f64; 3]>| {
                let whole = scatter(sums, 0, all);
                if whole > 0.0 { scatter(sums, from, from + length) / whole } else { 0.0 }
            };
            running.iter().map(part).sum::<f64>()
        };
        let (mut best, mut most) = (0, f64::NEG_INFINITY);
        for from in 0..=all - length {
            let found = liveliness(from);
            // Later stretches that are as lively but for rounding do not count.
            if found > most + 1e-9 {
                (best, most) = (from, found);
            }
        }
        self.first + best
    }

    /// Numbers, sums and sums of squares about the mean of an input before each sample, where the output is measured.
    fn running_sums(&self, u: &[f64]) -> Vec<[f64; 3]> {
        let counted = || u.iter().zip(self.output).skip(self.first);
        let mean = counted().map(|(u, _)| u).sum::<f64>() / (u.len() - self.first).max(1) as f64;
        let mut sums = [0.0; 3];
        let add = |(u, y): (&f64, &f64)| {
            if !y.is_nan() {
                let v = u - mean;
                sums = [sums[0] + 1.0, sums[1] + v, sums[2] + v * v];
            }
            sums
        };
        std::iter::once([0.0; 3]).chain(counted().map(add).collect::<Vec<_>>()).collect()
    }
}

/// Stretches of the records in which the inputs vary most, at most so many samples together.
pub(crate) fn liveliest<'a>(records: &[Record<'a>], most: usize) -> Vec<Record<'a>> {
    let each = (most / records.len().max(1)).max(200);
    records.iter().map(|r| r.liveliest(each)).collect()
}

/// The records of one output.
///
/// # Errors
/// No input; a missing sample or no variation in an input.
pub(crate) fn records<'a>(
    ground: &'a Ground<'_>,
    output: usize,
    beginning: Beginning,
) -> Result<Vec<Record<'a>>, IdentError> {
    let inputs = ground.plain.inputs();
    if inputs == 0 {
        return Err(StructureError::inputs("a transfer function", Count::AtLeast(1), 0).into());
    }
    for k in 0..inputs {
        check_input(ground.plain, k)?;
    }
    let Beginning { first, is_held, .. } = beginning;
    let course = |e: &'a crate::Experiment, k: usize| {
        let columns: Vec<&'a [f64]> = (0..ground.width).map(|j| e.input(ground.width * k + j)).collect();
        let before = if is_held { columns[0][0] } else { 0.0 };
        Course { columns, before }
    };
    let chosen = ground.data.experiments().iter().filter(|e| e.len() > first);
    Ok(chosen
        .map(|e| Record { inputs: (0..inputs).map(|k| course(e, k)).collect(), output: e.output(output), first })
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
