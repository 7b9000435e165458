//! How residuals change with the parameters and the initial states of the model they are of.

use faer::Mat;
use numerics::parallel;
use numerics::vector::norm;

use crate::covariance_root::root;
use crate::on_data::OnData;
use crate::prediction::{InitialState, residuals};
use crate::{Dataset, Experiment, Fit, IdentError, LinearModel, Parametric};

/// Parts of a standard deviation by which parameters are moved: the next where there is no model at the one before.
const STEPS: [f64; 4] = [1e-3, 1e-5, 1e-7, 1e-9];
/// Sensitivities below this part of the largest are nothing but rounding.
const ROUNDING: f64 = 1e-4;
/// States by which a model may grow as its parameters are moved.
const FURTHER_STATES: usize = 100;
/// Most numbers that the sensitivities to initial states may take.
const MOST: usize = 30_000_000;

/// Where the samples of every experiment and output lie in one column: output by output within an experiment.
#[derive(Debug, Clone)]
pub(super) struct Stack {
    lengths: Vec<usize>,
    /// Where each experiment begins.
    firsts: Vec<usize>,
    outputs: usize,
}

impl Stack {
    pub(super) fn new(lengths: Vec<usize>, outputs: usize) -> Self {
        let begin = |first: &mut usize, length: &usize| Some(std::mem::replace(first, *first + outputs * length));
        let firsts = lengths.iter().scan(0, begin).collect();
        Stack { lengths, firsts, outputs }
    }

    pub(super) fn lengths(&self) -> &[usize] {
        &self.lengths
    }

    pub(super) fn outputs(&self) -> usize {
        self.outputs
    }

    pub(super) fn rows(&self) -> usize {
        self.outputs * self.lengths.iter().sum::<usize>()
    }

    /// Where the samples of one output of one experiment lie.
    pub(super) fn range(&self, experiment: usize, output: usize) -> std::ops::Range<usize> {
        let first = self.firsts[experiment] + output * self.lengths[experiment];
        first..first + self.lengths[experiment]
    }

    /// Where an experiment lies.
    pub(super) fn rows_of(&self, experiment: usize) -> std::ops::Range<usize> {
        let first = self.range(experiment, 0).start;
        first..first + self.outputs * self.lengths[experiment]
    }

    /// One output of every experiment.
    pub(super) fn series<'a>(&self, column: &'a [f64], output: usize) -> Vec<&'a [f64]> {
        (0..self.lengths.len()).map(|m| &column[self.range(m, output)]).collect()
    }

    /// A column that holds one output alone.
    pub(super) fn alone(&self, column: &[f64], output: usize) -> Vec<f64> {
        self.series(column, output).concat()
    }

    /// One table an experiment, samples × outputs, as a column; zero for what is missing.
    pub(super) fn column(tables: &[Mat<f64>]) -> Vec<f64> {
        let of = |m: &Mat<f64>| (0..m.ncols()).flat_map(|i| m.col_as_slice(i).to_vec()).collect::<Vec<_>>();
        tables.iter().flat_map(of).map(|v| if v.is_nan() { 0.0 } else { v }).collect()
    }
}

/// The change of the errors along each direction in which the parameters are uncertain, a standard deviation far. Initial
/// states that are estimated follow the parameters.
///
/// # Errors
/// [`IdentError::NotFinite`] where there is no model however near to the estimate.
pub(super) fn to_parameters<M: Parametric + LinearModel>(
    fit: &Fit<M>,
    data: &Dataset,
    initial: &InitialState,
    errors: &[f64],
) -> Result<Vec<Vec<f64>>, IdentError> {
    let (root, theta) = (root(&fit.covariance)?, fit.parameters());
    if theta.len() != root.nrows() {
        return Err(IdentError::Length { what: "the covariance", expected: theta.len(), found: root.nrows() });
    }
    let states = |model: &M| Ok::<_, IdentError>(OnData::new(model, data, false)?.form.system().states());
    let most = states(&fit.model)? + FURTHER_STATES;
    // A delay that is hardly known would become a model of thousands of states.
    let moved = |k: usize, h: f64| -> Option<M> {
        let moved: Vec<f64> = theta.iter().enumerate().map(|(i, v)| v + h * root[(i, k)]).collect();
        fit.model.with_parameters(&moved).ok().filter(|model| states(model).is_ok_and(|states| states <= most))
    };
    let mut columns: Vec<Option<Vec<f64>>> = vec![None; root.ncols()];
    for h in STEPS {
        let pending: Vec<usize> = (0..columns.len()).filter(|k| columns[*k].is_none()).collect();
        let models: Vec<Option<M>> = pending.iter().map(|k| moved(*k, h)).collect();
        let change = |model: &Option<M>| {
            let found = Stack::column(&residuals(model.as_ref()?, data, initial).ok()?.outputs);
            Some(found.iter().zip(errors).map(|(f, e)| (f - e) / h).collect::<Vec<_>>())
        };
        for (k, found) in pending.into_iter().zip(parallel::map(&models, change)) {
            columns[k] = found;
        }
    }
    if let Some(index) = columns.iter().position(Option::is_none) {
        return Err(IdentError::NotFinite { what: "the sensitivity to a parameter", index });
    }
    let mut columns: Vec<Vec<f64>> = columns.into_iter().flatten().collect();
    let largest = columns.iter().map(|column| norm(column)).fold(0.0, f64::max);
    columns.retain(|column| norm(column) > ROUNDING * largest);
    Ok(columns)
}

/// The errors that the entries of each experiment's initial state leave: the rows of the experiment in the stack × entries,
/// a table an experiment. No tables where they are not estimated, and none where they would take so much memory that the
/// regions had better be a little too wide.
///
/// # Errors
/// Those of the model's innovations form.
pub(super) fn to_states<M: LinearModel + ?Sized>(
    model: &M,
    data: &Dataset,
    initial: &InitialState,
) -> Result<Vec<Mat<f64>>, IdentError> {
    let (n, count) = (OnData::new(model, data, false)?.form.system().states(), data.experiments().len());
    let numbers = n.saturating_mul(data.samples() * data.outputs());
    if *initial != InitialState::Estimated || numbers > MOST {
        return Ok(Vec::new());
    }
    let silent = data.map_experiments(|e| {
        let outputs = Mat::from_fn(e.len(), e.outputs.ncols(), |t, i| 0.0 * e.outputs[(t, i)]);
        Ok(Experiment { inputs: Mat::zeros(e.inputs.nrows(), e.inputs.ncols()), outputs, ..e.clone() })
    })?;
    let mut entries = Vec::with_capacity(n);
    for j in 0..n {
        let unit: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == j))).collect();
        // What grows without bound is not among the states that are told apart.
        if let Ok(response) = residuals(model, &silent, &InitialState::Given(vec![unit; count])) {
            entries.push(response.outputs);
        }
    }
    let table = |m: usize| {
        let columns: Vec<Vec<f64>> = entries.iter().map(|e| Stack::column(&e[m..=m])).collect();
        // Of a model without states all rows are there all the same.
        let rows = data.experiments()[m].len() * data.outputs();
        Mat::from_fn(rows, columns.len(), |i, k| columns[k][i])
    };
    Ok((0..count).map(table).collect())
}
