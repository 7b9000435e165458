//! The damped Gauss–Newton search for the least prediction errors.

use faer::{Mat, MatRef};
use lti::Innovations;
use numerics::linalg;

use super::StateSpaceModel;
use super::coordinates::{directions, entry_scales};
use super::extrapolation::Extrapolation;
use super::gather::{check_finite, scaled_columns};
use super::lineariser::Lineariser;
use super::predictor::{Free, Predictor, Scatter};
use crate::dense::{WEIGHT_FLOOR, spectral_radius, whitening};
use crate::{Dataset, IdentError, Parametric, Termination};

/// Converged when the criterion falls, or is expected to fall, by less than this part ...
const DECREASE_TOLERANCE: f64 = 1e-13;
/// ... or by less than this part of what one standard error in one parameter makes of it; a search whose steps are not
/// extrapolated may have many small ones before it.
const STATISTICAL_TOLERANCE: f64 = 1e-4;
const STATISTICAL_TOLERANCE_OF_SMALL_STEPS: f64 = 1e-8;
/// Directions weaker than this part of the strongest are left alone within a step.
const RANK_TOLERANCE: f64 = 1e-9;

/// A step is damped at least by this part.
const LEAST_DAMPING: f64 = 1e-12;

/// A model that is searched for along some directions of its matrices' entries.
pub(crate) trait Searchable: Clone {
    /// The model in innovations form.
    fn innovations(&self, data: &Dataset) -> Result<Innovations, IdentError>;

    /// Which matrices change.
    fn free(&self) -> Free;

    /// How the free entries change along each direction, entries × directions.
    fn directions(&self, now: &Innovations, data: &Dataset, x0: &[Vec<f64>]) -> Result<Mat<f64>, IdentError>;

    /// The model after a step along the directions; `None` where there is none.
    fn moved(&self, directions: &Mat<f64>, step: &[f64]) -> Option<Self>;

    /// Returns true if nothing can be gained `towards` this side of a direction, for a bound.
    fn blocked(&self, _direction: usize, _towards: f64) -> bool {
        false
    }

    /// The entries that the directions change, where steps may be extrapolated.
    fn entries(&self) -> Option<Vec<f64>> {
        None
    }

    /// For each direction an equation `weight · step = target` that holds with unit variance; weight zero for none.
    fn prior(&self) -> Vec<(f64, f64)> {
        Vec::new()
    }

    /// Initial states of the innovations form from those of the model.
    fn all_states(&self, x0: &[Vec<f64>], _data: &Dataset) -> Vec<Vec<f64>> {
        x0.to_vec()
    }
}

impl Searchable for StateSpaceModel {
    fn innovations(&self, _: &Dataset) -> Result<Innovations, IdentError> {
        Ok(self.innovations().clone())
    }

    fn free(&self) -> Free {
        StateSpaceModel::free(self)
    }

    fn directions(&self, now: &Innovations, data: &Dataset, x0: &[Vec<f64>]) -> Result<Mat<f64>, IdentError> {
        let free = StateSpaceModel::free(self);
        directions(now, free, &entry_scales(&Predictor::new(now), free, data, x0))
    }

    fn moved(&self, directions: &Mat<f64>, step: &[f64]) -> Option<Self> {
        let mut parameters = self.parameters();
        parameters.iter_mut().zip(change(directions, step)).for_each(|(value, by)| *value += by);
        self.with_parameters(&parameters).ok()
    }

    fn entries(&self) -> Option<Vec<f64>> {
        Some(self.parameters())
    }
}

/// Change of the entries by a step along directions.
fn change(directions: &Mat<f64>, step: &[f64]) -> Vec<f64> {
    (0..directions.nrows()).map(|i| step.iter().enumerate().map(|(j, s)| directions[(i, j)] * s).sum()).collect()
}

/// The free entries of a model, in the order A, B, C, D, K, each by rows.
pub(crate) fn entries(model: &Innovations, free: Free) -> Vec<f64> {
    let system = model.system();
    let by_rows = |m: MatRef<'_, f64>, wanted: bool| -> Vec<f64> {
        let rows = if wanted { m.nrows() } else { 0 };
        (0..rows).flat_map(|i| (0..m.ncols()).map(move |j| m[(i, j)])).collect()
    };
    [
        by_rows(system.a(), free.dynamics),
        by_rows(system.b(), true),
        by_rows(system.c(), free.dynamics),
        by_rows(system.d(), free.feedthrough),
        by_rows(model.k(), free.noise),
    ]
    .concat()
}

/// A model, its initial states and the scatter of its errors.
type Tried<M> = (M, Vec<Vec<f64>>, Scatter);

