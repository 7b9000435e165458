//! Linear regression of `B`, `D` and initial states, and what is known at an estimate: errors and covariance.

use faer::{Mat, MatRef};
use lti::{Innovations, StateSpace};
use numerics::linalg;

use super::coordinates::{directions, entry_scales};
use super::lineariser::{Linearised, Lineariser};
use super::predictor::{Free, Predictor, Scatter};
use super::{StateSpaceModel, correlated};
use crate::colour::{Colour, Sandwich};
use crate::data::Experiment;
use crate::dense::whitening;
use crate::{Dataset, Doubt, Fit, IdentError, Termination};
use fitting::condition::checked_condition;
use fitting::{StructureError, UnstablePart};

/// Longer data give the information per sample from stretches: so many of them, of so many samples.
const STRETCHES: usize = 8;
const STRETCH: usize = 1024;
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
/// Inputs whose influences cannot be separated, or a predictor that is unstable.
pub(crate) fn regress_inputs(data: &Dataset, start: Innovations, feedthrough: bool) -> Result<Regressed, IdentError> {
    let predictor = Predictor::new(&start);
    let free = Free { dynamics: false, feedthrough, noise: false };
    let (n, m, p) = (predictor.n, predictor.m, predictor.p);
    let count = free.count(n, m, p);
    let zero = vec![vec![0.0; n]; data.experiments().len()];
    let whitening = whitening(start.noise_covariance())?;
    let basis = Mat::<f64>::identity(count, count);
    let lineariser =
        Lineariser { predictor: &predictor, free, basis: basis.as_ref(), whitening: whitening.as_ref(), initial: n };
    let closed = start.system().a() - start.k() * start.system().c();
    let correlated = correlated::factor(data, &predictor, closed.as_ref(), feedthrough, whitening.as_ref());
    let linearised = correlated.unwrap_or_else(|| lineariser.over(data, &zero));
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
    Err(StructureError::Unstable(UnstablePart::Predictor).into())
}

/// The least-squares solution of the factor of `[Φ, y]`.
fn regression(factor: &Mat<f64>) -> Result<Vec<f64>, IdentError> {
    let n = factor.ncols() - 1;
    if n == 0 {
        return Ok(Vec::new());
    }
    let (scaled, norms) = scaled_columns(factor.submatrix(0, 0, n, n));
    checked_condition(scaled.as_ref())?;
    let right = Mat::from_fn(n, 1, |i, _| factor[(i, n)]);
    let solution = linalg::least_norm(scaled.as_ref(), right.as_ref(), 0.0)?;
    Ok((0..n).map(|i| solution[(i, 0)] / norms[i]).collect())
}

/// The matrix with columns of length one, and their lengths; a column of zeros stays.
pub(super) fn scaled_columns(m: MatRef<'_, f64>) -> (Mat<f64>, Vec<f64>) {
    let length = |j: usize| m.col(j).norm_l2();
    let norms: Vec<f64> = (0..m.ncols()).map(|j| if length(j) > 0.0 { length(j) } else { 1.0 }).collect();
    (Mat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] / norms[j]), norms)
}

/// Covariance, loss and degrees of freedom at an estimate.
pub(crate) struct Gathered {
    /// Covariance of the steps along the directions.
    pub(crate) covariance: Mat<f64>,
    pub(crate) noise_covariance: Mat<f64>,
    pub(crate) loss: f64,
    pub(crate) samples: usize,
    pub(crate) free_parameters: usize,
    pub(crate) degrees_of_freedom: f64,
    pub(crate) condition: f64,
}

/// The directions in which a model was searched for.
pub(crate) struct Known<'a> {
    /// Which matrices change.
    pub(crate) free: Free,
    /// How the free entries change along each direction.
    pub(crate) basis: MatRef<'a, f64>,
    /// Reciprocal standard deviation known beforehand of each direction; empty where nothing is.
    pub(crate) prior: &'a [f64],
}

/// Which data the information is gathered from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Information {
    /// Every sample.
    All,
    /// Stretches spread over long experiments.
    Sampled,
}

