//! Input and output as answers to the reference, and the plant as their ratio.

use std::f64::consts::TAU;

use faer::Mat;
use lti::{Complex64, FrequencyResponse, LtiError};

use super::{INPUT, REFERENCE, check_loop};
use crate::data::check_range;
use crate::data::regression::{Lagged, Regression};
use crate::least_squares::solve_factor;
use crate::{Dataset, IdentError};
use fitting::equation::factor_of;

/// Fits `A_u u = B_u r + e_u` and `A_y y = B_y r + e_y`, both of the same high order, and takes the plant as the ratio
/// of the responses to `r`: `G = T_y/T_u`, `T = B/A`.
///
/// At an order high enough for white `e_u` and `e_y` the estimate is consistent whatever the noise and the regulator.
/// Both errors come from the same noise; the covariance counts how they go together. A result at frequencies; for a
/// model of low order use [`super::TwoStage`], or fit these points with their variances.
///
/// # Source
/// Ljung 1999, §13.5 (joint input–output identification); covariance of equations with different regressors: Zellner,
/// *An efficient method of estimating seemingly unrelated regressions*, 1962.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JointInputOutput {
    /// Lags of every signal.
    pub order: usize,
}

impl Default for JointInputOutput {
    /// Twenty lags.
    fn default() -> Self {
        JointInputOutput { order: 20 }
    }
}

/// The plant at frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedLoopResponse {
    /// `G(e^{jωT})`.
    pub plant: FrequencyResponse,
    /// `T_u(e^{jωT})`, the sensitivity.
    pub sensitivity: FrequencyResponse,
    /// Expected squared magnitude of the error of `G`, real and imaginary part together, by the delta method.
    pub variances: Vec<f64>,
}

/// One equation, solved: past values of the signal itself, then `r` from lag zero.
struct Equation {
    parameters: Vec<f64>,
    /// (ΦᵀΦ)⁻¹.
    unscaled: Mat<f64>,
}

/// A response at a frequency, and its slope with each parameter.
struct Point {
    value: Complex64,
    slopes: Vec<Complex64>,
}

impl Equation {
    fn at(&self, order: usize, angle: f64) -> Point {
        let shift = |lag: usize| Complex64::cis(-angle * lag as f64);
        let (own, fed) = self.parameters.split_at(order);
        let a = Complex64::new(1.0, 0.0) - own.iter().enumerate().map(|(i, p)| shift(i + 1) * *p).sum::<Complex64>();
        let value = fed.iter().enumerate().map(|(i, p)| shift(i) * *p).sum::<Complex64>() / a;
        let of_own = (1..=order).map(|lag| shift(lag) * value / a);
        let slopes = of_own.chain((0..fed.len()).map(|lag| shift(lag) / a)).collect();
        Point { value, slopes }
    }
}

/// Both equations, and how their errors go together.
struct Equations {
    u: Equation,
    y: Equation,
    /// Covariance of the parameters of u with those of y.
    cross: Mat<f64>,
    /// Variances of the residuals.
    noise: [f64; 2],
}

impl JointInputOutput {
    /// The plant at frequencies in rad/s, from data with the inputs `u`, `r` and one output.
    ///
    /// # Errors
    /// [`IdentError::Structure`] for other channels; [`IdentError::TooFewSamples`]; [`IdentError::RankDeficient`];
    /// [`LtiError::Singular`] where the sensitivity vanishes at a frequency; [`signal::SignalError::Parameter`] for a
    /// frequency outside zero to half the sample rate.
    pub fn fit(&self, data: &Dataset, omega_rad_s: &[f64]) -> Result<ClosedLoopResponse, IdentError> {
        check_loop(data)?;
        check_range("order", self.order as f64, 1.0, 1e4)?;
        let equations = self.equations(data)?;
        let (mut plant, mut sensitivity, mut variances) = (Vec::new(), Vec::new(), Vec::new());
        for omega in omega_rad_s {
            let angle = omega * data.sample_time_s();
            check_range("omega_rad_s", angle / TAU, 0.0, 0.5)?;
            let (g, s, variance) = self.at(&equations, angle)?;
            plant.push(g);
            sensitivity.push(s);
            variances.push(variance);
        }
        Ok(ClosedLoopResponse {
            plant: FrequencyResponse::new(omega_rad_s.to_vec(), plant)?,
            sensitivity: FrequencyResponse::new(omega_rad_s.to_vec(), sensitivity)?,
            variances,
        })
    }