/// A model with its initial states and the scatter of its errors.
pub(crate) struct Search<'a, M> {
    data: &'a Dataset,
    model: M,
    x0: Vec<Vec<f64>>,
    scatter: Scatter,
    /// Variance that is added to that of each output where errors are weighed.
    floor: Vec<f64>,
    /// How many of the leading states are estimated in each experiment.
    estimated: usize,
    /// True if an output misses samples, so that errors have weights that depend on the model.
    misses: bool,
    damping: f64,
    extrapolation: Extrapolation,
    iterations: usize,
}

impl<'a, M: Searchable> Search<'a, M> {
    /// A search that starts at `model` and these initial states.
    ///
    /// # Errors
    /// A model that cannot be evaluated, or whose predictor is unstable.
    pub(crate) fn new(data: &'a Dataset, model: M, x0: Vec<Vec<f64>>, estimated: usize) -> Result<Self, IdentError> {
        let predictor = Predictor::new(&model.innovations(data)?);
        let scatter = predictor.scatter(data, &model.all_states(&x0, data), &[]);
        check_finite(&scatter.sum)?;
        if scatter.instants == 0 {
            return Err(IdentError::TooFewSamples { samples: 0, parameters: 1 });
        }
        let floor = weight_floor(data);
        let misses = data.experiments().iter().any(crate::Experiment::has_missing);
        let extrapolation = Extrapolation::default();
        Ok(Search { data, model, x0, scatter, floor, estimated, misses, damping: 1e-2, extrapolation, iterations: 0 })
    }

    /// The predictor of a model whose errors have the covariance found, on which its gain after a missing output
    /// depends.
    fn predictor(&self, innovations: &Innovations) -> Result<Predictor, IdentError> {
        if !self.misses {
            return Ok(Predictor::new(innovations));
        }
        let (system, k) = (innovations.system().clone(), innovations.k().to_owned());
        Ok(Predictor::new(&Innovations::new(system, k, self.error_covariance())?))
    }

    /// With next to no damping in its first step.
    pub(crate) fn near_the_end(self) -> Self {
        Search { damping: LEAST_DAMPING, ..self }
    }

    /// Where it is.
    pub(crate) fn model(&self) -> &M {
        &self.model
    }

    /// Iterations taken, initial states and model.
    pub(crate) fn into_parts(self) -> (usize, Vec<Vec<f64>>, M) {
        (self.iterations, self.x0, self.model)
    }

    /// Cost that is minimised: `N ln det (Σ ε εᵀ/N + floor)` and the prior's part.
    pub(crate) fn criterion(&self) -> f64 {
        self.scatter.instants as f64 * linalg::determinant(self.error_covariance().as_ref()).ln()
            + prior_cost(&self.model)
    }

    /// `Σ ε εᵀ/N` that errors are weighed by, not less than the floor.
    fn error_covariance(&self) -> Mat<f64> {
        let mut mean = &self.scatter.sum * faer::Scale(1.0 / self.scatter.instants as f64);
        self.floor.iter().enumerate().for_each(|(i, floor)| mean[(i, i)] += floor);
        mean
    }

    /// Iterates to a minimum, or `limit` times in all.
    pub(crate) fn run(&mut self, limit: usize) -> Result<Termination, IdentError> {
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
        let innovations = self.model.innovations(self.data)?;
        let predictor = self.predictor(&innovations)?;
        let states = self.model.all_states(&self.x0, self.data);
        if self.misses {
            self.scatter = predictor.scatter(self.data, &states, &[]);
        }
        let basis = self.model.directions(&innovations, self.data, &states)?;
        let instants = self.scatter.instants as f64;
        let whitening = whitening(self.error_covariance().as_ref())?;
        let lineariser = Lineariser {
            predictor: &predictor,
            free: self.model.free(),
            basis: basis.as_ref(),
            whitening: whitening.as_ref(),
            initial: self.estimated,
        };
        let linearised = lineariser.over(self.data, &states);
        check_finite(&linearised.factor)?;
        let equations = self.equations(&linearised.factor);
        let cost = weighted(&self.scatter.sum, &whitening) + prior_cost(&self.model);
        let statistical = match self.model.entries() {
            Some(_) => STATISTICAL_TOLERANCE,
            None => STATISTICAL_TOLERANCE_OF_SMALL_STEPS,
        };
        let negligible = DECREASE_TOLERANCE.max(statistical / instants) * cost;
        let mut growth = 4.0;
        loop {
            let (step, expected) = damped_step(&equations, self.damping)?;
            let further = self.extrapolated(&step, &basis, &equations);
            let cost_of = |(model, _, scatter): &Tried<M>| weighted(&scatter.sum, &whitening) + prior_cost(model);
            let mut best = None;
            for step in [Some(&step), further.as_ref()].into_iter().flatten() {
                let tried = self.tried(&predictor, &basis, step, &linearised.initial_steps(step)?);
                let least = best.as_ref().map_or(cost, cost_of);
                best = tried.filter(|tried| cost_of(tried) < least).or(best);
            }
            if let Some(best) = best {
                let gained = cost - cost_of(&best);
                if let Some(at) = self.model.entries() {
                    self.extrapolation.remember(at, change(&basis, &step));
                }
                (self.model, self.x0, self.scatter) = best;
                self.damping = (self.damping / 10.0).max(LEAST_DAMPING);
                return Ok((gained <= negligible).then_some(Termination::SmallDecrease));
            }
            if expected <= negligible {
                return Ok(Some(Termination::SmallDecrease));
            }
            self.damping *= growth;
            growth *= 2.0;
            if self.damping > 1e12 {
                return Ok(Some(Termination::NoDescent));
            }
        }
    }

