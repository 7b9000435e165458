//! The shaft's side: K, B, skews, J_d.

use faer::{Mat, MatMut};
use ident::{Bounds, IdentError, Minimum, NonlinearOptions, ResidualModel, minimise};
use rig::results::Quantity;
use signal::Complex64;

use super::lines::{DYNO_WAVES, ENGINE_WAVES, Lines, Orders, Row, SIGNALS};
use crate::shaft::{DYNO, ECCENTRICITY, ENGINE, LARGEST_SKEW_S, TORQUE};
use crate::shaft_routes::multisine::cost::{CostTest, cost_test};

/// Steps of differences, as a part of a parameter's size.
const STEP: f64 = 1e-5;

pub(super) const STIFFNESS: usize = 0;
pub(super) const DAMPING: usize = 1;
pub(super) const ENGINE_SKEW: usize = 2;
pub(super) const TORQUE_SKEW: usize = 3;
pub(super) const INERTIA: usize = 4;
/// Once-a-turn errors of ω_d and ω_e.
pub(super) const DYNO_TURN: [usize; 2] = [5, 6];
pub(super) const ENGINE_TURN: [usize; 2] = [7, 8];
pub(super) const COUNT: usize = 9;

/// Sizes that differences are measured by where a parameter is small: K, B, skews, J_d, once-a-turn errors.
pub(super) const SIZES: [f64; COUNT] = [1.0, 0.1, 1e-3, 1e-3, 1e-2, 1e-3, 1e-3, 1e-3, 1e-3];

/// The shaft's equation at the lines.
#[derive(Clone, Copy)]
pub(super) struct Shaft<'a> {
    pub(super) lines: &'a Lines,
    pub(super) gate_s: f64,
    pub(super) stated: f64,
    /// J_d and its standard uncertainty where it is known.
    pub(super) prior: Option<(f64, f64)>,
}

impl Shaft<'_> {
    /// The coefficients of ω_d, ω_e and T_d.
    fn equation(&self, s: Complex64, theta: &[f64]) -> Row {
        let one = Complex64::from(1.0);
        let [k, b, inertia] = [theta[STIFFNESS], theta[DAMPING], theta[INERTIA]];
        let late = (s * theta[ENGINE_SKEW]).exp();
        let engine = [-late * k, -late * b, 0.0 * one];
        self.with_turns(s, theta, [one * k, one * b, one * inertia], engine)
    }

    /// An equation of the torque's first derivative, from what it does to the two speeds.
    pub(super) fn with_turns(&self, s: Complex64, theta: &[f64], dyno: Orders, engine: Orders) -> Row {
        let mut row = [[Complex64::default(); 3]; SIGNALS];
        (row[DYNO], row[ENGINE]) = (dyno, engine);
        row[TORQUE][1] = self.torque_factor(s, theta);
        for k in 0..2 {
            row[DYNO_WAVES[k]] = dyno.map(|c| -theta[DYNO_TURN[k]] * c);
            row[ENGINE_WAVES[k]] = engine.map(|c| -theta[ENGINE_TURN[k]] * c);
        }
        row
    }

    /// Factor that turns the torque's transform into that of its mean over the gate.
    fn torque_factor(&self, s: Complex64, theta: &[f64]) -> Complex64 {
        let x = s * self.gate_s;
        let gate = if x.norm() < 1e-9 { Complex64::from(1.0) } else { (1.0 - (-x).exp()) / x };
        gate * (s * theta[TORQUE_SKEW]).exp()
    }

    /// Errors with their averaged variances.
    fn errors(&self, theta: &[f64]) -> Vec<(Complex64, f64)> {
        let n = self.lines.count();
        let mut shapes = Vec::with_capacity(n);
        let raw: Vec<(Complex64, f64)> = (0..n)
            .map(|k| {
                let c = self.equation(self.lines.s(k), theta);
                // What equal white noise of both encoders would have.
                let power = |orders: Orders| {
                    orders.iter().rev().fold(Complex64::default(), |sum, c| sum * self.lines.s(k) + c).norm_sqr()
                };
                shapes.push(power(c[DYNO]) + power(c[ENGINE]));
                self.lines.error(k, &c)
            })
            .collect();
        let width = 2 * self.lines.reach + 1;
        let averaged = |k: usize| {
            let first = k.saturating_sub(self.lines.reach).min(n - width);
            let sum: f64 = (first..first + width).map(|j| raw[j].1 / shapes[j]).sum();
            shapes[k] * sum / width as f64
        };
        (0..n).map(|k| (raw[k].0, averaged(k).max(f64::MIN_POSITIVE))).collect()
    }

    pub(super) fn fit(&mut self) -> Result<(Minimum, Mat<f64>), IdentError> {
        let start = self.start();
        let positive = Bounds::new(0.0, f64::INFINITY);
        let skew = Bounds::new(-LARGEST_SKEW_S, LARGEST_SKEW_S);
        let mut bounds = [Bounds::NONE; COUNT];
        bounds[..=INERTIA].copy_from_slice(&[positive, positive, skew, skew, positive]);
        if let Some((value, 0.0)) = self.prior {
            bounds[INERTIA] = Bounds::new(value, value);
        }
        let fit = minimise(self, &start, &bounds, NonlinearOptions::default())?;
        let nu = self.lines.freedom();
        let inflation = if nu > 2.0 { nu / (nu - 2.0) } else { nu };
        let covariance = faer::Scale(inflation) * &fit.unscaled_covariance;
        Ok((fit, covariance))
    }

    /// The test of the cost; what is known of J_d and of the encoders beforehand counts for itself.
    pub(super) fn cost(&self, fit: &Minimum) -> CostTest {
        let (residuals, known) = fit.residuals.split_at(2 * self.lines.count());
        let from_prior = known.iter().filter(|r| **r != 0.0).count();
        let free = fit.at_bound.iter().filter(|b| !**b).count().saturating_sub(from_prior);
        let squares: f64 = residuals.iter().map(|r| r * r).sum();
        cost_test(0.5 * squares, (residuals.len() as f64 - free as f64).max(1.0), self.lines.freedom())
    }

    /// K and B by least squares without skew, J_d as stated.
    fn start(&self) -> [f64; COUNT] {
        let (mut left, mut right) = ([[0.0; 2]; 2], [0.0; 2]);
        for k in 0..self.lines.count() {
            let (s, z) = (self.lines.s(k), self.lines.mean(k));
            let twist = z[ENGINE][0] - z[DYNO][0];
            let rate = self.stated * z[DYNO][2] + self.torque_factor(s, &[0.0; COUNT]) * z[TORQUE][1];
            let regressors = [twist, s * twist];
            for i in 0..2 {
                right[i] += (regressors[i].conj() * rate).re / s.norm_sqr();
                (0..2).for_each(|j| left[i][j] += (regressors[i].conj() * regressors[j]).re / s.norm_sqr());
            }
        }
        let determinant = left[0][0] * left[1][1] - left[0][1] * left[1][0];
        let stiffness = (right[0] * left[1][1] - right[1] * left[0][1]) / determinant;
        let damping = (left[0][0] * right[1] - left[1][0] * right[0]) / determinant;
        let sane = |value: f64, least: f64| if value.is_finite() { value.max(least) } else { least };
        let mut start = [0.0; COUNT];
        (start[STIFFNESS], start[DAMPING], start[INERTIA]) = (sane(stiffness, 1.0), sane(damping, 1e-2), self.stated);
        start
    }

    /// Parameters that people read, with their places.
    pub(super) fn read(&self) -> Vec<(Quantity, usize)> {
        let mut chosen = vec![(Quantity::Stiffness, STIFFNESS), (Quantity::Damping, DAMPING)];
        if self.prior.is_none_or(|(_, uncertainty)| uncertainty > 0.0) {
            chosen.push((Quantity::DynoInertia, INERTIA));
        }
        chosen.extend([(Quantity::EngineSpeedSkew, ENGINE_SKEW), (Quantity::TorqueSkew, TORQUE_SKEW)]);
        chosen
    }
}

