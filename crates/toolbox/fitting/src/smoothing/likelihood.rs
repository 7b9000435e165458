//! Noise levels by maximum likelihood of the innovations.

use faer::{MatMut, MatRef};

use super::forward::{Forward, Innovation};
use super::system::{Belief, NoisySystem};
use crate::{Bounds, IdentError, NonlinearOptions, ResidualModel, Termination, minimise};

/// Every parameter is held where it starts as by one sample's worth of likelihood over 1000: enough to settle one that
/// the measurements say nothing of, such as the level of a noise that is not there.
const HELD: f64 = 1e-3;
/// Step of the numerical derivatives.
const STEP: f64 = 1e-4;
/// The search ends where −2 ln L falls by no more than this, far below what a standard error is worth.
const UNNOTICED: f64 = 0.01;
/// Parameters need no more digits than they are known to.
const STEP_TOLERANCE: f64 = 1e-4;
/// Longest search over all samples.
const ITERATIONS: usize = 100;
/// Several starts are compared after so many iterations ...
const TRIAL_ITERATIONS: usize = 12;
/// ... over one part of so many of the samples.
const TRIAL_PARTS: usize = 4;

/// The parameters under which measurements are likeliest.
#[derive(Debug, Clone, PartialEq)]
pub struct Likeliest {
    /// The parameters.
    pub parameters: Vec<f64>,
    /// Factor on all covariances of the system at these parameters.
    pub scale: f64,
    /// How the search ended.
    pub termination: Termination,
}

/// Finds the parameters of a [`NoisySystem`], and a common scale of all its covariances, that make the measurements
/// likeliest. Covariances are those of the innovations alone: parameters are best the logarithms of ratios between
/// noises, so that one of them can stay at one.
///
/// With the scale at its best, Σ v²/(N F), minus twice the likelihood is N ln(Σ v²/F) + Σ ln F up to a constant, and
/// its minimum that of Σ (g v/√F)², ln g the mean of ½ ln F: a sum of squares. Its slopes hold one half of the
/// information on parameters that move F; rows of the Jacobian beside residuals of zero hold the other, so that steps
/// are those of Fisher's scoring.
///
/// The likelihood can have several maxima. From each of several `starts` there is a short search over the first quarter
/// of the samples; the search over all of them begins at that end which makes all of them likeliest, or at the first
/// start where no short search succeeds.
///
/// # Errors
/// Those of [`NoisySystem::smooth`] where the last search begins, and of [`minimise`]; no start.
///
/// # Source
/// Durbin & Koopman 2012, §7.2 and §2.10 (concentration); Harvey 1989, *Forecasting, Structural Time Series Models and
/// the Kalman Filter*, §3.4.5 (information).
pub fn likeliest(
    starts: &[Vec<f64>],
    bounds: &[Bounds],
    system_at: impl Fn(&[f64]) -> Result<(NoisySystem, Belief), IdentError>,
    inputs: MatRef<'_, f64>,
    outputs: MatRef<'_, f64>,
) -> Result<Likeliest, IdentError> {
    let all = Measured { inputs, outputs };
    let begin = match starts {
        [] => return Err(IdentError::Length { what: "starting values", expected: 1, found: 0 }),
        [only] => only.clone(),
        [first, ..] => {
            let ends = starts.iter().filter_map(|start| all.try_start(start, bounds, &system_at));
            ends.max_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(|| first.clone(), |(_, end)| end)
        }
    };
    all.search(&begin, bounds, &system_at, ITERATIONS)
}

/// ln L with the scale at its best, up to a constant.
fn likelihood(innovations: &[Innovation]) -> f64 {
    let power: f64 = innovations.iter().map(|one| one.value.powi(2) / one.variance).sum();
    let spread: f64 = innovations.iter().map(|one| one.variance.ln()).sum();
    -0.5 * (innovations.len() as f64 * power.ln() + spread)
}

/// Measurements, and what moved the system.
#[derive(Clone, Copy)]
struct Measured<'a> {
    inputs: MatRef<'a, f64>,
    outputs: MatRef<'a, f64>,
}

impl<'a> Measured<'a> {
    fn first_part(self) -> Self {
        let rows = self.outputs.nrows() / TRIAL_PARTS;
        Measured { inputs: self.inputs.subrows(0, rows), outputs: self.outputs.subrows(0, rows) }
    }

    fn innovations(
        &self,
        system_at: &impl Fn(&[f64]) -> Result<(NoisySystem, Belief), IdentError>,
        parameters: &[f64],
    ) -> Result<Vec<Innovation>, IdentError> {
        let (system, start) = system_at(parameters)?;
        Ok(Forward::run(&system, &start, self.inputs, self.outputs, false)?.innovations)
    }

