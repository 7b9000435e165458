//! Linear regression of `B`, `D` and initial states, and what is known at an estimate: errors and covariance.

use faer::{Mat, MatRef};
use lti::{Innovations, StateSpace};

use super::StateSpaceModel;
use super::coordinates::{directions, entry_scales};
use super::predictor::{Free, Lineariser, Predictor, Scatter};
use crate::data::Experiment;
use crate::least_squares::checked_condition;
use crate::subspace::linear::{solve_truncated, whitening};
use crate::{Dataset, Doubt, Fit, IdentError, Termination};

/// Longer data give the information per sample from stretches: so many of them, of so many samples.
const STRETCHES: usize = 12;
const STRETCH: usize = 4096;
/// Singular values of the scaled Jacobian are taken as at least this part of the largest, so that what the data do not
/// determine gets a large variance, not none.
const FLOOR: f64 = 1e-12;

/// A model with its inputs' influence and initial states.
pub(crate) struct Regressed {
    pub(crate) model: Innovations,
    pub(crate) initial_states: Vec<Vec<f64>>,
}

/// `B`, `D` and the initial states by linear least squares on the prediction errors, the other matrices as they are in
/// `start`, whose `B` and `D` are zero.
///
/// # Errors
/// Inputs whose influences cannot be told apart, or a predictor that is unstable.
pub(crate) fn regress_inputs(data: &Dataset, start: Innovations, feedthrough: bool) -> Result<Regressed, IdentError> {
    let predictor = Predictor::new(&start);
    let free = Free { dynamics: false, feedthrough, noise: false };
    let (n, m, p) = (predictor.n, predictor.m, predictor.p);
    let count = free.count(n, m, p);
    let zero = vec![vec![0.0; n]; data.experiments().len()];
    let whitening = whitening(start.noise_covariance())?;
    let basis = Mat::<f64>::identity(count, count);
    let lineariser =
        Lineariser { predictor: &predictor, free, basis: basis.as_ref(), whitening: whitening.as_ref(), initial: true };
    let linearised = lineariser.over(data, &zero);
    check_finite(&linearised.factor)?;
    let step = regression(&linearised.factor)?;
    let initial_states = linearised.initial_steps(&step)?;
    let system = start.system();
    let b = Mat::from_fn(n, m, |i, j| step[i * m + j]);
    let d = Mat::from_fn(p, m, |i, j| if feedthrough { step[n * m + i * m + j] } else { 0.0 });
    let whole = StateSpace::new(system.a().to_owned(), b, system.c().to_owned(), d, system.sample_time_s())?;
    let model = Innovations::new(whole, start.k().to_owned(), start.noise_covariance().to_owned())?;
    Ok(Regressed { model, initial_states })
}

/// Refuses a factor that overflowed.
pub(super) fn check_finite(factor: &Mat<f64>) -> Result<(), IdentError> {
    if factor.norm_max().is_finite() {
        return Ok(());
    }
    Err(IdentError::Structure { what: "the predictor is unstable: estimate a noise model, or ask for a stable model" })
}

/// The least-squares solution of the factor of `[Φ, y]`.
fn regression(factor: &Mat<f64>) -> Result<Vec<f64>, IdentError> {
    let n = factor.ncols() - 1;
    if n == 0 {
        return Ok(Vec::new());
    }
    let (scaled, norms) = scaled_columns(factor.submatrix(0, 0, n, n));
    checked_condition(&scaled)?;
    let right = Mat::from_fn(n, 1, |i, _| factor[(i, n)]);
    let solution = solve_truncated(scaled.as_ref(), right.as_ref(), 0.0)?;
    Ok((0..n).map(|i| solution[(i, 0)] / norms[i]).collect())
}

/// The matrix with columns of length one, and their lengths; a column of zeros stays.
pub(super) fn scaled_columns(m: MatRef<'_, f64>) -> (Mat<f64>, Vec<f64>) {
    let length = |j: usize| m.col(j).norm_l2();
    let norms: Vec<f64> = (0..m.ncols()).map(|j| if length(j) > 0.0 { length(j) } else { 1.0 }).collect();
    (Mat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] / norms[j]), norms)
}

/// What is known at an estimate.
pub(crate) struct Gathered {
    pub(crate) model: StateSpaceModel,
    pub(crate) covariance: Mat<f64>,
    pub(crate) noise_covariance: Mat<f64>,
    pub(crate) loss: f64,
    pub(crate) samples: usize,
    pub(crate) free_parameters: usize,
    pub(crate) degrees_of_freedom: f64,
    pub(crate) condition: f64,
}

impl Gathered {
    pub(crate) fn into_fit(
        self,
        initial_states: Vec<Vec<f64>>,
        termination: Termination,
        iterations: usize,
        doubts: Vec<Doubt>,
    ) -> Fit<StateSpaceModel> {
        Fit {
            model: self.model,
            covariance: self.covariance,
            degrees_of_freedom: self.degrees_of_freedom,
            noise_covariance: self.noise_covariance,
            loss: self.loss,
            samples: self.samples,
            free_parameters: self.free_parameters,
            initial_states,
            termination,
            iterations,
            condition: self.condition,
            doubts,
        }
    }
}