impl ResidualModel for Shaft<'_> {
    fn parameter_count(&self) -> usize {
        COUNT
    }

    fn residual_count(&self) -> usize {
        2 * self.lines.count() + 5
    }

    /// √2 e/σ, real and imaginary part in turn, each of variance one; then what is known of J_d and of the encoders.
    fn evaluate(
        &mut self,
        theta: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        let shaft = *self;
        let at = |theta: &[f64], values: &mut [f64]| {
            for (k, (error, variance)) in shaft.errors(theta).into_iter().enumerate() {
                let value = error * (2.0 / variance).sqrt();
                (values[2 * k], values[2 * k + 1]) = (value.re, value.im);
            }
            let known = 2 * shaft.lines.count();
            values[known] = match shaft.prior {
                Some((value, uncertainty)) if uncertainty > 0.0 => (theta[INERTIA] - value) / uncertainty,
                _ => 0.0,
            };
            let turns = values[known + 1..].iter_mut().zip(&theta[DYNO_TURN[0]..]);
            turns.for_each(|(value, amplitude)| *value = amplitude / ECCENTRICITY);
        };
        at(theta, residuals);
        if let Some(jacobian) = jacobian {
            differences(theta, &SIZES, residuals.len(), at, jacobian);
        }
        Ok(())
    }
}

/// Central differences of residuals.
pub(super) fn differences(
    theta: &[f64],
    sizes: &[f64],
    count: usize,
    at: impl Fn(&[f64], &mut [f64]),
    mut jacobian: MatMut<'_, f64>,
) {
    let (mut above, mut below) = (vec![0.0; count], vec![0.0; count]);
    for j in 0..theta.len() {
        let step = STEP * theta[j].abs().max(sizes[j]);
        let mut point = theta.to_vec();
        point[j] = theta[j] + step;
        at(&point, &mut above);
        point[j] = theta[j] - step;
        at(&point, &mut below);
        for i in 0..count {
            jacobian[(i, j)] = (above[i] - below[i]) / (2.0 * step);
        }
    }
}
