//! How residuals change with the parameters and the initial states of the model they are of.

use faer::Mat;
use lti::Innovations;
use numerics::parallel;
use numerics::vector::norm;

use super::tangent::Tangent;
use crate::dense::covariance_root::root_beyond_rounding;
use crate::fit::on_data::OnData;
use crate::prediction::{InitialState, Response, residuals};
use crate::{Dataset, Experiment, Fit, IdentError, Intersample, LinearModel, Parametric};

/// Parts of a standard deviation by which parameters are moved: the next where there is no model at the one before.
const STEPS: [f64; 4] = [1e-3, 1e-5, 1e-7, 1e-9];
/// Sensitivities below this part of the largest are nothing but rounding.
const ROUNDING: f64 = 1e-4;
/// Directions that go through a record side by side, as a task of its own.
const SIDE_BY_SIDE: usize = 8;
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

/// The change of the errors along each direction in which the parameters are uncertain, a standard deviation far, up to
/// what the initial states do where these are estimated.
///
/// # Errors
/// [`IdentError::NotFinite`] where there is no model however near to the estimate.
pub(super) fn to_parameters<M: Parametric + LinearModel>(
    fit: &Fit<M>,
    data: &Dataset,
    initial: &InitialState,
    predicted: &Response,
) -> Result<Vec<Vec<f64>>, IdentError> {
    let (root, theta) = (root_beyond_rounding(&fit.covariance)?, fit.parameters());
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
    let first: Vec<Option<M>> = (0..root.ncols()).map(|k| moved(k, STEPS[0])).collect();
    let mut columns = side_by_side(&fit.model, &first, data, &predicted.initial_states)?;
    let errors = Stack::column(&predicted.outputs);
    for h in STEPS {
        let pending: Vec<usize> = (0..columns.len()).filter(|k| columns[*k].is_none()).collect();
        let models: Vec<Option<M>> = pending.iter().map(|k| moved(*k, h)).collect();
        let change = |model: &Option<M>| {
            let found = Stack::column(&residuals(model.as_ref()?, data, initial).ok()?.outputs);
            Some(found.iter().zip(&errors).map(|(f, e)| (f - e) / h).collect::<Vec<_>>())
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

/// Returns true if a predictor on these data has one gain throughout, and inputs at the samples alone: no output is
/// missing, and no input is followed between the samples.
fn keeps_its_gain(data: &Dataset) -> bool {
    let is_whole = |e: &Experiment| (0..data.outputs()).all(|i| e.output(i).iter().all(|v| !v.is_nan()));
    data.intersample() != Intersample::BandLimited && data.experiments().iter().all(is_whole)
}

/// [`to_states`] where the gain stays, all entries at once.
fn to_states_side_by_side(form: &Innovations, data: &Dataset) -> Vec<Mat<f64>> {
    let (tangent, n) = (Tangent::of_states(form), form.system().states());
    let (mut tables, mut is_finite) = (Vec::new(), vec![true; n]);
    for experiment in data.experiments() {
        let mut columns = vec![vec![0.0; experiment.len() * data.outputs()]; n];
        let mut rows: Vec<&mut [f64]> = columns.iter_mut().map(Vec::as_mut_slice).collect();
        let finite = tangent.errors(experiment, &vec![0.0; n], &mut rows);
        is_finite.iter_mut().zip(finite).for_each(|(all, one)| *all &= one);
        tables.push(columns);
    }
    let kept: Vec<usize> = (0..n).filter(|k| is_finite[*k]).collect();
    let table = |columns: Vec<Vec<f64>>, experiment: &Experiment| {
        Mat::from_fn(experiment.len() * data.outputs(), kept.len(), |i, k| columns[kept[k]][i])
    };
    tables.into_iter().zip(data.experiments()).map(|(columns, experiment)| table(columns, experiment)).collect()
}

/// The change of the errors along the directions of which a model is moved by the first of [`STEPS`]; `None` for those
/// that change the size of its form, as a delay may, and for all where the predictor has not one gain throughout.
fn side_by_side<M: LinearModel>(
    model: &M,
    moved: &[Option<M>],
    data: &Dataset,
    initial_states: &[Vec<f64>],
) -> Result<Vec<Option<Vec<f64>>>, IdentError> {
    let mut columns = vec![None; moved.len()];
    if !keeps_its_gain(data) {
        return Ok(columns);
    }
    let form_of = |model: &M| model.innovations(data.sample_time_s(), data.intersample());
    let form = form_of(model)?;
    let states = form.system().states();
    let forms: Vec<(usize, Innovations)> = (moved.iter().enumerate())
        .filter_map(|(k, model)| Some((k, form_of(model.as_ref()?).ok()?)))
        .filter(|(_, moved)| moved.system().states() == states)
        .collect();
    let stack = Stack::new(data.experiments().iter().map(Experiment::len).collect(), data.outputs());
    let shares: Vec<_> = forms.chunks(SIDE_BY_SIDE).collect();
    let found = parallel::map(&shares, |share| -> Vec<Option<Vec<f64>>> {
        let tangent = Tangent::new(&form, &share.iter().map(|(_, form)| form).collect::<Vec<_>>(), STEPS[0]);
        let mut columns = vec![vec![0.0; stack.rows()]; share.len()];
        let mut is_finite = vec![true; share.len()];
        for (m, (experiment, x0)) in data.experiments().iter().zip(initial_states).enumerate() {
            let mut rows: Vec<&mut [f64]> = columns.iter_mut().map(|c| &mut c[stack.rows_of(m)]).collect();
            is_finite.iter_mut().zip(tangent.errors(experiment, x0, &mut rows)).for_each(|(all, one)| *all &= one);
        }
        columns.into_iter().zip(is_finite).map(|(column, is_finite)| is_finite.then_some(column)).collect()
    });
    for (share, found) in shares.iter().zip(found) {
        share.iter().zip(found).for_each(|((k, _), column)| columns[*k] = column);
    }
    Ok(columns)
}

/// The errors that the entries of each experiment's initial state leave: the rows of the experiment in the stack ×
/// entries, a table an experiment. No tables where they are not estimated, and none where they would take so much
/// memory that the regions had better be a little too wide.
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
    if keeps_its_gain(data) {
        let form = model.innovations(data.sample_time_s(), data.intersample())?;
        return Ok(to_states_side_by_side(&form, data));
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use faer::{Mat, mat};
    use lti::{Innovations, PolynomialEquation, PolynomialModel, StateSpace};
    use signal::excitation::Random;

    use super::{STEPS, Stack, side_by_side, to_states};
    use crate::prediction::{InitialState, residuals};
    use crate::{Dataset, LinearModel, Parametric, RationalChannel, StateSpaceModel, TransferFunctionModel};

    /// Length of a direction: so small that what is not linear in it leaves no trace.
    const SMALL: f64 = 1e-4;

    fn data(inputs: usize, outputs: usize) -> Dataset {
        let mut random = Random::new(9);
        let mut table = |columns: usize| Mat::from_fn(80, columns, |_, _| random.normal());
        let (one, other) = (table(inputs), table(outputs));
        let first = Dataset::new(0.1, one, other).unwrap();
        let second = Dataset::new(0.1, table(inputs), table(outputs)).unwrap();
        first.merge(&second).unwrap()
    }

    /// The change of residuals between two models that are near each other, on both sides.
    fn difference<M: LinearModel + Parametric>(model: &M, data: &Dataset, k: usize) -> Vec<f64> {
        let theta = model.parameters();
        let step = 1e-5;
        let at = |by: f64| {
            let moved: Vec<f64> = theta.iter().enumerate().map(|(i, v)| if i == k { v + by } else { *v }).collect();
            let moved = model.with_parameters(&moved).unwrap();
            Stack::column(&residuals(&moved, data, &InitialState::Zero).unwrap().outputs)
        };
        at(step).iter().zip(at(-step)).map(|(above, below)| (above - below) / (2.0 * step)).collect()
    }

    fn equal_differences<M: LinearModel + Parametric>(model: &M, data: &Dataset) {
        let theta = model.parameters();
        let by = SMALL * STEPS[0];
        let moved = |k: usize| {
            let moved: Vec<f64> = theta.iter().enumerate().map(|(i, v)| if i == k { v + by } else { *v }).collect();
            Some(model.with_parameters(&moved).unwrap())
        };
        let moved: Vec<Option<M>> = (0..theta.len()).map(moved).collect();
        let states = model.innovations(0.1, data.intersample()).unwrap().system().states();
        let found = side_by_side(model, &moved, data, &vec![vec![0.0; states]; 2]).unwrap();
        for (k, column) in found.iter().enumerate() {
            let expected = difference(model, data, k);
            let size = expected.iter().map(|v| v.abs()).fold(1e-3, f64::max);
            for (found, expected) in column.as_ref().unwrap().iter().zip(&expected) {
                let found = found / SMALL;
                assert!((found - expected).abs() < 1e-4 * size, "{k}: {found} {expected}");
            }
        }
    }

    #[test]
    fn prop_changes_side_by_side_equal_differences_of_residuals() {
        let equation = PolynomialEquation {
            a: vec![vec![-0.3]],
            b: vec![vec![1.0, 0.5], vec![-0.3]],
            nk: vec![1, 3],
            c: vec![0.4],
            d: vec![-0.6],
            f: vec![vec![-1.5, 0.7], vec![-0.4]],
        };
        let polynomial = PolynomialModel::new(0.1, vec![equation], Mat::full(1, 1, 1.0)).unwrap();
        equal_differences(&polynomial, &data(2, 1));
        let channel = RationalChannel::new(vec![3.0, 2.0], vec![1.2, 4.0], 0.27).unwrap();
        equal_differences(&TransferFunctionModel::new(vec![channel], 1, Mat::identity(1, 1)).unwrap(), &data(1, 1));
        let a = mat![[0.8, 0.4, 0.0], [-0.4, 0.8, 0.1], [0.0, 0.0, 0.5]];
        let c = mat![[1.0, 0.0, 0.4], [0.2, 0.8, 0.0]];
        let system = StateSpace::discrete(a, mat![[1.0], [0.5], [0.7]], c, mat![[0.1], [0.2]], 0.1).unwrap();
        let k = mat![[0.4, 0.1], [0.0, 0.5], [0.2, 0.0]];
        let innovations = Innovations::new(system, k, mat![[1.0, 0.3], [0.3, 0.5]]).unwrap();
        equal_differences(&StateSpaceModel::new(innovations, true, true), &data(1, 2));
    }

    #[test]
    fn prop_changes_by_the_first_state_are_its_free_response() {
        let a = mat![[0.8, 0.4, 0.0], [-0.4, 0.8, 0.1], [0.0, 0.0, 0.5]];
        let system =
            StateSpace::discrete(a, mat![[1.0], [0.5], [0.7]], mat![[1.0, 0.0, 0.4]], mat![[0.0]], 0.1).unwrap();
        let model = Innovations::new(system, mat![[0.4], [0.0], [0.2]], Mat::full(1, 1, 1.0)).unwrap();
        let (data, zero) = (data(1, 1), vec![0.0; 3]);
        let found = to_states(&model, &data, &InitialState::Estimated).unwrap();
        let of = |x0: &[f64]| residuals(&model, &data, &InitialState::Given(vec![x0.to_vec(); 2])).unwrap().outputs;
        let at_rest = of(&zero);
        for k in 0..3 {
            let mut unit = zero.clone();
            unit[k] = 1.0;
            for (m, moved) in of(&unit).iter().enumerate() {
                let expected = moved - &at_rest[m];
                let difference = (0..80).map(|t| (found[m][(t, k)] - expected[(t, 0)]).abs()).fold(0.0, f64::max);
                assert!(difference < 1e-12, "{k}: {difference}");
            }
        }
    }
}
