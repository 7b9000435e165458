//! Application of a model to data: simulation, k-step prediction, residuals, and the initial state they start from.
//!
//! Every model is taken in innovations form, so all of it is written once. Band-limited inputs of a model in continuous
//! time are followed between the samples; within 32 samples of an end they rest on a mirrored record.

mod form;
mod gain;
mod initial;
mod stepper;

use faer::Mat;

use crate::data::check_missing;
use crate::fit::check_channels;
use crate::fit::on_data::OnData;
use crate::{Dataset, Experiment, IdentError, LinearModel};
use fitting::StructureError;
pub(crate) use form::Form;
pub(crate) use gain::Gain;
use stepper::Stepper;

/// The state at the first sample of each experiment.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum InitialState {
    /// Fitted to each experiment. Estimators fit it together with the model; otherwise it is by least squares: to the
    /// errors of the simulation for [`simulate`], to the one-step prediction errors, weighed by their covariance, for
    /// [`predict`] and [`residuals`]. Directions of the state that the data do not show stay zero.
    #[default]
    Estimated,
    /// At rest.
    Zero,
    /// One state an experiment, in the coordinates of the model's innovations form.
    Given(Vec<Vec<f64>>),
}

/// Outputs that a model gives for each experiment of a dataset.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// One table an experiment, samples × outputs.
    pub outputs: Vec<Mat<f64>>,
    /// The state each experiment started from.
    pub initial_states: Vec<Vec<f64>>,
}

/// Simulates a model on the inputs of `data`: `x(t+1) = A x(t) + B u(t)`, `ŷ(t) = C x(t) + D u(t)`, without any noise.
///
/// Measured outputs serve for an estimated initial state alone; missing ones are left out of it. A simulation of an
/// unstable model leaves every measurement sooner or later, however good its initial state.
///
/// # Errors
/// [`IdentError::Length`] where channels or given states do not fit; [`IdentError::MissingInput`];
/// [`IdentError::NotFinite`] where an unstable model overflows; those of the model's innovations form.
///
/// # Example
/// ```
/// use ident::prediction::{InitialState, simulate};
/// use lti::{PolynomialEquation, PolynomialModel};
/// let equation = PolynomialEquation { a: vec![vec![-0.5]], b: vec![vec![2.0]], ..Default::default() };
/// let model = PolynomialModel::siso(0.1, 1, equation)?;
/// let data = ident::Dataset::siso(0.1, &[1.0, 0.0, 0.0], &[0.0, 2.0, 1.0])?;
/// let simulated = simulate(&model, &data, &InitialState::Zero)?;
/// assert_eq!(simulated.outputs[0][(2, 0)], 1.0);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, §3.1 and (4.91).
pub fn simulate<M: LinearModel + ?Sized>(
    model: &M,
    data: &Dataset,
    initial: &InitialState,
) -> Result<Response, IdentError> {
    Ok(respond(model, data, initial, None)?.0)
}

/// Predicts each output from the outputs up to `horizon` samples earlier and the inputs up to the same sample:
/// `ŷ(t | t − k)`.
///
/// One step is the predictor of the innovations form, `x̂(t+1) = A x̂(t) + B u(t) + K (y(t) − ŷ(t | t−1))`,
/// `ŷ(t | t−1) = C x̂(t) + D u(t)`. With k steps the last k − 1 measurements are not used:
/// `ŷ(t | t−k) = ŷ(t | t−1) − Σ_{j=1}^{k−1} C A^{j−1} K e(t − j)`, with `e` the one-step errors. Before the `k`-th
/// sample the prediction starts from the initial state.
///
/// At a missing output the predictor coasts and goes on with the gain of the time-varying Kalman filter until the state
/// is known again, so that a gap costs no more than it must.
///
/// # Errors
/// [`IdentError::Structure`] for a horizon of zero; else those of [`simulate`].
///
/// # Source
/// Ljung 1999, §3.2 (k-step-ahead prediction) and (4.91).
pub fn predict<M: LinearModel + ?Sized>(
    model: &M,
    data: &Dataset,
    horizon: usize,
    initial: &InitialState,
) -> Result<Response, IdentError> {
    if horizon == 0 {
        return Err(StructureError::TooFew { what: "samples of the horizon", found: 0, least: 1 }.into());
    }
    Ok(respond(model, data, initial, Some(horizon))?.0)
}

/// The one-step prediction errors `ε(t) = y(t) − ŷ(t | t−1)`, samples × outputs for each experiment, NaN where the
/// output is missing, and near the ends of an experiment where a model in continuous time would rest on a guess of
/// band-limited inputs beyond it.
///
/// # Errors
/// Those of [`simulate`].
pub fn residuals<M: LinearModel + ?Sized>(
    model: &M,
    data: &Dataset,
    initial: &InitialState,
) -> Result<Response, IdentError> {
    let (mut response, (first, last)) = respond(model, data, initial, Some(1))?;
    for (predicted, experiment) in response.outputs.iter_mut().zip(data.experiments()) {
        let known = first..experiment.len().saturating_sub(last);
        let error = |t: usize, i: usize| experiment.outputs[(t, i)] - predicted[(t, i)];
        *predicted =
            Mat::from_fn(
                experiment.len(),
                predicted.ncols(),
                |t, i| {
                    if known.contains(&t) { error(t, i) } else { f64::NAN }
                },
            );
    }
    Ok(response)
}

