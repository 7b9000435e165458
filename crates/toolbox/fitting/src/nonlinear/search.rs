//! The search itself: damped steps over the parameters that no bound holds.

use faer::Mat;
use numerics::linalg::Qr;

use super::problem::{Bounds, Lowest, LowestPoint, NonlinearOptions, SumOfSquares};
use crate::condition::checked_condition;
use crate::{IdentError, Termination, Triangle};

const FIRST_DAMPING: f64 = 1e-3;
const LARGEST_DAMPING: f64 = 1e20;
/// A step is missed where the cost was expected to fall by more than this fraction.
const WORTHWHILE: f64 = 1e-6;

/// A small step is the last where it lowers the cost by less than this fraction.
const UNNOTICED: f64 = 1e-10;

/// State of one search: the current point, its factor, and the damping.
pub(super) struct Search<'a, O> {
    objective: &'a mut O,
    bounds: &'a [Bounds],
    parameters: Vec<f64>,
    /// Triangular factor of [J ε] over all parameters.
    factor: Mat<f64>,
    cost: f64,
    /// Largest column norms of the Jacobian met so far (Moré's scaling).
    scale: Vec<f64>,
    damping: f64,
    /// True if there was no model where a step led, and no step has gone nearly undamped since.
    stopped: bool,
    iterations: usize,
}

/// Outcome of one attempted step.
enum Attempt {
    Accepted { relative_step: f64, relative_decrease: f64 },
    Rejected { predicted_decrease: f64, relative_step: f64 },
}

impl<'a, O: SumOfSquares> Search<'a, O> {
    pub(super) fn new(objective: &'a mut O, start: &[f64], bounds: &'a [Bounds]) -> Result<Self, IdentError> {
        let factor = objective.factor(start)?;
        let columns = start.len();
        let mut search = Search {
            objective,
            bounds,
            parameters: start.to_vec(),
            cost: factor.col(columns).squared_norm_l2(),
            factor,
            scale: vec![0.0; columns],
            damping: FIRST_DAMPING,
            stopped: false,
            iterations: 0,
        };
        search.update_scale();
        Ok(search)
    }

    /// `None` where the search was given up as idle.
    pub(super) fn run(
        &mut self,
        options: NonlinearOptions,
        idle: impl Fn(&[f64], f64) -> bool,
    ) -> Result<Option<Termination>, IdentError> {
        while self.iterations < options.iteration_limit {
            if idle(&self.parameters, self.cost) {
                return Ok(None);
            }
            self.iterations += 1;
            let free = self.free_parameters();
            let factor = self.factor_over(&free);
            if let Some(end) = self.descend(&free, &factor, options)? {
                return Ok(Some(end));
            }
        }
        Ok(Some(Termination::IterationLimit))
    }

    /// Tries growing damping until a step is accepted; `Some` when the search is over.
    fn descend(
        &mut self,
        free: &[usize],
        factor: &Mat<f64>,
        options: NonlinearOptions,
    ) -> Result<Option<Termination>, IdentError> {
        let mut growth = 2.0;
        loop {
            let attempt = self.attempt(free, factor)?;
            if let Some(end) = self.ended_by(&attempt, options) {
                let edge = self.stopped && self.promised_decrease(free, factor) > WORTHWHILE;
                return Ok(Some(if edge { Termination::Edge } else { end }));
            }
            if let Attempt::Accepted { .. } = attempt {
                self.stopped &= self.damping > 1.0;
                return Ok(None);
            }
            self.damping *= growth;
            growth *= 2.0;
        }
    }

    /// The end that an attempt means, if any.
    fn ended_by(&self, attempt: &Attempt, options: NonlinearOptions) -> Option<Termination> {
        match *attempt {
            // Parameters that are barely told apart lower the cost by steps that look negligible.
            Attempt::Accepted { relative_step, relative_decrease } => {
                let small = relative_step <= options.step_tolerance && (self.stopped || relative_decrease <= UNNOTICED);
                let flat = (relative_decrease <= options.cost_tolerance).then_some(Termination::SmallDecrease);
                if small { Some(Termination::SmallStep) } else { flat }
            }
            Attempt::Rejected { predicted_decrease, .. } if predicted_decrease <= options.cost_tolerance => {
                Some(Termination::SmallDecrease)
            }
            Attempt::Rejected { relative_step, .. } if relative_step <= options.step_tolerance => {
                Some(Termination::SmallStep)
            }
            Attempt::Rejected { .. } => (self.damping > LARGEST_DAMPING).then_some(Termination::NoDescent),
        }
    }

    /// Decrease of the cost by a step with next to no damping, as a fraction, were the residuals linear.
    fn promised_decrease(&self, free: &[usize], factor: &Mat<f64>) -> f64 {
        let n = factor.ncols() - 1;
        let cost = (0..factor.nrows()).map(|i| factor[(i, n)].powi(2)).sum::<f64>();
        predicted_decrease(factor, &self.damped_step(free, factor, FIRST_DAMPING)) / cost.max(f64::MIN_POSITIVE)
    }