/// Which data the information is gathered from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Information {
    /// Every sample.
    All,
    /// Stretches spread over long experiments.
    Sampled,
}

/// Errors and covariance of `model` with these initial states, which were estimated or are given.
///
/// # Errors
/// Fewer data than parameters, or a predictor that is unstable.
pub(crate) fn gather(
    data: &Dataset,
    model: StateSpaceModel,
    x0: &[Vec<f64>],
    initial: bool,
    information: Information,
) -> Result<Gathered, IdentError> {
    let predictor = Predictor::new(model.innovations());
    let free = model.free();
    let scales = entry_scales(&predictor, free, data, x0);
    let basis = directions(model.innovations(), free, &scales)?;
    let marks = marks(data, information);
    let Scatter { sum, instants, marked } = predictor.scatter(data, x0, &marks);
    let (p, free_parameters) = (predictor.p, basis.ncols());
    let estimated = free_parameters + if initial { predictor.n * x0.len() } else { 0 };
    if instants * p <= estimated {
        return Err(IdentError::TooFewSamples { samples: instants, parameters: estimated });
    }
    check_finite(&sum)?;
    let spent = estimated as f64 / p as f64;
    let noise_covariance = &sum * faer::Scale(1.0 / (instants as f64 - spent));
    let whitening = whitening(noise_covariance.as_ref())?;
    let lineariser =
        Lineariser { predictor: &predictor, free, basis: basis.as_ref(), whitening: whitening.as_ref(), initial };
    let linearised = if marks.iter().all(Vec::is_empty) {
        lineariser.over(data, x0)
    } else {
        let (part, x0) = stretches(data, &marks, marked)?;
        lineariser.over(&part, &x0)
    };
    let share = linearised.rows as f64 / (instants * p) as f64;
    let (unit, condition) = inverse_information(&linearised.factor)?;
    let turned = &basis * unit;
    let covariance = &turned * turned.transpose() * faer::Scale(share);
    let loss = (&sum * faer::Scale(1.0 / instants as f64)).determinant();
    let innovations = model.innovations();
    let with_noise =
        Innovations::new(innovations.system().clone(), innovations.k().to_owned(), noise_covariance.clone())?;
    Ok(Gathered {
        model: StateSpaceModel::new(with_noise, model.has_feedthrough(), model.has_noise_model()),
        covariance,
        noise_covariance,
        loss,
        samples: instants,
        free_parameters,
        degrees_of_freedom: (instants * p - estimated) as f64,
        condition,
    })
}

/// `U` with `U Uᵀ = (RᵀR)⁻¹`, and the condition of R with its columns scaled.
fn inverse_information(factor: &Mat<f64>) -> Result<(Mat<f64>, f64), IdentError> {
    let n = factor.ncols() - 1;
    if n == 0 {
        return Ok((Mat::new(), 1.0));
    }
    let (scaled, norms) = scaled_columns(factor.submatrix(0, 0, n, n));
    let svd = scaled.thin_svd().map_err(|_| IdentError::Decomposition { what: "singular value" })?;
    let values: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    let inverse = |j: usize| 1.0 / values[j].max(FLOOR * values[0]);
    let unit = Mat::from_fn(n, n, |i, j| svd.V()[(i, j)] * inverse(j) / norms[i]);
    Ok((unit, values[0] / values[n - 1]))
}

/// Where stretches start; none where all of an experiment is used.
fn marks(data: &Dataset, information: Information) -> Vec<Vec<usize>> {
    let spread =
        |e: &Experiment| -> Vec<usize> { (0..STRETCHES).map(|k| k * (e.len() - STRETCH) / (STRETCHES - 1)).collect() };
    let long = |e: &Experiment| information == Information::Sampled && e.len() > 2 * STRETCHES * STRETCH;
    if !data.experiments().iter().any(long) {
        return vec![Vec::new(); data.experiments().len()];
    }
    // A short experiment beside a long one is one stretch from its start.
    data.experiments().iter().map(|e| if long(e) { spread(e) } else { vec![0] }).collect()
}

/// The stretches as experiments, with the states they start in.
fn stretches(
    data: &Dataset,
    marks: &[Vec<usize>],
    mut marked: Vec<Vec<f64>>,
) -> Result<(Dataset, Vec<Vec<f64>>), IdentError> {
    let mut part: Option<Dataset> = None;
    for (experiment, starts) in data.experiments().iter().zip(marks) {
        for start in starts {
            let length = if starts.len() > 1 { STRETCH } else { experiment.len() };
            let cut = |m: &Mat<f64>| m.subrows(*start, if m.nrows() == 0 { 0 } else { length }).to_owned();
            let (inputs, outputs) = (cut(&experiment.inputs), cut(&experiment.outputs));
            part = Some(match part {
                None => Dataset::new(data.sample_time_s(), inputs, outputs)?,
                Some(part) => {
                    let (name, start_s) = (experiment.name.clone(), experiment.start_s);
                    part.with_experiment(Experiment { name, start_s, inputs, outputs })?
                }
            });
        }
    }
    let part = part.ok_or(IdentError::TooFewSamples { samples: 0, parameters: 1 })?;
    marked.truncate(part.experiments().len());
    Ok((part, marked))
}