/// The responses of every experiment, and how many rows at its ends rest on a guess of inputs beyond it; no horizon is
/// simulation.
fn respond<M: LinearModel + ?Sized>(
    model: &M,
    data: &Dataset,
    initial: &InitialState,
    horizon: Option<usize>,
) -> Result<(Response, (usize, usize)), IdentError> {
    check_channels(model, data)?;
    check_missing(data)?;
    let OnData { form, data, edges } = OnData::new(model, data, *initial == InitialState::Zero)?;
    let form = Form::new(form);
    let initial_states = match initial {
        InitialState::Zero => vec![vec![0.0; form.states]; data.experiments().len()],
        InitialState::Given(states) => checked_states(states, &form, &data)?,
        InitialState::Estimated => {
            let estimate = |e: &Experiment| initial::estimate(&form, e, horizon.is_some());
            data.experiments().iter().map(estimate).collect::<Result<_, _>>()?
        }
    };
    let run = |(experiment, x0): (&Experiment, &Vec<f64>)| match horizon {
        None => simulated(&form, experiment, x0),
        Some(steps) => predicted(&form, experiment, x0, steps),
    };
    let outputs = data.experiments().iter().zip(&initial_states).map(run).collect::<Result<_, _>>()?;
    Ok((Response { outputs, initial_states }, edges))
}

fn checked_states(states: &[Vec<f64>], form: &Form, data: &Dataset) -> Result<Vec<Vec<f64>>, IdentError> {
    let check = |what, expected, found| {
        if expected == found { Ok(()) } else { Err(IdentError::Length { what, expected, found }) }
    };
    check("initial states", data.experiments().len(), states.len())?;
    for state in states {
        check("an initial state", form.states, state.len())?;
        if let Some(index) = state.iter().position(|v| !v.is_finite()) {
            return Err(IdentError::NotFinite { what: "an initial state", index });
        }
    }
    Ok(states.to_vec())
}

fn simulated(form: &Form, experiment: &Experiment, x0: &[f64]) -> Result<Mat<f64>, IdentError> {
    let mut stepper = Stepper::new(form, experiment, x0);
    let mut outputs = Mat::zeros(experiment.len(), form.outputs);
    let mut y = vec![0.0; form.outputs];
    for t in work::checked(0..experiment.len()) {
        stepper.output(t, &mut y);
        store(&y, t, &mut outputs)?;
        stepper.advance();
    }
    Ok(outputs)
}

fn predicted(form: &Form, experiment: &Experiment, x0: &[f64], horizon: usize) -> Result<Mat<f64>, IdentError> {
    let measured: Vec<&[f64]> = (0..form.outputs).map(|i| experiment.output(i)).collect();
    let mut stepper = Stepper::new(form, experiment, x0);
    let mut gain = Gain::new(form);
    let mut unused = Unused::new(form, (horizon - 1).min(experiment.len()));
    let mut outputs = Mat::zeros(experiment.len(), form.outputs);
    let (mut y, mut e, mut v) = (vec![0.0; form.outputs], vec![0.0; form.outputs], vec![0.0; form.states]);
    for t in work::checked(0..experiment.len()) {
        stepper.output(t, &mut y);
        for (i, slot) in e.iter_mut().enumerate() {
            *slot = measured[i][t] - y[i];
        }
        unused.take_off(&mut y);
        store(&y, t, &mut outputs)?;
        gain.update(&mut e);
        gain.apply(&e, &mut v);
        unused.push(&v);
        stepper.advance_corrected(&v);
    }
    Ok(outputs)
}

fn store(y: &[f64], t: usize, outputs: &mut Mat<f64>) -> Result<(), IdentError> {
    for (i, value) in y.iter().enumerate() {
        if !value.is_finite() {
            return Err(IdentError::NotFinite { what: "the modelled output", index: t });
        }
        outputs[(t, i)] = *value;
    }
    Ok(())
}

/// The corrections of the state that a k-step predictor may not use yet: `Σ_{j=1}^{k−1} C A^{j−1} v(t − j)`.
struct Unused {
    outputs: usize,
    states: usize,
    /// `C A^{j−1}` for `j = 1 … k − 1`, each by rows.
    weights: Vec<f64>,
    /// The last `k − 1` corrections, in a ring.
    corrections: Vec<f64>,
    newest: usize,
    length: usize,
}

impl Unused {
    fn new(form: &Form, length: usize) -> Self {
        let length = if form.is_output_error() { 0 } else { length };
        let system = form.model.system();
        let mut weights = Vec::with_capacity(length * form.outputs * form.states);
        let mut row = system.c().to_owned();
        for _ in work::checked(0..length) {
            weights.extend((0..form.outputs).flat_map(|i| (0..form.states).map(move |j| (i, j))).map(|at| row[at]));
            row = &row * system.a();
        }
        Unused {
            outputs: form.outputs,
            states: form.states,
            weights,
            corrections: vec![0.0; length * form.states],
            newest: 0,
            length,
        }
    }

    fn take_off(&self, y: &mut [f64]) {
        for j in 0..self.length {
            let at = (self.newest + j) % self.length * self.states;
            let correction = &self.corrections[at..at + self.states];
            for (i, slot) in y.iter_mut().enumerate() {
                let weights = &self.weights[(j * self.outputs + i) * self.states..][..self.states];
                *slot -= weights.iter().zip(correction).map(|(w, v)| w * v).sum::<f64>();
            }
        }
    }

    fn push(&mut self, correction: &[f64]) {
        if self.length > 0 {
            self.newest = (self.newest + self.length - 1) % self.length;
            self.corrections[self.newest * self.states..][..self.states].copy_from_slice(correction);
        }
    }
}
