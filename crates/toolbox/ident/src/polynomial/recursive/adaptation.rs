//! Gains: how far a prediction error moves the parameters.

use faer::Mat;

use super::diffuse::Information;
use super::ud::UdFactor;
use super::weights::SquaredWeights;
use crate::IdentError;
use crate::data::check_range;

/// A variance that has grown by this factor since the start stops growing: nothing excites that parameter any more.
const GROWTH: f64 = 1e12;

/// How parameters are thought to change.
#[derive(Debug, Clone, PartialEq)]
pub enum Adaptation {
    /// A sample counts less by `λ` with every sample after it, 0 < λ ≤ 1: a memory of `1/(1 − λ)` samples. One for
    /// parameters that stay.
    Forgetting(f64),
    /// A Kalman filter: every parameter takes a random step a sample.
    RandomWalk {
        /// Standard deviation of the step of each parameter, zero for one that stays; in the order of the parameters.
        drift: Vec<f64>,
        /// Variance of the prediction errors.
        noise_variance: f64,
    },
    /// A step along the gradient, `θ += μ ψ ε/|ψ|²`, 0 < μ < 2; small steps for noisy data. Cheap and without a
    /// covariance.
    NormalisedGradient(
        /// μ.
        f64,
    ),
}

#[derive(Debug, Clone)]
enum State {
    /// Gathering the first samples.
    Starting(Information),
    Running(UdFactor),
    Gradient,
}

/// The running gain.
#[derive(Debug, Clone)]
pub(super) struct Gain {
    adaptation: Adaptation,
    state: State,
    /// Parameters that the start determines: those of the ARX model, which come first.
    starting_count: usize,
    count: usize,
    /// How many poles further inputs share with the first, in an output-error model.
    shared_poles: Option<usize>,
    drift_variances: Vec<f64>,
    /// Variances that are not to be exceeded.
    limits: Vec<f64>,
    /// Source of the errors of the parameters, where samples are forgotten.
    squared_weights: SquaredWeights,
    /// Weighted sums of squared errors and of ones.
    squares: f64,
    weight: f64,
    /// Running mean of |ψ|².
    power: f64,
}

impl Gain {
    pub(super) fn new(
        adaptation: Adaptation,
        count: usize,
        starting_count: usize,
        shared_poles: Option<usize>,
    ) -> Result<Self, IdentError> {
        let mut drift_variances = Vec::new();
        let mut state = State::Starting(Information::new(starting_count));
        match &adaptation {
            Adaptation::Forgetting(factor) => check_range("forgetting factor", *factor, 1e-3, 1.0)?,
            Adaptation::RandomWalk { drift, noise_variance } => {
                if drift.len() != count {
                    return Err(IdentError::Length { what: "drift", expected: count, found: drift.len() });
                }
                check_range("noise variance", *noise_variance, f64::MIN_POSITIVE, f64::MAX)?;
                drift.iter().try_for_each(|d| check_range("drift", *d, 0.0, f64::MAX))?;
                drift_variances = drift.iter().map(|d| d * d).collect();
            }
            Adaptation::NormalisedGradient(step) => {
                check_range("gradient step", *step, f64::MIN_POSITIVE, 2.0)?;
                state = State::Gradient;
            }
        }
        let limits = vec![f64::INFINITY; count];
        let (squares, weight, power) = (0.0, 0.0, 0.0);
        Ok(Gain {
            adaptation,
            state,
            starting_count,
            count,
            shared_poles,
            drift_variances,
            limits,
            squared_weights: SquaredWeights::new(count),
            squares,
            weight,
            power,
        })
    }

    pub(super) fn has_started(&self) -> bool {
        !matches!(self.state, State::Starting(_))
    }

    fn forgetting(&self) -> f64 {
        if let Adaptation::Forgetting(factor) = self.adaptation { factor } else { 1.0 }
    }