/// Errors and covariance of `model` with these initial states, of which the first `estimated` were estimated. Where a
/// model without noise gain leaves coloured errors, the covariance is that under errors with their autocorrelation.
///
/// # Errors
/// Fewer data than parameters, or a predictor that is unstable.
pub(crate) fn gather(
    data: &Dataset,
    model: &Innovations,
    known: &Known<'_>,
    x0: &[Vec<f64>],
    estimated: usize,
    information: Information,
) -> Result<Gathered, IdentError> {
    let marks = marks(data, information);
    let (predictor, Scatter { sum, instants, marked }) = scattered(data, model, x0, &marks)?;
    let (p, free_parameters) = (predictor.p, known.basis.ncols());
    let unknowns = free_parameters + estimated * x0.len();
    if instants * p <= unknowns {
        return Err(IdentError::TooFewSamples { samples: instants, parameters: unknowns });
    }
    check_finite(&sum)?;
    let noise_covariance = &sum * faer::Scale(1.0 / (instants as f64 - unknowns as f64 / p as f64));
    let whitening = whitening(noise_covariance.as_ref())?;
    let lineariser = Lineariser {
        predictor: &predictor,
        free: known.free,
        basis: known.basis,
        whitening: whitening.as_ref(),
        initial: estimated,
    };
    let linearised = if marks.iter().all(Vec::is_empty) {
        lineariser.over(data, x0)
    } else {
        let part = stretches(data, &marks)?;
        lineariser.over(&part, &marked)
    };
    let share = linearised.rows as f64 / (instants * p) as f64;
    let (unit, condition) = inverse_information(&linearised.factor, known.prior, share)?;
    let unexplained = model.k().norm_max() == 0.0 && information == Information::All;
    let remaining = (instants * p - unknowns) as f64;
    let scale = (instants * p) as f64 / remaining;
    let coloured =
        if unexplained { coloured(&lineariser, &linearised, data, x0, known.prior, &unit, scale)? } else { None };
    let (covariance, degrees_of_freedom) = match coloured {
        None => (&unit * unit.transpose(), remaining),
        Some((covariance, limit)) => (covariance, remaining.min(limit)),
    };
    Ok(Gathered {
        covariance,
        noise_covariance,
        // Rounding may take the determinant of a singular covariance below zero.
        loss: linalg::determinant((&sum * faer::Scale(1.0 / instants as f64)).as_ref()).max(0.0),
        samples: instants,
        free_parameters,
        degrees_of_freedom,
        condition,
    })
}

/// The predictor and the scatter of its errors. After a missing output its gain depends on the covariance of the
/// errors, which a first pass finds.
fn scattered(
    data: &Dataset,
    model: &Innovations,
    x0: &[Vec<f64>],
    marks: &[Vec<usize>],
) -> Result<(Predictor, Scatter), IdentError> {
    let predictor = Predictor::new(model);
    let scatter = predictor.scatter(data, x0, marks);
    if !data.experiments().iter().any(Experiment::has_missing) || scatter.instants == 0 {
        return Ok((predictor, scatter));
    }
    check_finite(&scatter.sum)?;
    let found = &scatter.sum * faer::Scale(1.0 / scatter.instants as f64);
    let predictor = Predictor::new(&Innovations::new(model.system().clone(), model.k().to_owned(), found)?);
    let scatter = predictor.scatter(data, x0, marks);
    Ok((predictor, scatter))
}

/// The covariance under errors with the autocorrelation of the residuals and `scale` times their size, and its degrees
/// of freedom; `None` where they look white.
fn coloured(
    lineariser: &Lineariser<'_>,
    linearised: &Linearised,
    data: &Dataset,
    x0: &[Vec<f64>],
    prior: &[f64],
    unit: &Mat<f64>,
    scale: f64,
) -> Result<Option<(Mat<f64>, f64)>, IdentError> {
    let each = || data.experiments().iter().zip(x0);
    let series: Vec<Vec<f64>> = each().map(|(e, x0)| lineariser.errors(e, x0)).collect();
    let p = lineariser.predictor.p;
    let colour = Colour::of(&series, p);
    if colour.is_white() {
        return Ok(None);
    }
    let (states, columns) = (lineariser.initial, lineariser.basis.ncols());
    let mut sandwich = Sandwich::with_unit(&colour, unit.clone());
    let mut rows = vec![0.0; p * columns];
    for ((experiment, x0), explained) in each().zip(linearised.explained()?) {
        lineariser.rows(experiment, x0, |raw, complete| {
            rows.fill(0.0);
            let given = raw.chunks_exact(raw.len() / p).zip(rows.chunks_exact_mut(columns));
            for (raw, row) in given.filter(|_| complete) {
                for (j, v) in row.iter_mut().enumerate() {
                    let direct: f64 = lineariser.basis.col(j).iter().zip(&raw[states..]).map(|(b, r)| b * r).sum();
                    *v = direct - raw[..states].iter().enumerate().map(|(i, r)| r * explained[(i, j)]).sum::<f64>();
                }
            }
            sandwich.push(&rows);
        });
        sandwich.finish_series();
    }
    // What is known beforehand is known as well as it was.
    let known = Mat::from_fn(prior.len(), unit.ncols(), |i, k| prior[i] * unit[(i, k)]);
    let beforehand = unit * (known.transpose() * &known) * unit.transpose();
    Ok(Some((faer::Scale(scale) * sandwich.covariance() + beforehand, colour.degrees_of_freedom())))
}

