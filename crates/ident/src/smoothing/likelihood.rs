//! Noise levels by maximum likelihood of the innovations.

use faer::{MatMut, MatRef};

use super::forward::Forward;
use super::system::{Belief, NoisySystem};
use crate::{Bounds, IdentError, NonlinearOptions, ResidualModel, Termination, minimise};

/// Every parameter is held where it starts as by one sample's worth of likelihood over 1000: enough to settle one that the
/// measurements say nothing of, such as the level of a noise that is not there.
const HELD: f64 = 1e-3;
/// Step of the numerical derivatives.
const STEP: f64 = 1e-4;
/// Likelihoods need no more digits than what their parameters are known to.
const OPTIONS: NonlinearOptions = NonlinearOptions { iteration_limit: 50, step_tolerance: 1e-4, cost_tolerance: 1e-8 };

/// The parameters under which measurements are likeliest.
#[derive(Debug, Clone, PartialEq)]
pub struct Likeliest {
    /// The parameters.
    pub parameters: Vec<f64>,
    /// What all covariances of the system at these parameters are to be multiplied by.
    pub scale: f64,
    /// How the search ended.
    pub termination: Termination,
}

/// Finds the parameters of a [`NoisySystem`], and a common scale of all its covariances, that make the measurements
/// likeliest. Covariances are those of the innovations alone: parameters are best the logarithms of ratios between noises, so
/// that one of them can stay at one.
///
/// With the scale at its best, Σ v²/(N F), minus twice the likelihood is N ln(Σ v²/F) + Σ ln F up to a constant, and its
/// minimum that of Σ (g v/√F)², ln g the mean of ½ ln F: a sum of squares.
///
/// # Errors
/// Those of [`NoisySystem::smooth`] at the start, and of [`minimise`].
///
/// # Source
/// Durbin & Koopman 2012, §7.2 and §2.10 (concentration).
pub fn likeliest(
    start: &[f64],
    bounds: &[Bounds],
    system_at: impl Fn(&[f64]) -> Result<(NoisySystem, Belief), IdentError>,
    inputs: MatRef<'_, f64>,
    outputs: MatRef<'_, f64>,
) -> Result<Likeliest, IdentError> {
    let residual_count =
        (0..outputs.nrows()).map(|k| (0..outputs.ncols()).filter(|i| !outputs[(k, *i)].is_nan()).count()).sum();
    let mut model = Levels { system_at, inputs, outputs, start: start.to_vec(), unit: 0.0, residual_count };
    let mut first = vec![0.0; residual_count];
    model.residuals(start, &mut first)?;
    model.unit = HELD * (first.iter().map(|r| r * r).sum::<f64>() / residual_count as f64).sqrt();
    let minimum = minimise(&mut model, start, bounds, OPTIONS)?;
    let innovations = model.innovations(&minimum.parameters)?;
    let scale = innovations.iter().map(|one| one.0 * one.0).sum::<f64>() / innovations.len() as f64;
    Ok(Likeliest { parameters: minimum.parameters, scale, termination: minimum.termination })
}

struct Levels<'a, F> {
    system_at: F,
    inputs: MatRef<'a, f64>,
    outputs: MatRef<'a, f64>,
    start: Vec<f64>,
    /// What one unit away from the start adds to the residuals.
    unit: f64,
    residual_count: usize,
}

impl<F: Fn(&[f64]) -> Result<(NoisySystem, Belief), IdentError>> Levels<'_, F> {
    /// v/√F and ln F.
    fn innovations(&self, parameters: &[f64]) -> Result<Vec<(f64, f64)>, IdentError> {
        let (system, start) = (self.system_at)(parameters)?;
        let forward = Forward::run(&system, &start, self.inputs, self.outputs, false)?;
        Ok(forward.innovations.iter().map(|one| (one.value / one.variance.sqrt(), one.variance.ln())).collect())
    }

    fn residuals(&self, parameters: &[f64], into: &mut [f64]) -> Result<(), IdentError> {
        let innovations = self.innovations(parameters)?;
        let mean = innovations.iter().map(|one| one.1).sum::<f64>() / innovations.len().max(1) as f64;
        let weight = (0.5 * mean).exp();
        let held = parameters.iter().zip(&self.start).map(|(p, start)| self.unit * (p - start));
        let all = innovations.iter().map(|one| weight * one.0).chain(held);
        into.iter_mut().zip(all).for_each(|(residual, one)| *residual = one);
        Ok(())
    }
}

impl<F: Fn(&[f64]) -> Result<(NoisySystem, Belief), IdentError>> ResidualModel for Levels<'_, F> {
    fn parameter_count(&self) -> usize {
        self.start.len()
    }

    fn residual_count(&self) -> usize {
        self.residual_count + self.start.len()
    }

    fn evaluate(
        &mut self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        self.residuals(parameters, residuals)?;
        let Some(mut jacobian) = jacobian else { return Ok(()) };
        let mut moved = vec![0.0; residuals.len()];
        for j in 0..parameters.len() {
            let mut point = parameters.to_vec();
            point[j] += STEP;
            self.residuals(&point, &mut moved)?;
            for (i, (there, here)) in moved.iter().zip(residuals.iter()).enumerate() {
                jacobian[(i, j)] = (there - here) / STEP;
            }
        }
        Ok(())
    }
}
