//! From the triangular factor to `A`, `C`, `K` and `Λ`.

use std::ops::Range;

use faer::{Mat, MatRef};
use lti::{Innovations, StateSpace};
use numerics::linalg;

use super::hankel::{Hankel, HankelFactor, Horizons};
use super::weighting::Weighting;
use crate::dense::{kalman, spectral_radius};
use crate::{Dataset, IdentError};

/// Singular values below this part of the largest are rounding.
pub(super) const ROUNDING: f64 = 1e-12;
/// Standard deviation that an output's innovations have at least, as a part of the output's size: data without noise
/// would leave the Riccati equation without a solution.
const LEAST_NOISE: f64 = 1e-9;

/// The weighted projection of the future on the past. The columns of R stand for the rows of the Hankel matrix: they
/// have the same scalar products, and there are few of their entries.
pub(super) struct Projection<'a> {
    hankel: &'a Hankel<'a>,
    factor: &'a HankelFactor,
    /// The oblique projection's rows: entries of R × (future · outputs).
    oblique: Mat<f64>,
    /// Directions of the extended observability matrix, each scaled by the square root of its singular value.
    directions: Mat<f64>,
    singular_values: Vec<f64>,
}

impl<'a> Projection<'a> {
    pub(super) fn new(
        hankel: &'a Hankel<'a>,
        factor: &'a HankelFactor,
        weighting: Weighting,
    ) -> Result<Self, IdentError> {
        let oblique = oblique(hankel, factor, hankel.horizons.past)?;
        let (m, q, p) = (hankel.inputs, hankel.channels(), hankel.outputs);
        let Horizons { past, future } = hankel.horizons;
        let (inputs, pasts, outputs) = (future * m, past * q, future * p);
        // Rows below those of the future inputs: what is orthogonal to them.
        let free = factor.r.submatrix(inputs, inputs + pasts, pasts + outputs, outputs);
        let explained = free.subrows(0, pasts);
        let (projected, back) = match weighting {
            Weighting::N4sid => (oblique.transpose().to_owned(), Mat::identity(outputs, outputs)),
            Weighting::Moesp => (explained.transpose().to_owned(), Mat::identity(outputs, outputs)),
            Weighting::Cva | Weighting::Automatic | Weighting::Ssarx => {
                let (white, colour) = whiten(free)?;
                (white.subrows(0, pasts).transpose().to_owned(), colour)
            }
        };
        let svd = linalg::thin_svd(projected.as_ref())?;
        let values = svd.values;
        let rooted = Mat::from_fn(projected.nrows(), values.len(), |i, j| svd.u[(i, j)] * values[j].max(0.0).sqrt());
        let is_unscaled = matches!(weighting, Weighting::N4sid | Weighting::Moesp);
        let scale = if !is_unscaled { 1.0 } else { 1.0 / (factor.windows as f64).sqrt() };
        Ok(Projection {
            hankel,
            factor,
            oblique,
            directions: back * rooted,
            singular_values: values.iter().map(|v| v * scale).collect(),
        })
    }

    pub(super) fn singular_values(&self) -> &[f64] {
        &self.singular_values
    }

    /// The model of so many states, in scaled channels.
    pub(super) fn realise(&self, order: usize, stable: bool, noise_model: bool) -> Result<Realised, IdentError> {
        let p = self.hankel.outputs;
        // None where the inputs alone explain the future: of data without noise under inputs of few frequencies.
        let largest = self.singular_values.first().copied().unwrap_or(0.0);
        let found = self.singular_values.iter().filter(|v| **v > ROUNDING * largest).count();
        if found < order {
            let condition = self.singular_values.get(order - 1).map_or(f64::INFINITY, |value| largest / value);
            return Err(IdentError::RankDeficient { rank: found, parameters: order, condition });
        }
        let gamma = self.directions.subcols(0, order);
        let shorter = gamma.nrows() - p;
        let (above, below) = (gamma.subrows(0, shorter), gamma.subrows(p, shorter));
        let a = linalg::least_norm(above, below, ROUNDING)?;
        if spectral_radius(a.as_ref())? >= 1.0 {
            return self.realise_unstable(gamma, a, stable, noise_model);
        }
        let c = gamma.subrows(0, p).to_owned();
        let joint = self.residual_covariance(gamma)?;
        Ok(Realised::new(a, c, &joint, noise_model))
    }

