//! The initial state that goes with an estimate.

use faer::Mat;
use lti::Simulator;
use numerics::linalg;

use super::channel::ContinuousChannel;
use super::model::ContinuousModel;
use super::output_error::Nuisance;
use crate::fit::on_data::OnData;
use crate::{Dataset, Experiment, IdentError, Triangle};

/// Samples from which an initial state is found, at most.
const SAMPLES: usize = 20_000;

/// Directions of the state that are seen less than this part of the best seen are left as they are.
const UNSEEN: f64 = 1e-10;

/// The state of the innovations form at the first sample of each experiment, by least squares from the outputs; inputs
/// before the record and directions that the outputs do not show are taken as if the input had always been what it is
/// at first. A system at rest starts at zero.
pub(crate) fn initial_states<C: ContinuousChannel>(
    model: &ContinuousModel<C>,
    data: &Dataset,
    nuisance: Nuisance,
) -> Result<Vec<Vec<f64>>, IdentError> {
    let OnData { form, data, .. } = OnData::new(model, data, !nuisance.initial_state)?;
    let system = form.system();
    if !nuisance.initial_state {
        return Ok(vec![vec![0.0; system.states()]; data.experiments().len()]);
    }
    data.experiments().iter().map(|e| initial_state(system, e, nuisance.offset)).collect()
}

fn initial_state(system: &lti::StateSpace, data: &Experiment, offset: bool) -> Result<Vec<f64>, IdentError> {
    let (n, outputs) = (system.states(), system.outputs());
    let unknown = n + if offset { outputs } else { 0 };
    let rows = data.len().min(SAMPLES);
    let assumed = held(system, data);
    let mut simulator = Simulator::new(system, &assumed)?;
    let mut triangle = Triangle::new(unknown + 1);
    let (mut y, mut row) = (vec![0.0; outputs], vec![0.0; unknown + 1]);
    // C Aᵏ, advanced one sample a row.
    let mut seen = system.c().to_owned();
    for k in 0..rows {
        let u: Vec<f64> = (0..system.inputs()).map(|j| data.input(j)[k]).collect();
        simulator.output(&u, &mut y);
        for i in 0..outputs {
            let measured = data.output(i)[k];
            if measured.is_nan() {
                continue;
            }
            row.fill(0.0);
            (0..n).for_each(|j| row[j] = seen[(i, j)]);
            if offset {
                row[n + i] = 1.0;
            }
            row[unknown] = measured - y[i];
            triangle.push_row(&row);
        }
        simulator.advance(&u);
        seen = &seen * system.a();
    }
    let change = least_change(&triangle.finish(), unknown)?;
    Ok(assumed.iter().zip(&change).map(|(x, d)| x + d).collect())
}

/// States that are inputs of the past, at the input's first value; all others at zero.
fn held(system: &lti::StateSpace, data: &Experiment) -> Vec<f64> {
    let (n, a, b) = (system.states(), system.a(), system.b());
    let mut state = vec![0.0; n];
    let shifted = |i: usize, j: usize| a[(i, j)] == 1.0 && (0..n).all(|l| l == j || a[(i, l)] == 0.0);
    for i in 0..n {
        let from_input = (0..system.inputs()).find(|j| b[(i, *j)] == 1.0);
        if let Some(j) = from_input.filter(|_| (0..n).all(|l| a[(i, l)] == 0.0)) {
            state[i] = data.input(j).first().copied().unwrap_or(0.0);
        } else if i > 0 && shifted(i, i - 1) && (0..system.inputs()).all(|j| b[(i, j)] == 0.0) {
            state[i] = state[i - 1];
        }
    }
    state
}

/// The shortest solution of the least-squares problem in the factor of `[O | r]`, columns scaled to one.
fn least_change(factor: &Mat<f64>, unknown: usize) -> Result<Vec<f64>, IdentError> {
    let scale: Vec<f64> =
        (0..unknown).map(|j| factor.col(j).norm_l2()).map(|length| if length > 0.0 { length } else { 1.0 }).collect();
    let matrix = Mat::from_fn(unknown, unknown, |i, j| factor[(i, j)] / scale[j]);
    let right = factor.get(..unknown, unknown..unknown + 1);
    let solution = linalg::least_norm(matrix.as_ref(), right, UNSEEN)?;
    Ok((0..unknown).map(|j| solution[(j, 0)] / scale[j]).collect())
}