/// The estimate of a state-space model at `model` and these initial states.
///
/// # Errors
/// Those of [`gather`].
pub(crate) fn estimate(
    data: &Dataset,
    model: &StateSpaceModel,
    initial_states: Vec<Vec<f64>>,
    estimated: usize,
    information: Information,
) -> Result<Fit<StateSpaceModel>, IdentError> {
    let (innovations, free) = (model.innovations(), model.free());
    let scales = entry_scales(&Predictor::new(innovations), free, data, &initial_states);
    let basis = directions(innovations, free, &scales)?;
    let known = Known { free, basis: basis.as_ref(), prior: &[] };
    let gathered = gather(data, innovations, &known, &initial_states, estimated, information)?;
    let (system, k) = (innovations.system().clone(), innovations.k().to_owned());
    let mut doubts = Vec::new();
    if gathered.condition > 1e8 {
        doubts.push(Doubt::IllConditioned { condition: gathered.condition });
    }
    if !system.is_stable()? {
        doubts.push(Doubt::Unstable);
    }
    let whole = Innovations::new(system, k, gathered.noise_covariance.clone())?;
    Ok(Fit {
        model: StateSpaceModel::new(whole, model.has_feedthrough(), model.has_noise_model()),
        covariance: &basis * gathered.covariance * basis.transpose(),
        degrees_of_freedom: gathered.degrees_of_freedom,
        noise_covariance: gathered.noise_covariance,
        loss: gathered.loss,
        samples: gathered.samples,
        free_parameters: gathered.free_parameters,
        initial_states,
        levels: Vec::new(),
        termination: Termination::Direct,
        iterations: 0,
        condition: gathered.condition,
        doubts,
        origin: None,
    }
    .doubting(data))
}

/// `U` with `U Uᵀ = (RᵀR/share + prior)⁻¹`, and the condition of the root with its columns scaled.
fn inverse_information(factor: &Mat<f64>, prior: &[f64], share: f64) -> Result<(Mat<f64>, f64), IdentError> {
    let n = factor.ncols() - 1;
    if n == 0 {
        return Ok((Mat::new(), 1.0));
    }
    let root = Mat::from_fn(n + prior.len(), n, |i, j| match i.checked_sub(n) {
        None => factor[(i, j)] / share.sqrt(),
        Some(k) if k == j => prior[k],
        Some(_) => 0.0,
    });
    let (scaled, norms) = scaled_columns(root.as_ref());
    let svd = linalg::thin_svd(scaled.as_ref())?;
    let values = &svd.values;
    let inverse = |j: usize| 1.0 / values[j].max(FLOOR * values[0]);
    let unit = Mat::from_fn(n, n, |i, j| svd.v[(i, j)] * inverse(j) / norms[i]);
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
    data.experiments().iter().map(|e| if long(e) { spread(e) } else { vec![0; usize::from(!e.is_empty())] }).collect()
}

/// The stretches as experiments.
fn stretches(data: &Dataset, marks: &[Vec<usize>]) -> Result<Dataset, IdentError> {
    let mut part: Option<Dataset> = None;
    for (experiment, starts) in data.experiments().iter().zip(marks) {
        for start in starts {
            let length = if starts.len() > 1 { STRETCH } else { experiment.len() };
            let cut = |m: &Mat<f64>| if m.nrows() == 0 { m.clone() } else { m.subrows(*start, length).to_owned() };
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
    part.ok_or(IdentError::TooFewSamples { samples: 0, parameters: 1 })
}