    /// The model where the shift structure gives an unstable `A`. States beyond the order of the system have a
    /// direction of Γ made of noise, whose shift may grow; as sequences they do not. So `A` and `C` are taken from the
    /// sequences if that makes them stable, which it does not where the system itself grows.
    fn realise_unstable(
        &self,
        gamma: MatRef<'_, f64>,
        mut a: Mat<f64>,
        stable: bool,
        noise_model: bool,
    ) -> Result<Realised, IdentError> {
        let (n, p) = (gamma.ncols(), self.hankel.outputs);
        let (coefficients, joint) = self.regress_states(gamma)?;
        let regressed = coefficients.submatrix(0, 0, n, n).transpose().to_owned();
        if spectral_radius(regressed.as_ref())? < 1.0 {
            let c = coefficients.submatrix(0, n, n, p).transpose().to_owned();
            return Ok(Realised::new(regressed, c, &joint, noise_model));
        }
        if stable {
            a = stable_shift(gamma, p)?;
        }
        Ok(Realised::new(a, gamma.subrows(0, p).to_owned(), &self.residual_covariance(gamma)?, noise_model))
    }

    /// Next states and outputs regressed on states and inputs, all states by the same function of their past:
    /// transposed `[A B; C D]`, and the residuals' covariance `[Q S; Sᵀ R]`.
    ///
    /// # Source
    /// Larimore, *Canonical variate analysis in identification, filtering, and adaptive control*, 29th IEEE CDC, 1990.
    fn regress_states(&self, gamma: MatRef<'_, f64>) -> Result<(Mat<f64>, Mat<f64>), IdentError> {
        let (hankel, factor) = (self.hankel, self.factor);
        let (m, q, past) = (hankel.inputs, hankel.channels(), hankel.horizons.past);
        let oblique = oblique_coefficients(hankel, factor, past)?;
        let states = linalg::least_norm(gamma, oblique.transpose(), ROUNDING)?.transpose().to_owned();
        let now = gather(factor, &columns(hankel, 0..past, 0..q)) * &states;
        let next = gather(factor, &columns(hankel, 1..past + 1, 0..q)) * &states;
        let inputs = gather(factor, &columns(hankel, past..past + 1, 0..m));
        let outputs = gather(factor, &columns(hankel, past..past + 1, m..q));
        regress(factor, beside(&now, &inputs), beside(&next, &outputs))
    }

    /// Covariance of the residuals of state and output, `[Q S; Sᵀ R]`.
    fn residual_covariance(&self, gamma: MatRef<'_, f64>) -> Result<Mat<f64>, IdentError> {
        let (hankel, factor) = (self.hankel, self.factor);
        let past = hankel.horizons.past;
        let shorter = gamma.nrows() - hankel.outputs;
        let now = linalg::least_norm(gamma, self.oblique.transpose(), ROUNDING)?;
        let later = oblique(hankel, factor, past + 1)?;
        let next = linalg::least_norm(gamma.subrows(0, shorter), later.transpose(), ROUNDING)?;
        let (m, q, future) = (hankel.inputs, hankel.channels(), hankel.horizons.future);
        let inputs = gather(factor, &columns(hankel, past..past + future, 0..m));
        let outputs = gather(factor, &columns(hankel, past..past + 1, m..q));
        let (now, next) = (now.transpose().to_owned(), next.transpose().to_owned());
        Ok(regress(factor, beside(&now, &inputs), beside(&next, &outputs))?.1)
    }
}

/// Coefficients of least squares, and the covariance of the residuals.
fn regress(factor: &HankelFactor, regressors: Mat<f64>, targets: Mat<f64>) -> Result<(Mat<f64>, Mat<f64>), IdentError> {
    let coefficients = linalg::least_norm(regressors.as_ref(), targets.as_ref(), ROUNDING)?;
    let residuals = targets - regressors * &coefficients;
    let covariance = residuals.transpose() * &residuals * faer::Scale(1.0 / factor.windows as f64);
    Ok((coefficients, covariance))
}

/// Two matrices side by side.
pub(super) fn beside(left: &Mat<f64>, right: &Mat<f64>) -> Mat<f64> {
    let split = left.ncols();
    let entry = |i: usize, j: usize| if j < split { left[(i, j)] } else { right[(i, j - split)] };
    Mat::from_fn(left.nrows(), split + right.ncols(), entry)
}

/// `A` with every eigenvalue inside the unit circle: the shift of Γ with zeros in place of the row block beyond its
/// end.
///
/// # Source
/// Chui & Maciejowski, *Realization of stable models with subspace methods*, Automatica 32(11), 1996.
pub(super) fn stable_shift(gamma: MatRef<'_, f64>, p: usize) -> Result<Mat<f64>, IdentError> {
    let shifted =
        Mat::from_fn(gamma.nrows(), gamma.ncols(), |i, j| if i + p < gamma.nrows() { gamma[(i + p, j)] } else { 0.0 });
    let a = linalg::least_norm(gamma, shifted.as_ref(), ROUNDING)?;
    // On the circle by rounding: drawn in by the least there is.
    let radius = spectral_radius(a.as_ref())?;
    Ok(if radius < 1.0 { a } else { a * faer::Scale((1.0 - 1e-9) / radius) })
}