    /// Where this step and the last ones lead, if the search has come that far.
    fn extrapolated(&self, step: &[f64], basis: &Mat<f64>, equations: &Mat<f64>) -> Option<Vec<f64>> {
        let at = self.model.entries()?;
        self.extrapolation.step(&at, step, basis.as_ref(), equations.subcols(0, step.len())).ok().flatten()
    }

    /// `[Ψ, ε]` in few rows, those of the prior below, columns of blocked directions zero.
    fn equations(&self, factor: &Mat<f64>) -> Mat<f64> {
        let (rows, n) = (factor.nrows(), factor.ncols() - 1);
        let prior = self.model.prior();
        let mut all = Mat::zeros(rows + prior.len(), n + 1);
        all.subrows_mut(0, rows).copy_from(factor);
        for (j, (weight, target)) in prior.iter().enumerate() {
            (all[(rows + j, j)], all[(rows + j, n)]) = (*weight, *target);
        }
        for j in 0..n {
            let towards: f64 = (0..all.nrows()).map(|i| all[(i, j)] * all[(i, n)]).sum();
            if self.model.blocked(j, towards) {
                all.col_mut(j).fill(0.0);
            }
        }
        all
    }

    /// The model, initial states and scatter after a step, where they can be had. Errors keep the weights that they
    /// have `now`: with those of the model tried, the search would prefer models that take errors after a gap for
    /// uncertain.
    fn tried(&self, now: &Predictor, basis: &Mat<f64>, step: &[f64], initial: &[Vec<f64>]) -> Option<Tried<M>> {
        let model = self.model.moved(basis, step)?;
        let mut x0 = self.x0.clone();
        x0.iter_mut().zip(initial).for_each(|(x, by)| x.iter_mut().zip(by).for_each(|(x, by)| *x += by));
        let innovations = model.innovations(self.data).ok()?;
        if self.forgets_worse(&innovations) {
            return None;
        }
        let predictor = self.predictor(&innovations).ok()?.weighed_as(now);
        let scatter = predictor.scatter(self.data, &model.all_states(&x0, self.data), &[]);
        scatter.sum.norm_max().is_finite().then_some((model, x0, scatter))
    }

    /// Returns true if a predictor with a noise model does not forget its initial state, and forgets it less than the
    /// one now. On other data its errors would grow without bound, however well it does on these.
    fn forgets_worse(&self, tried: &Innovations) -> bool {
        let radius = |of: &Innovations| predictor_radius(of).unwrap_or(f64::INFINITY);
        if tried.k().norm_max() == 0.0 {
            return false;
        }
        let reached = radius(tried);
        reached >= 1.0 && self.model.innovations(self.data).is_ok_and(|now| reached > radius(&now))
    }
}

/// Largest modulus of the eigenvalues of `A − K C`.
fn predictor_radius(of: &Innovations) -> Result<f64, IdentError> {
    let system = of.system();
    spectral_radius((system.a() - of.k() * system.c()).as_ref())
}

/// Squares of a small part of each output's root mean square; nothing for a single output, whose weight has no part.
fn weight_floor(data: &Dataset) -> Vec<f64> {
    if data.outputs() == 1 {
        return vec![0.0];
    }
    let mean_square = |i: usize| {
        let known = data.experiments().iter().flat_map(|e| e.output(i)).filter(|y| !y.is_nan());
        let (sum, count) = known.fold((0.0, 0_usize), |(sum, count), y| (sum + y * y, count + 1));
        sum / count.max(1) as f64
    };
    (0..data.outputs()).map(|i| WEIGHT_FLOOR * WEIGHT_FLOOR * mean_square(i)).collect()
}

fn prior_cost(model: &impl Searchable) -> f64 {
    model.prior().iter().map(|(_, target)| target * target).sum()
}

/// `tr Λ⁻¹ Σ ε εᵀ`.
fn weighted(sum: &Mat<f64>, whitening: &Mat<f64>) -> f64 {
    let white = whitening * sum * whitening.transpose();
    (0..white.nrows()).map(|i| white[(i, i)]).sum()
}