    fn equations(&self, data: &Dataset) -> Result<Equations, IdentError> {
        let signals =
            data.experiments().iter().map(|e| vec![e.input(INPUT), e.output(0), e.input(REFERENCE)]).collect();
        let past = |signal: usize, first: isize| Lagged::each(signal, first..=self.order as isize);
        let targets = [Lagged::new(0, 0), Lagged::new(1, 0)];
        let all: Vec<Lagged> = past(0, 1).chain(past(1, 1)).chain(past(2, 0)).chain(targets).collect();
        let (n, order) = (all.len() - 2, self.order);
        let regression = Regression::new(&signals, all);
        let samples = regression.rows;
        if samples <= n {
            return Err(IdentError::TooFewSamples { samples, parameters: n });
        }
        let factor = regression.factor();
        let own = [0..order, order..2 * order];
        let regressors = own.map(|own| own.chain(2 * order..n).collect::<Vec<usize>>());
        let solve = |i: usize| {
            let chosen: Vec<usize> = regressors[i].iter().copied().chain([n + i]).collect();
            solve_factor(&factor_of(&factor, &chosen), samples)
        };
        let (u, y) = (solve(0)?, solve(1)?);
        let residual = |i: usize, parameters: &[f64]| -> Vec<f64> {
            let modelled =
                |k: usize| regressors[i].iter().zip(parameters).map(|(j, p)| factor[(k, *j)] * p).sum::<f64>();
            (0..n + 2).map(|k| factor[(k, n + i)] - modelled(k)).collect()
        };
        let (of_u, of_y) = (residual(0, &u.parameters), residual(1, &y.parameters));
        let together = of_u.iter().zip(&of_y).map(|(a, b)| a * b).sum::<f64>() / u.degrees_of_freedom();
        let part = |i: usize| Mat::from_fn(n + 2, regressors[i].len(), |k, j| factor[(k, regressors[i][j])]);
        let between = part(0).transpose() * part(1);
        let cross = faer::Scale(together) * (&u.unscaled_covariance * between * &y.unscaled_covariance);
        let noise = [u.noise_variance(), y.noise_variance()];
        let u = Equation { parameters: u.parameters, unscaled: u.unscaled_covariance };
        Ok(Equations { u, y: Equation { parameters: y.parameters, unscaled: y.unscaled_covariance }, cross, noise })
    }

    /// Plant, sensitivity and the plant's variance at an angle per sample.
    fn at(&self, equations: &Equations, angle: f64) -> Result<(Complex64, Complex64, f64), IdentError> {
        let (u, y) = (equations.u.at(self.order, angle), equations.y.at(self.order, angle));
        let g = y.value / u.value;
        if !(g.re.is_finite() && g.im.is_finite()) {
            return Err(LtiError::Singular { what: "the sensitivity at a frequency" }.into());
        }
        // dG = (dT_y − G dT_u)/T_u.
        let to_y: Vec<Complex64> = y.slopes.iter().map(|s| s / u.value).collect();
        let to_u: Vec<Complex64> = u.slopes.iter().map(|s| -g * s / u.value).collect();
        let variance = equations.noise[0] * form(&to_u, &equations.u.unscaled, &to_u)
            + equations.noise[1] * form(&to_y, &equations.y.unscaled, &to_y)
            + 2.0 * form(&to_u, &equations.cross, &to_y);
        Ok((g, u.value, variance.max(0.0)))
    }
}

/// Real part of `aᵀ P b̄`.
fn form(a: &[Complex64], p: &Mat<f64>, b: &[Complex64]) -> f64 {
    let row = |i: usize| b.iter().enumerate().map(|(j, b)| b.conj() * p[(i, j)]).sum::<Complex64>();
    a.iter().enumerate().map(|(i, a)| (a * row(i)).re).sum()
}
