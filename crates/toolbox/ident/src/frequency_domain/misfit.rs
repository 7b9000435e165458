//! The weighted misfit of a response to measured lines, and the estimate made of its minimum.

use faer::{Mat, MatMut};
use signal::Complex64;

use super::data::Lines;
use super::shared_noise::SharedNoise;
use crate::distributions::{chi_squared_quantile, normal_quantile};
use crate::{Bounds, Doubt, Fit, IdentError, Minimum, NonlinearOptions, Origin, Parametric, ResidualModel, minimise};
use fitting::condition::ILL_CONDITIONED;

/// Probability that a right model's cost lies between the limits.
const LEVEL: f64 = 0.95;

/// Gains at the lines, and their derivatives by the parameters (lines × parameters).
pub(crate) trait Response {
    fn parameter_count(&self) -> usize;

    fn respond(
        &mut self,
        theta: &[f64],
        gains: &mut [Complex64],
        slopes: Option<&mut Mat<Complex64>>,
    ) -> Result<(), IdentError>;
}

/// Residuals `√2 (Y − G U)/σ(G)`, real and imaginary part in turn, of variance one under the right model.
pub(crate) struct Misfit<'a, R> {
    pub(crate) lines: &'a Lines,
    pub(crate) response: R,
    gains: Vec<Complex64>,
    slopes: Mat<Complex64>,
}

impl<'a, R: Response> Misfit<'a, R> {
    pub(crate) fn new(lines: &'a Lines, response: R) -> Self {
        let (count, parameters) = (lines.lines.len(), response.parameter_count());
        Misfit { lines, response, gains: vec![Complex64::default(); count], slopes: Mat::zeros(count, parameters) }
    }
}

impl<R: Response> ResidualModel for Misfit<'_, R> {
    fn parameter_count(&self) -> usize {
        self.response.parameter_count()
    }

    fn residual_count(&self) -> usize {
        2 * self.lines.lines.len()
    }

    fn evaluate(
        &mut self,
        theta: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        let slopes = jacobian.is_some().then_some(&mut self.slopes);
        self.response.respond(theta, &mut self.gains, slopes)?;
        let one = Complex64::new(1.0, 0.0);
        for (k, (line, gain)) in self.lines.lines.iter().zip(&self.gains).enumerate() {
            let e = (line.y - gain * line.u) * (2.0 / line.variance(*gain, one)).sqrt();
            (residuals[2 * k], residuals[2 * k + 1]) = (e.re, e.im);
        }
        let Some(mut jacobian) = jacobian else {
            return Ok(());
        };
        for (k, (line, gain)) in self.lines.lines.iter().zip(&self.gains).enumerate() {
            let variance = line.variance(*gain, one);
            let scale = (2.0 / variance).sqrt();
            let e = (line.y - gain * line.u) * scale;
            for j in 0..self.slopes.ncols() {
                let slope = self.slopes[(k, j)];
                let of_variance = 2.0 * (slope.conj() * (gain * line.var_u - line.cov_yu)).re;
                let by = -slope * line.u * scale - e * (0.5 * of_variance / variance);
                (jacobian[(2 * k, j)], jacobian[(2 * k + 1, j)]) = (by.re, by.im);
            }
        }
        Ok(())
    }
}

/// The cost `V = Σ |Y − G U|²/σ²` at the minimum and where it lies, with 95 % probability, if the model is right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CostTest {
    /// V.
    pub cost: f64,
    /// Its expected value: frequencies less half the free parameters, for known variances and independent errors.
    pub expected: f64,
    /// Lower limit; below it, the noise is overstated.
    pub lower: f64,
    /// Upper limit; above it, the model misses something, or the noise is understated.
    pub upper: f64,
}

impl CostTest {
    fn new(lines: &Lines, minimum: &Minimum) -> Self {
        let explained = middle(lines, minimum).map_or(free(minimum) as f64, |middle| {
            let part = &minimum.unscaled_covariance * middle;
            (0..part.nrows()).map(|i| part[(i, i)]).sum()
        });
        let freedom = 2.0 * lines.lines.len() as f64 - explained;
        let (mean, spread, _) = lines.inflation();
        let (cost, expected) = (0.5 * minimum.cost, 0.5 * freedom * mean);
        let together = lines.shared_noise.as_ref().map_or(1.0, SharedNoise::scatter);
        let limit = |p: f64| match (lines.averages, &lines.shared_noise) {
            (None, None) => 0.5 * chi_squared_quantile(p, freedom),
            _ => expected + normal_quantile(p) * (0.5 * freedom * spread * together).sqrt(),
        };
        CostTest { cost, expected, lower: limit(0.5 - 0.5 * LEVEL), upper: limit(0.5 + 0.5 * LEVEL) }
    }

