//! PI and delay from T_d* as it follows from the speeds: right where all noise there is lies in what the controller saw
//! and nobody logged, as in the study of §7.1. (Noise of the logged speed biases it; there the inverted controller is
//! right.)
//!
//! ε = L (T_d* − K_p e − K_i ∫e dt − I_0), e the logged speed error τ ago. L is the inverted controller of the estimate
//! before, under which noise on the speed is left as it is.
//!
//! # Source
//! Ljung 1999, §4.3 and §7.6 (output error, prefilters).

use faer::MatMut;
use ident::covariance::at_least_white;
use ident::{Bounds, IdentError, NonlinearOptions, ResidualModel, minimise};
use rig::Experiment;
use rig::estimation::{EstimateError, ReadOut, timing_floor_s, transformed};
use rig::results::{Estimate, Quantity};
use signal::spline::UniformSpline;

use super::data::{Data, ident_error, signal_error, starting_point};
use super::fit::BATCHES;
use super::inverse::{self, recursion};

/// Parameters, by position: K_p in Nm s/rad, K_i T in Nm s/rad, what the prefilter's start leaves, τ in samples.
const GAIN: usize = 0;
const INTEGRAL: usize = 1;
const START: usize = 2;
const DELAY: usize = 3;
const COUNT: usize = 4;
/// Samples at the start that a delay may reach before.
const EDGE: usize = 20;
/// Fits, each with the prefilter of the one before.
const ROUNDS: usize = 3;

/// Estimates K_p, K_i and τ from all of a recording whose T_d* is that of PI and delay alone.
///
/// # Errors
/// Those of [`super::estimate`].
pub fn estimate_forward(experiment: &Experiment) -> Result<Estimate, EstimateError> {
    let data = Data::of(experiment, None)?;
    let rough = starting_point(&data)?;
    let spline = UniformSpline::new(data.speed.samples.clone()).map_err(|e| signal_error(&data.stretch.file, e))?;
    let bounds = [Bounds::new(1e-9, 1e9), Bounds::new(0.0, 1e9), Bounds::NONE, Bounds::new(-5.0, 15.0)];
    let from = |theta: &[f64]| {
        let mut model = Forward::new(&data, &spline, prefilter(theta));
        minimise(&mut model, theta, &bounds, NonlinearOptions::default()).map_err(|source| ident_error(&data, source))
    };
    let mut fit = from(&[1.0 / rough[inverse::P], rough[inverse::Q] / rough[inverse::P], 0.0, 1.0])?;
    for _ in 1..ROUNDS {
        fit = from(&fit.parameters)?;
    }
    let (covariance, freedom) = at_least_white(&fit, BATCHES).map_err(|e| ident_error(&data, e))?;
    let t = data.demand.sample_time_s;
    let outputs: [ReadOut<'_>; 3] = [
        (Quantity::ProportionalGain, &|g| g[GAIN]),
        (Quantity::IntegralGain, &|g| g[INTEGRAL] / t),
        (Quantity::ControllerDelay, &|g| t * g[DELAY]),
    ];
    let mut estimate = transformed(&outputs, &fit, &covariance, freedom, &data.stretch);
    estimate.add_systematic(&[Quantity::ControllerDelay], timing_floor_s(t));
    Ok(estimate)
}

/// L as parameters of [`recursion`].
fn prefilter(theta: &[f64]) -> Vec<f64> {
    let mut of = vec![0.0; inverse::COUNT];
    (of[inverse::P], of[inverse::Q]) = (1.0 / theta[GAIN], theta[INTEGRAL] / theta[GAIN]);
    of
}

struct Forward<'a> {
    data: &'a Data,
    spline: &'a UniformSpline,
    prefilter: Vec<f64>,
    /// Rest of T_d* behind the prefilter, and of its own start.
    demand: Vec<f64>,
    start: Vec<f64>,
}

impl<'a> Forward<'a> {
    fn new(data: &'a Data, spline: &'a UniformSpline, prefilter: Vec<f64>) -> Self {
        let mut forward = Forward { data, spline, prefilter, demand: Vec::new(), start: Vec::new() };
        let count = forward.residual_count();
        forward.demand = forward.filtered(&data.demand.samples[EDGE..EDGE + count]);
        forward.start = recursion(&forward.prefilter, 1.0, &vec![0.0; count]);
        forward
    }

    /// The speed error seen at each sample of T_d*, and its change with τ, after the first ones.
    fn error(&self, delay: f64) -> (Vec<f64>, Vec<f64>) {
        let (demand, speed, reference) = (&self.data.demand, &self.data.speed, &self.data.reference.samples);
        let lag = delay.round().max(0.0) as usize;
        let ratio = demand.sample_time_s / speed.sample_time_s;
        let seen = |k: usize| {
            let at = (demand.time_s(k) - speed.start_s) / speed.sample_time_s - delay * ratio;
            (self.spline.value(at) - reference[k.saturating_sub(lag)], -self.spline.slope(at) * ratio)
        };
        (EDGE..demand.len().min(reference.len())).map(seen).unzip()
    }

    /// L x, but for what it was before the first sample.
    fn filtered(&self, series: &[f64]) -> Vec<f64> {
        let change = |k: usize| if k == 0 { 0.0 } else { self.prefilter[inverse::P] * (series[k] - series[k - 1]) };
        let forcing: Vec<f64> = (0..series.len()).map(change).collect();
        recursion(&self.prefilter, 0.0, &forcing)
    }
}

impl ResidualModel for Forward<'_> {
    fn parameter_count(&self) -> usize {
        COUNT
    }

    fn residual_count(&self) -> usize {
        self.data.demand.len().min(self.data.reference.len()).saturating_sub(EDGE)
    }

    fn evaluate(
        &mut self,
        theta: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        let (error, by_delay) = self.error(theta[DELAY]);
        let by_gain = self.filtered(&error);
        let by_integral = self.filtered(&summed(&error));
        for (k, residual) in residuals.iter_mut().enumerate() {
            let modelled = theta[GAIN] * by_gain[k] + theta[INTEGRAL] * by_integral[k] + theta[START] * self.start[k];
            *residual = self.demand[k] - modelled;
        }
        let Some(mut jacobian) = jacobian else { return Ok(()) };
        let later: Vec<f64> =
            by_delay.iter().zip(summed(&by_delay)).map(|(e, sum)| theta[GAIN] * e + theta[INTEGRAL] * sum).collect();
        let by_delay = self.filtered(&later);
        let columns = [(GAIN, &by_gain), (INTEGRAL, &by_integral), (START, &self.start), (DELAY, &by_delay)];
        for (j, column) in columns {
            column.iter().enumerate().for_each(|(k, value)| jacobian[(k, j)] = -value);
        }
        Ok(())
    }
}

/// Sum of all values before each.
fn summed(values: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let before = |value: &f64| {
        let before = sum;
        sum += value;
        before
    };
    values.iter().map(before).collect()
}