    /// The end of a short search, with how likely it makes all measurements; none where that is no number.
    fn try_start(
        self,
        start: &[f64],
        bounds: &[Bounds],
        system_at: &impl Fn(&[f64]) -> Result<(NoisySystem, Belief), IdentError>,
    ) -> Option<(f64, Vec<f64>)> {
        let end = self.first_part().search(start, bounds, system_at, TRIAL_ITERATIONS).ok()?.parameters;
        let likelihood = likelihood(&self.innovations(system_at, &end).ok()?);
        likelihood.is_finite().then_some((likelihood, end))
    }

    fn search(
        self,
        start: &[f64],
        bounds: &[Bounds],
        system_at: &impl Fn(&[f64]) -> Result<(NoisySystem, Belief), IdentError>,
        iteration_limit: usize,
    ) -> Result<Likeliest, IdentError> {
        let first = Standardised::new(&self.innovations(system_at, start)?);
        let (count, unit) = (first.residuals.len(), HELD * first.root_mean_square());
        let last = Some((start.to_vec(), first));
        let mut model = Levels { system_at, measured: self, start: start.to_vec(), unit, count, last };
        let cost_tolerance = UNNOTICED / count.max(1) as f64;
        let options = NonlinearOptions { iteration_limit, step_tolerance: STEP_TOLERANCE, cost_tolerance };
        let minimum = minimise(&mut model, start, bounds, options)?;
        let innovations = self.innovations(system_at, &minimum.parameters)?;
        let power: f64 = innovations.iter().map(|one| one.value.powi(2) / one.variance).sum();
        let scale = power / innovations.len() as f64;
        Ok(Likeliest { parameters: minimum.parameters, scale, termination: minimum.termination })
    }
}

/// Innovations as residuals: g v/√F, and ½ ln F less its mean.
struct Standardised {
    residuals: Vec<f64>,
    spreads: Vec<f64>,
}

impl Standardised {
    fn new(innovations: &[Innovation]) -> Self {
        let mut spreads: Vec<f64> = innovations.iter().map(|one| 0.5 * one.variance.ln()).collect();
        let mean = spreads.iter().sum::<f64>() / spreads.len().max(1) as f64;
        let weight = mean.exp();
        spreads.iter_mut().for_each(|spread| *spread -= mean);
        let residuals = innovations.iter().map(|one| weight * one.value / one.variance.sqrt()).collect();
        Standardised { residuals, spreads }
    }

    fn root_mean_square(&self) -> f64 {
        let squares: f64 = self.residuals.iter().map(|r| r * r).sum();
        (squares / self.residuals.len().max(1) as f64).sqrt()
    }
}

/// Residuals: those of the innovations, how far each parameter is from its start, and zeros, as many as innovations.
struct Levels<'a, F> {
    system_at: &'a F,
    measured: Measured<'a>,
    start: Vec<f64>,
    /// Contribution to the residuals of one unit away from the start.
    unit: f64,
    /// Of innovations.
    count: usize,
    /// The parameters last asked for, and what they gave: a step is taken where it has been tried.
    last: Option<(Vec<f64>, Standardised)>,
}

impl<F: Fn(&[f64]) -> Result<(NoisySystem, Belief), IdentError>> Levels<'_, F> {
    fn at(&self, parameters: &[f64]) -> Result<Standardised, IdentError> {
        Ok(Standardised::new(&self.measured.innovations(self.system_at, parameters)?))
    }
}

impl<F: Fn(&[f64]) -> Result<(NoisySystem, Belief), IdentError>> ResidualModel for Levels<'_, F> {
    fn parameter_count(&self) -> usize {
        self.start.len()
    }

    fn residual_count(&self) -> usize {
        2 * self.count + self.start.len()
    }

    fn evaluate(
        &mut self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        let here = match self.last.take() {
            Some((at, here)) if at == parameters => here,
            _ => self.at(parameters)?,
        };
        let (of_innovations, rest) = residuals.split_at_mut(self.count);
        let (held, zeros) = rest.split_at_mut(parameters.len());
        of_innovations.copy_from_slice(&here.residuals);
        held.iter_mut().zip(parameters).zip(&self.start).for_each(|((r, p), start)| *r = self.unit * (p - start));
        zeros.fill(0.0);
        let Some(mut jacobian) = jacobian else {
            self.last = Some((parameters.to_vec(), here));
            return Ok(());
        };
        let deviation = here.root_mean_square();
        for j in 0..parameters.len() {
            let mut point = parameters.to_vec();
            point[j] += STEP;
            let there = self.at(&point)?;
            let slope = |k: usize| (there.residuals[k] - here.residuals[k]) / STEP;
            let spread = |k: usize| deviation * (there.spreads[k] - here.spreads[k]) / STEP;
            let first_zero = self.count + parameters.len();
            for k in 0..self.count {
                (jacobian[(k, j)], jacobian[(first_zero + k, j)]) = (slope(k), spread(k));
            }
            (0..parameters.len()).for_each(|i| jacobian[(self.count + i, j)] = 0.0);
            jacobian[(self.count + j, j)] = self.unit;
        }
        Ok(())
    }
}