/// Minimiser of `‖ε − Ψ δ‖² + λ ‖D δ‖²`, `D` the lengths of the columns of Ψ, and by how much it makes `‖ε − Ψ δ‖²`
/// fall.
fn damped_step(equations: &Mat<f64>, damping: f64) -> Result<(Vec<f64>, f64), IdentError> {
    let (rows, n) = (equations.nrows(), equations.ncols() - 1);
    let (scaled, norms) = scaled_columns(equations.subcols(0, n));
    let root = damping.sqrt();
    let stacked = Mat::from_fn(rows + n, n, |i, j| match i.checked_sub(rows) {
        None => scaled[(i, j)],
        Some(k) if k == j => root,
        Some(_) => 0.0,
    });
    let right = Mat::from_fn(rows + n, 1, |i, _| if i < rows { equations[(i, n)] } else { 0.0 });
    let solution = linalg::least_norm(stacked.as_ref(), right.as_ref(), RANK_TOLERANCE)?;
    let along = &scaled * &solution;
    let expected = (0..rows).map(|i| along[(i, 0)] * (2.0 * equations[(i, n)] - along[(i, 0)])).sum();
    Ok(((0..n).map(|j| solution[(j, 0)] / norms[j]).collect(), expected))
}

#[cfg(test)]
mod tests {
    use faer::mat;
    use lti::StateSpace;
    use proptest::prelude::*;

    use super::*;

    /// A stable model, its matrices moved by these values.
    fn model(values: &[f64]) -> StateSpaceModel {
        let moved = |m: Mat<f64>, first: usize| {
            Mat::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] + values[first + i * m.ncols() + j])
        };
        let a = moved(mat![[0.8, 0.4, 0.0], [-0.4, 0.8, 0.1], [0.0, 0.0, 0.5]], 0);
        let b = moved(mat![[1.0, 0.2], [0.0, 0.5], [0.7, -1.0]], 9);
        let c = moved(mat![[1.0, 0.0, 0.4], [0.2, 0.8, 0.0]], 15);
        let system = StateSpace::discrete(a, b, c, mat![[0.0, 0.3], [0.1, 0.0]], 0.1).unwrap();
        let k = moved(mat![[0.2, 0.1], [0.0, 0.3], [0.1, 0.0]], 21);
        StateSpaceModel::new(Innovations::new(system, k, Mat::identity(2, 2)).unwrap(), true, true)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]

        /// Those of the parameters, and of the initial state where it is estimated.
        #[test]
        fn prop_gradient_equals_finite_differences(
            values in prop::collection::vec(-0.05_f64..0.05, 27),
            start in prop::collection::vec(-2.0_f64..2.0, 3),
            signals in prop::collection::vec(-1.0_f64..1.0, 4 * 120),
            estimated in any::<bool>(),
        ) {
            let table = |first: usize| Mat::from_fn(120, 2, |i, j| signals[(first + j) * 120 + i]);
            let data = Dataset::new(0.1, table(0), table(2)).unwrap();
            let (model, x0) = (model(&values), [start]);
            let count = model.parameters().len();
            let (basis, whitening) = (Mat::<f64>::identity(count, count), Mat::<f64>::identity(2, 2));
            let states = if estimated { 3 } else { 0 };
            let lineariser = Lineariser {
                predictor: &Predictor::new(model.innovations()),
                free: StateSpaceModel::free(&model),
                basis: basis.as_ref(),
                whitening: whitening.as_ref(),
                initial: states,
            };
            let linearised = lineariser.over(&data, &x0);
            let (top, rest, last) = (&linearised.tops[0], &linearised.factor, states + count);
            let cost = |j: usize, by: f64| {
                let (mut x0, mut parameters) = (x0.clone(), model.parameters());
                *(if j < states { &mut x0[0][j] } else { &mut parameters[j - states] }) += by;
                let moved = model.with_parameters(&parameters).unwrap();
                let sum = Predictor::new(moved.innovations()).scatter(&data, &x0, &[]).sum;
                sum[(0, 0)] + sum[(1, 1)]
            };
            for j in 0..last {
                let of_state: f64 = (0..states).map(|i| top[(i, j)] * top[(i, last)]).sum();
                let of_rest = |p: usize| (0..=p).map(|i| rest[(i, p)] * rest[(i, count)]).sum::<f64>();
                let analytic = of_state + j.checked_sub(states).map_or(0.0, of_rest);
                // The errors fall by Ψ δ, so the cost falls by 2 εᵀΨ δ.
                let numeric = -(cost(j, 1e-6) - cost(j, -1e-6)) / 4e-6;
                prop_assert!((analytic - numeric).abs() < 1e-5 * (1.0 + numeric.abs()), "{j}: {analytic} {numeric}");
            }
        }
    }
}