    /// Returns true if the cost lies between the limits.
    #[must_use]
    pub fn passed(&self) -> bool {
        (self.lower..=self.upper).contains(&self.cost)
    }
}

/// An estimate from frequency data.
///
/// The measured noise alone makes the covariance; `noise_covariance` of the [`Fit`] is the cost over its expected
/// value, one where model and noise are right. Where it is beyond the upper limit, [`Doubt::LargerThanNoise`] says so.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralFit<M> {
    /// The model and its covariance.
    pub fit: Fit<M>,
    /// Test of whether the residuals are noise.
    pub cost: CostTest,
    /// `(Y − G U)/σ` at each frequency.
    pub residuals: Vec<Complex64>,
}

/// `Jᵀ R J` where lines share noise.
fn middle(lines: &Lines, minimum: &Minimum) -> Option<Mat<f64>> {
    lines.shared_noise.as_ref().map(|shared| shared.middle(&minimum.jacobian))
}

fn free(minimum: &Minimum) -> usize {
    minimum.at_bound.iter().filter(|b| !**b).count()
}

/// Minimises, and returns the minimum with the covariance of θ that the measured noise gives it: `H⁻¹ Jᵀ R J H⁻¹`,
/// `H = Jᵀ J`, with `R` the correlation of the residuals, which is one where lines share no noise.
///
/// # Source
/// Pintelon & Schoukens 2012, ch. 9 (weighted least squares under a covariance other than the weights'); White,
/// *Maximum likelihood estimation of misspecified models*, Econometrica 50, 1982.
pub(crate) fn search<R: Response>(
    misfit: &mut Misfit<'_, R>,
    start: &[f64],
    bounds: &[Bounds],
    options: NonlinearOptions,
) -> Result<(Minimum, Mat<f64>), IdentError> {
    let minimum = minimise(misfit, start, bounds, options)?;
    let unscaled = &minimum.unscaled_covariance;
    let alone = middle(misfit.lines, &minimum).map_or_else(|| unscaled.clone(), |middle| unscaled * middle * unscaled);
    let covariance = faer::Scale(misfit.lines.inflation().2) * alone;
    Ok((minimum, covariance))
}

/// The estimate of a model whose parameters have this covariance.
pub(crate) fn spectral_fit<M: Parametric>(
    lines: &Lines,
    model: M,
    covariance: Mat<f64>,
    minimum: &Minimum,
) -> SpectralFit<M> {
    let cost = CostTest::new(lines, minimum);
    let mut doubts = Vec::new();
    if !minimum.termination.converged() {
        doubts.push(Doubt::NotConverged);
    }
    if minimum.condition > ILL_CONDITIONED {
        doubts.push(Doubt::IllConditioned { condition: minimum.condition });
    }
    if cost.cost > cost.upper {
        doubts.push(Doubt::LargerThanNoise { ratio: cost.cost / cost.expected });
    }
    let residual = |pair: &[f64]| Complex64::new(pair[0], pair[1]) * std::f64::consts::FRAC_1_SQRT_2;
    let fit = Fit {
        model,
        covariance,
        degrees_of_freedom: f64::INFINITY,
        noise_covariance: Mat::full(1, 1, cost.cost / cost.expected),
        loss: minimum.cost / minimum.residuals.len() as f64,
        samples: minimum.residuals.len(),
        free_parameters: free(minimum),
        initial_states: Vec::new(),
        levels: Vec::new(),
        termination: minimum.termination,
        iterations: minimum.iterations,
        condition: minimum.condition,
        doubts,
        origin: Some(Origin { method: "maximum likelihood on frequency data".into(), output_variance: Vec::new() }),
    };
    SpectralFit { fit, cost, residuals: minimum.residuals.chunks_exact(2).map(residual).collect() }
}