    /// Moves the parameters by a prediction error whose gradient is `psi`.
    pub(super) fn update(&mut self, parameters: &mut [f64], psi: &[f64], error: f64, output: f64) {
        let forgetting = self.forgetting();
        self.weight = forgetting * self.weight + 1.0;
        match &mut self.state {
            State::Starting(information) => {
                information.push(&psi[..self.starting_count], output, forgetting);
                self.squared_weights.push(&psi[..self.starting_count], forgetting);
                if let Some((solution, root, squares)) = information.solve() {
                    parameters[..self.starting_count].copy_from_slice(&solution);
                    self.squares = squares;
                    self.begin(&root);
                }
            }
            State::Running(factor) => {
                let after = match self.adaptation {
                    Adaptation::RandomWalk { noise_variance, .. } => {
                        factor.diffuse(&self.drift_variances);
                        (noise_variance, 1.0)
                    }
                    _ if factor.diagonal().iter().zip(&self.limits).any(|(d, limit)| d > limit) => (1.0, 1.0),
                    _ => (forgetting, forgetting),
                };
                let (r, divisor) = after;
                self.squared_weights.push(psi, divisor);
                let (gain, alpha) = factor.measure(psi, r);
                parameters.iter_mut().zip(gain).for_each(|(p, g)| *p += g * error);
                factor.scale(1.0 / divisor);
                self.squares = forgetting * self.squares + error * error * r / alpha;
            }
            State::Gradient => {
                let Adaptation::NormalisedGradient(step) = self.adaptation else { return };
                let size: f64 = psi.iter().map(|v| v * v).sum();
                self.power += (size - self.power) / self.weight;
                self.squares += error * error;
                // A regressor of next to nothing must not be divided by.
                let share = step / size.max(1e-3 * self.power).max(f64::MIN_POSITIVE);
                parameters.iter_mut().zip(psi).for_each(|(p, v)| *p += share * v * error);
            }
        }
    }

    /// Ends the start: `root` is that of the covariance of the first parameters for noise of variance one.
    fn begin(&mut self, root: &Mat<f64>) {
        let noise = match self.adaptation {
            Adaptation::RandomWalk { noise_variance, .. } => noise_variance,
            _ => 1.0,
        };
        // The noise model's coefficients are about one at most, and their regressors are the errors themselves.
        let own = self.squares / (self.weight - self.starting_count as f64).max(1.0);
        let free = if own > 0.0 { (noise / own).sqrt() } else { 0.0 };
        let n = self.starting_count;
        let further = |i: usize| match self.shared_poles {
            // The poles of a further input are as uncertain as those found, which are the last of the start.
            Some(poles) => (0..n).map(|k| root[(n - poles + (i - n) % poles, k)].powi(2) * noise).sum::<f64>().sqrt(),
            None => free.max(1e-150),
        };
        let whole = Mat::from_fn(self.count, self.count, |i, j| match (i < n, j < n) {
            (true, true) => root[(i, j)] * noise.sqrt(),
            (false, false) if i == j => further(i),
            _ => 0.0,
        });
        (n..self.count).for_each(|i| self.squared_weights.start_at(i, whole[(i, i)].powi(2)));
        let factor = UdFactor::from_upper_root(&whole);
        self.limits = factor.diagonal().iter().map(|d| GROWTH * d).collect();
        self.state = State::Running(factor);
    }

    /// The sum of squares over its expected value for errors of variance one, `Σ w − tr P Q` (`Q` is that of
    /// [`SquaredWeights`]): without forgetting the number of errors less that of the parameters.
    pub(super) fn noise_variance(&self) -> f64 {
        match &self.state {
            State::Starting(_) => f64::NAN,
            State::Gradient => self.squares / self.weight.max(1.0),
            State::Running(factor) => {
                let taken = if self.forgetting() < 1.0 {
                    self.squared_weights.trace_with(&factor.covariance())
                } else {
                    self.count as f64
                };
                let freedom = self.weight - taken;
                // A memory shorter than the number of parameters says nothing of the noise.
                if freedom > 0.0 { self.squares / freedom } else { f64::INFINITY }
            }
        }
    }

    /// Standard error of every parameter; NaN where there is none.
    pub(super) fn standard_errors(&self) -> Vec<f64> {
        match self.covariance() {
            Some(covariance) => (0..self.count).map(|j| covariance[(j, j)].sqrt()).collect(),
            None => vec![f64::NAN; self.count],
        }
    }

    pub(super) fn covariance(&self) -> Option<Mat<f64>> {
        let State::Running(factor) = &self.state else { return None };
        let p = factor.covariance();
        match self.adaptation {
            Adaptation::Forgetting(1.0) => Some(faer::Scale(self.noise_variance()) * p),
            Adaptation::Forgetting(_) => Some(faer::Scale(self.noise_variance()) * self.squared_weights.sandwich(&p)),
            _ => Some(p),
        }
    }
}