    fn attempt(&mut self, free: &[usize], factor: &Mat<f64>) -> Result<Attempt, IdentError> {
        work::checkpoint();
        let step = self.damped_step(free, factor, self.damping);
        let mut trial = self.parameters.clone();
        for (position, j) in free.iter().enumerate() {
            trial[*j] = self.bounds[*j].clamp(trial[*j] + step[position]);
        }
        let moved: Vec<f64> = free.iter().map(|j| trial[*j] - self.parameters[*j]).collect();
        let relative_step = self.relative_step(free, &moved);
        let cost = self.objective.cost(&trial).unwrap_or(f64::INFINITY);
        self.stopped |= !cost.is_finite();
        if cost.is_nan() || cost >= self.cost {
            // Of the whole step: the part of it within the bounds may promise nothing where a shorter step would.
            let predicted_decrease = predicted_decrease(factor, &step).max(0.0) / self.cost.max(f64::MIN_POSITIVE);
            return Ok(Attempt::Rejected { predicted_decrease, relative_step });
        }
        let predicted = predicted_decrease(factor, &moved).max(0.0);
        let ratio = (self.cost - cost) / predicted.max(f64::MIN_POSITIVE);
        self.damping *= (1.0 - (2.0 * ratio - 1.0).powi(3)).clamp(1.0 / 3.0, 2.0);
        let relative_decrease = (self.cost - cost) / self.cost;
        self.factor = self.objective.factor(&trial)?;
        (self.parameters, self.cost) = (trial, cost);
        self.update_scale();
        Ok(Attempt::Accepted { relative_step, relative_decrease })
    }

    /// Triangular factor of [J ε] over the free parameters.
    fn factor_over(&self, free: &[usize]) -> Mat<f64> {
        let last = self.parameters.len();
        if free.len() == last {
            return self.factor.clone();
        }
        let mut triangle = Triangle::new(free.len() + 1);
        for i in 0..=last {
            let row: Vec<f64> = free.iter().chain([&last]).map(|j| self.factor[(i, *j)]).collect();
            triangle.push_row(&row);
        }
        triangle.finish()
    }

    /// Minimiser of ‖J δ + ε‖² + λ‖D δ‖².
    fn damped_step(&self, free: &[usize], factor: &Mat<f64>, damping: f64) -> Vec<f64> {
        let n = free.len();
        let root = damping.sqrt();
        let stacked = Mat::from_fn(2 * n, n, |i, j| match i.checked_sub(n) {
            None => factor[(i, j)] / self.scale[free[j]],
            Some(k) if k == j => root,
            Some(_) => 0.0,
        });
        let right = Mat::from_fn(2 * n, 1, |i, _| if i < n { -factor[(i, n)] } else { 0.0 });
        let solution = Qr::new(stacked.as_ref()).least_squares(right.as_ref());
        (0..n).map(|j| solution[(j, 0)] / self.scale[free[j]]).collect()
    }

    /// Parameters not pressed against a bound by the descent direction.
    fn free_parameters(&self) -> Vec<usize> {
        (0..self.parameters.len())
            .filter(|j| {
                let last = self.parameters.len();
                let gradient: f64 = (0..=*j).map(|i| self.factor[(i, *j)] * self.factor[(i, last)]).sum();
                let Bounds { lower, upper } = self.bounds[*j];
                let pressed_down = self.parameters[*j] <= lower && gradient > 0.0;
                let pressed_up = self.parameters[*j] >= upper && gradient < 0.0;
                !(pressed_down || pressed_up || lower == upper)
            })
            .collect()
    }

    fn relative_step(&self, free: &[usize], moved: &[f64]) -> f64 {
        let size = |j: usize, value: f64| self.scale[j] * value;
        let step: f64 = free.iter().zip(moved).map(|(j, m)| size(*j, *m).powi(2)).sum::<f64>().sqrt();
        let point: f64 = free.iter().map(|j| size(*j, self.parameters[*j]).powi(2)).sum::<f64>().sqrt();
        step / point.max(f64::MIN_POSITIVE)
    }

    fn update_scale(&mut self) {
        for (j, scale) in self.scale.iter_mut().enumerate() {
            *scale = scale.max(self.factor.col(j).norm_l2());
            if *scale == 0.0 {
                *scale = 1.0;
            }
        }
    }

    /// Where it is, whatever the data separate there.
    pub(super) fn point(self, termination: Termination) -> LowestPoint {
        let Search { parameters, cost, iterations, .. } = self;
        LowestPoint { parameters, cost, termination, iterations }
    }

    pub(super) fn finish(self, termination: Termination) -> Result<Lowest, IdentError> {
        let free = self.free_parameters();
        let factor = self.factor_over(&free);
        let (n, total) = (free.len(), self.parameters.len());
        let norms: Vec<f64> = (0..n).map(|j| factor.col(j).norm_l2()).collect();
        let scaled = Mat::from_fn(n, n, |i, j| if norms[j] > 0.0 { factor[(i, j)] / norms[j] } else { 0.0 });
        let condition = if n == 0 { 1.0 } else { checked_condition(scaled.as_ref())? };
        let inverse = Qr::new(scaled.as_ref()).least_squares(Mat::identity(n, n).as_ref());
        let product = &inverse * inverse.transpose();
        let mut unscaled_covariance = Mat::zeros(total, total);
        for (a, i) in free.iter().enumerate() {
            for (b, j) in free.iter().enumerate() {
                unscaled_covariance[(*i, *j)] = product[(a, b)] / (norms[a] * norms[b]);
            }
        }
        Ok(Lowest {
            at_bound: (0..total).map(|j| !free.contains(&j)).collect(),
            parameters: self.parameters,
            factor: self.factor,
            unscaled_covariance,
            cost: self.cost,
            iterations: self.iterations,
            termination,
            condition,
        })
    }
}

/// ‖ε‖² − ‖ε + J δ‖², from the factor of [J ε].
fn predicted_decrease(factor: &Mat<f64>, step: &[f64]) -> f64 {
    let n = step.len();
    let mut decrease = 0.0;
    for i in 0..n {
        let along: f64 = (i..n).map(|j| factor[(i, j)] * step[j]).sum();
        decrease -= along * (along + 2.0 * factor[(i, n)]);
    }
    decrease
}