/// The oblique projection along the future inputs of the future outputs on the past, which ends before block row `now`.
fn oblique(hankel: &Hankel<'_>, factor: &HankelFactor, now: usize) -> Result<Mat<f64>, IdentError> {
    let past = gather(factor, &columns(hankel, 0..now, 0..hankel.channels()));
    Ok(past * oblique_coefficients(hankel, factor, now)?)
}

/// Coefficients of the past in the oblique projection: channels of the past × outputs of the future.
fn oblique_coefficients(hankel: &Hankel<'_>, factor: &HankelFactor, now: usize) -> Result<Mat<f64>, IdentError> {
    let (m, q, total) = (hankel.inputs, hankel.channels(), hankel.horizons.total());
    let mut regressors = columns(hankel, 0..now, 0..q);
    let past = regressors.len();
    regressors.extend(columns(hankel, now..total, 0..m));
    let outputs = gather(factor, &columns(hankel, now..total, m..q));
    let coefficients = linalg::least_norm(gather(factor, &regressors).as_ref(), outputs.as_ref(), ROUNDING)?;
    Ok(coefficients.subrows(0, past).to_owned())
}

/// The columns of some channels at some block rows, block row by block row.
pub(super) fn columns(hankel: &Hankel<'_>, blocks: Range<usize>, channels: Range<usize>) -> Vec<usize> {
    blocks.flat_map(|b| channels.clone().map(move |c| (b, c))).map(|(b, c)| hankel.column(b, c)).collect()
}

pub(super) fn gather(factor: &HankelFactor, list: &[usize]) -> Mat<f64> {
    Mat::from_fn(factor.r.nrows(), list.len(), |i, j| factor.r[(i, list[j])])
}

/// Orthonormal `W` and the matrix `Z` with `M = W Zᵀ`, directions that are rounding left out.
pub(super) fn whiten(m: MatRef<'_, f64>) -> Result<(Mat<f64>, Mat<f64>), IdentError> {
    let svd = linalg::thin_svd(m)?;
    let values = &svd.values;
    let kept = values.iter().filter(|v| **v > ROUNDING * values[0]).count();
    let colour = Mat::from_fn(m.ncols(), kept, |i, j| svd.v[(i, j)] * values[j]);
    Ok((svd.u.subcols(0, kept).to_owned(), colour))
}

/// The Kalman gain and the innovations' covariance; a gain of zero where there is no stable filter.
fn noise(a: &Mat<f64>, c: &Mat<f64>, joint: &Mat<f64>, wanted: bool) -> (Mat<f64>, Mat<f64>) {
    let (n, p) = (a.nrows(), c.nrows());
    let r = Mat::from_fn(p, p, |i, j| joint[(n + i, n + j)] + if i == j { LEAST_NOISE * LEAST_NOISE } else { 0.0 });
    let (q, s) = (joint.submatrix(0, 0, n, n), joint.submatrix(0, n, n, p));
    let filter = if wanted { kalman(a.as_ref(), c.as_ref(), q, s, r.as_ref()) } else { None };
    filter.unwrap_or((Mat::zeros(n, p), r))
}

/// `A`, `C`, `K`, `Λ` in scaled channels.
pub(super) struct Realised {
    a: Mat<f64>,
    c: Mat<f64>,
    k: Mat<f64>,
    covariance: Mat<f64>,
}

impl Realised {
    /// With the noise that the covariance `[Q S; Sᵀ R]` of the residuals says.
    pub(super) fn new(a: Mat<f64>, c: Mat<f64>, joint: &Mat<f64>, noise_model: bool) -> Self {
        let (k, covariance) = noise(&a, &c, joint, noise_model);
        Realised { a, c, k, covariance }
    }

    /// The model in the units of the data, its inputs without influence yet.
    pub(super) fn unscaled(self, weights: &[f64], data: &Dataset) -> Result<Innovations, IdentError> {
        let w = &weights[data.inputs()..];
        let (n, p) = (self.a.nrows(), self.c.nrows());
        let c = Mat::from_fn(p, n, |i, j| self.c[(i, j)] / w[i]);
        let k = Mat::from_fn(n, p, |i, j| self.k[(i, j)] * w[j]);
        let covariance = Mat::from_fn(p, p, |i, j| self.covariance[(i, j)] / (w[i] * w[j]));
        without_inputs(self.a, c, k, covariance, data)
    }
}

/// An innovations form without inputs' influence yet: `B = 0`, `D = 0`.
pub(super) fn without_inputs(
    a: Mat<f64>,
    c: Mat<f64>,
    k: Mat<f64>,
    covariance: Mat<f64>,
    data: &Dataset,
) -> Result<Innovations, IdentError> {
    let (n, m, p) = (a.nrows(), data.inputs(), data.outputs());
    let system = StateSpace::discrete(a, Mat::zeros(n, m), c, Mat::zeros(p, m), data.sample_time_s())?;
    Ok(Innovations::new(system, k, covariance)?)
}
