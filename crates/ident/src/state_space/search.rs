//! The damped Gauss–Newton search in data-driven local coordinates.

use faer::Mat;
use lti::Innovations;

use super::StateSpaceModel;
use super::coordinates::{directions, entry_scales};
use super::gather::{check_finite, scaled_columns};
use super::predictor::{Lineariser, Predictor, Scatter};
use crate::subspace::linear::{solve_truncated, whitening};
use crate::{Dataset, IdentError, Parametric, Termination};

/// Converged when the criterion falls, or is expected to fall, by less than this part ...
const DECREASE_TOLERANCE: f64 = 1e-13;
/// ... or by less than this part of what one standard error in one parameter makes of it.
const STATISTICAL_TOLERANCE: f64 = 1e-8;
/// Directions weaker than this part of the strongest are left alone within a step.
const RANK_TOLERANCE: f64 = 1e-9;

/// A model with its initial states and the scatter of its errors.
pub(super) struct Search<'a> {
    data: &'a Dataset,
    model: StateSpaceModel,
    x0: Vec<Vec<f64>>,
    sum: Mat<f64>,
    instants: usize,
    initial: bool,
    damping: f64,
    iterations: usize,
}

impl<'a> Search<'a> {
    pub(super) fn new(data: &'a Dataset, model: StateSpaceModel, initial: bool) -> Result<Self, IdentError> {
        let x0 = vec![vec![0.0; model.system().states()]; data.experiments().len()];
        let Scatter { sum, instants, .. } = Predictor::new(model.innovations()).scatter(data, &x0, &[]);
        check_finite(&sum)?;
        Ok(Search { data, model, x0, sum, instants, initial, damping: 1e-4, iterations: 0 })
    }

    pub(super) fn into_parts(self) -> (usize, Vec<Vec<f64>>, StateSpaceModel) {
        (self.iterations, self.x0, self.model)
    }

    pub(super) fn run(&mut self, limit: usize) -> Result<Termination, IdentError> {
        while self.iterations < limit {
            self.iterations += 1;
            if let Some(end) = self.iterate()? {
                return Ok(end);
            }
        }
        Ok(Termination::IterationLimit)
    }

    /// One linearisation and the best damped step from it; `Some` when the search is over.
    fn iterate(&mut self) -> Result<Option<Termination>, IdentError> {
        let predictor = Predictor::new(self.model.innovations());
        let free = self.model.free();
        let scales = entry_scales(&predictor, free, self.data, &self.x0);
        let basis = directions(self.model.innovations(), free, &scales)?;
        let mean = &self.sum * faer::Scale(1.0 / self.instants.max(1) as f64);
        let whitening = whitening(mean.as_ref())?;
        let lineariser = Lineariser {
            predictor: &predictor,
            free,
            basis: basis.as_ref(),
            whitening: whitening.as_ref(),
            initial: self.initial,
        };
        let linearised = lineariser.over(self.data, &self.x0);
        check_finite(&linearised.factor)?;
        let cost = weighted(&self.sum, &whitening);
        let reach = (0..basis.ncols()).map(|i| linearised.factor[(i, basis.ncols())].powi(2)).sum::<f64>();
        let negligible = DECREASE_TOLERANCE.max(STATISTICAL_TOLERANCE / self.instants as f64);
        let mut growth = 4.0;
        loop {
            let step = damped_step(&linearised.factor, self.damping)?;
            let trial = self.moved(&basis, &step, &linearised.initial_steps(&step)?);
            if let Some((model, x0, scatter)) = trial {
                let now = weighted(&scatter.sum, &whitening);
                if now < cost {
                    let decrease = (cost - now) / cost;
                    (self.model, self.x0, self.sum) = (model, x0, scatter.sum);
                    self.damping = (self.damping / 10.0).max(1e-12);
                    let done = decrease <= negligible;
                    return Ok(done.then_some(Termination::SmallDecrease));
                }
            }
            if reach <= negligible * cost {
                return Ok(Some(Termination::SmallDecrease));
            }
            self.damping *= growth;
            growth *= 2.0;
            if self.damping > 1e12 {
                return Ok(Some(Termination::NoDescent));
            }
        }
    }

    /// The model after a step, where it can be evaluated.
    fn moved(
        &self,
        basis: &Mat<f64>,
        step: &[f64],
        initial: &[Vec<f64>],
    ) -> Option<(StateSpaceModel, Vec<Vec<f64>>, Scatter)> {
        let mut parameters = self.model.parameters();
        for (i, value) in parameters.iter_mut().enumerate() {
            *value += step.iter().enumerate().map(|(j, s)| basis[(i, j)] * s).sum::<f64>();
        }
        let model = self.model.with_parameters(&parameters).ok()?;
        let mut x0 = self.x0.clone();
        x0.iter_mut().zip(initial).for_each(|(x, by)| x.iter_mut().zip(by).for_each(|(x, by)| *x += by));
        let innovations: &Innovations = model.innovations();
        let scatter = Predictor::new(innovations).scatter(self.data, &x0, &[]);
        scatter.sum.norm_max().is_finite().then_some((model, x0, scatter))
    }
}

/// `tr Λ⁻¹ Σ ε εᵀ`.
fn weighted(sum: &Mat<f64>, whitening: &Mat<f64>) -> f64 {
    let white = whitening * sum * whitening.transpose();
    (0..white.nrows()).map(|i| white[(i, i)]).sum()
}

/// Minimiser of `‖ε − Ψ δ‖² + λ ‖D δ‖²`, `D` the lengths of the columns of Ψ.
fn damped_step(factor: &Mat<f64>, damping: f64) -> Result<Vec<f64>, IdentError> {
    let n = factor.ncols() - 1;
    let (scaled, norms) = scaled_columns(factor.submatrix(0, 0, n, n));
    let root = damping.sqrt();
    let stacked = Mat::from_fn(2 * n, n, |i, j| match i.checked_sub(n) {
        None => scaled[(i, j)],
        Some(k) if k == j => root,
        Some(_) => 0.0,
    });
    let right = Mat::from_fn(2 * n, 1, |i, _| if i < n { factor[(i, n)] } else { 0.0 });
    let solution = solve_truncated(stacked.as_ref(), right.as_ref(), RANK_TOLERANCE)?;
    Ok((0..n).map(|j| solution[(j, 0)] / norms[j]).collect())
}
