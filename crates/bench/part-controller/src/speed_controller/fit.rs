//! Fitting the inverted controller, and judging it the way it is used: T_d* from measured speed.

use faer::Mat;
use ident::covariance::at_least_white;
use ident::validate::{self, fit_percent, rms_error};
use ident::{Bounds, Dataset, Minimum, NonlinearOptions, minimise};
use rig::align::split_window;
use rig::estimation::{ESTIMATION_SHARE, EstimateError, ReadOut, noise_floor, timing_floor_s, transformed};
use rig::results::{DemandLags, Estimate, Parameter, Quantity, ResidualTest, SpeedController, Trace, Validation};
use rig::{Experiment, Role};
use signal::Signal;
use signal::spline::UniformSpline;

use super::data::{Data, ident_error, signal_error, starting_point};
use super::encoder::Encoder;
use super::inverse::{self, COUNT};
use super::lag::lagged;

/// Stretches the robust covariance is built from.
pub(super) const BATCHES: usize = 30;
/// A gate found shorter than this many samples means that the controller reads the very samples that are logged; what
/// was found is then noise, and its root would bias the delay.
const SHORTEST_GATE: f64 = 0.5;
/// Where the gate is not shown, a lead so near to a whole number of samples is that of a controller that reads what is
/// logged: with a gate, and a delay of whole samples, it would be half a sample off. By chance it comes out so once in
/// five.
const WHOLE_LEAD: f64 = 0.1;
/// A controller that reads the samples that are logged shares their noise: what is left of a fit is then rounding, less
/// than this part of the noise. Where more is left, a gate that is not found is not known to be absent.
const SHARED: f64 = 0.6;
/// A once-a-turn error larger than this part of the speed is no encoder's.
const LARGEST_ECCENTRICITY: f64 = 2e-3;
/// Lags of the residual tests.
const LAGS: usize = 25;
/// Level of the residual tests' regions.
const TEST_LEVEL: f64 = 0.99;

/// The estimated speed controller, for people and for the estimators that follow.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedControllerFit {
    /// For the study.
    pub result: SpeedController,
    /// K_p, K_i and I_0 of PI without delay, on the same stretch.
    pub without_delay: Estimate,
    /// Findings on the encoder.
    pub encoder: Encoder,
    /// Internal parameters, by the positions in [`inverse`].
    pub(super) theta: Vec<f64>,
    /// True where the gate was found in the data.
    pub(super) is_gated: bool,
    /// Covariance of those that were estimated.
    pub(super) covariance: Mat<f64>,
    /// Samples by which N_d* is late, as if the delay acted on the speed error; a constant N_d* shows nothing of it.
    pub(super) lags: DemandLags,
    /// Step of the recorded T_d*, Nm, where its rounding hides the encoder's gate.
    pub coarse_demand_nm: Option<f64>,
}

/// Estimates PI and delay from a recording in speed control with constant N_d* (BS_T_NT).
///
/// # Errors
/// A missing signal, too short a stretch below the torque limit, or data that do not determine the parameters.
pub fn estimate(experiment: &Experiment, torque_limit_nm: Option<f64>) -> Result<SpeedControllerFit, EstimateError> {
    let data = Data::of(experiment, torque_limit_nm)?;
    let (estimation, validation) = split_window(data.window(), ESTIMATION_SHARE);
    let (known, unseen) = (data.part(estimation), data.part(validation));
    let found = found_in(&known)?;
    let (estimate, encoder) = described(&known, &found)?;
    let covariance = found.covariance(&known)?;
    let Found { fit, lags, smooth, start, open_gate, .. } = found;
    let without = fit_without_delay(&smooth, start, lags)?;
    let k_p = 1.0 / fit.parameters[inverse::P];
    let discrete = (k_p, k_p * (fit.parameters[inverse::Q] - 1.0));
    Ok(SpeedControllerFit {
        result: SpeedController {
            zero: zero_of(&estimate),
            estimate,
            sample_time_s: data.demand.sample_time_s,
            discrete,
            validation: validate(&unseen, &fit.parameters, lags)?,
            without_delay: validate(&unseen, &without.parameters, lags)?,
        },
        without_delay: describe_without_delay(&known, &without)?,
        encoder,
        is_gated: !fit.at_bound[inverse::GATE_SQUARED],
        theta: fit.parameters,
        covariance,
        lags,
        coarse_demand_nm: open_gate.and_then(|open| open.coarse_demand_nm),
    })
}

/// The zero of (K_p s + K_i)/s by the delta method, K_p and K_i being the first two parameters.
fn zero_of(estimate: &Estimate) -> Parameter {
    let [k_p, k_i] = [0, 1].map(|i| estimate.parameters.get(i).map_or(f64::NAN, |p| p.value));
    let gradient = [k_i / (k_p * k_p), -1.0 / k_p];
    let rows = estimate.covariance.iter().zip(gradient);
    let variance: f64 = rows.map(|(row, a)| row.iter().zip(gradient).map(|(c, b)| a * c * b).sum::<f64>()).sum();
    let freedom = estimate.parameters.first().map_or(f64::NAN, |p| p.degrees_of_freedom);
    Parameter::new(Quantity::ControllerZero, -k_i / k_p, variance.max(0.0).sqrt(), freedom)
}

/// Estimates PI and delay from all of a recording whose T_d* is that of PI and delay alone; nothing is held out.
///
/// # Errors
/// Those of [`estimate`].
pub fn estimate_alone(experiment: &Experiment, torque_limit_nm: Option<f64>) -> Result<Estimate, EstimateError> {
    let data = Data::of(experiment, torque_limit_nm)?;
    Ok(described(&data, &found_in(&data)?)?.0)
}

/// PI and delay as the search left them.
struct Found {
    fit: Minimum,
    lags: DemandLags,
    /// The data it was found in, and where the search began.
    smooth: Data,
    start: Vec<f64>,
    open_gate: Option<OpenGate>,
}

/// A gate of the encoder that the recording does not show.
struct OpenGate {
    /// Step of T_d*, Nm, where its rounding hides the gate.
    coarse_demand_nm: Option<f64>,
    /// The fit with the other gate: none, or one sample.
    other: Minimum,
}

impl Found {
    /// Covariance of the internal parameters.
    fn covariance(&self, data: &Data) -> Result<Mat<f64>, EstimateError> {
        let (mut covariance, _) = at_least_white(&self.fit, BATCHES).map_err(|e| ident_error(data, e))?;
        let Some(open) = &self.open_gate else { return Ok(covariance) };
        let moves = gate_moves(&self.fit.parameters, &open.other.parameters);
        for j in 0..covariance.ncols() {
            (0..covariance.nrows()).for_each(|i| covariance[(i, j)] += moves[i] * moves[j]);
        }
        Ok(covariance)
    }
}

/// By how much a gate anywhere between those of two fits moves values: uniform from one end to the other, seen from the
/// first.
fn gate_moves(values: &[f64], others: &[f64]) -> Vec<f64> {
    values.iter().zip(others).map(|(value, other)| (other - value) / 3f64.sqrt()).collect()
}

fn found_in(data: &Data) -> Result<Found, EstimateError> {
    let smooth = data.smoothed()?;
    let start = starting_point(&smooth)?;
    let coarse_demand_nm = data.coarse_demand_nm()?;
    if coarse_demand_nm.is_none() {
        let (fit, lags) = fit_with_lag(&smooth, start.clone(), |j| j < inverse::K)?;
        let is_gated = fit.parameters[inverse::GATE_SQUARED] > 0.0;
        if is_gated || leads_by_whole_samples(&fit) && shares_noise(data, &fit, lags)? {
            return Ok(Found { fit, lags, smooth, start, open_gate: None });
        }
    }
    let with_gate = |gate: f64| {
        let mut start = start.clone();
        start[inverse::GATE_SQUARED] = gate * gate;
        fit_with_lag(&smooth, start, |j| j < inverse::K && j != inverse::GATE_SQUARED)
    };
    let (gated, gateless) = (with_gate(1.0)?, with_gate(0.0)?);
    let ((fit, lags), (other, _)) =
        if leads_by_whole_samples(&gateless.0) { (gateless, gated) } else { (gated, gateless) };
    Ok(Found { fit, lags, smooth, start, open_gate: Some(OpenGate { coarse_demand_nm, other }) })
}

/// Tells whether a fit without a gate has the lead of a controller that reads what is logged.
fn leads_by_whole_samples(fit: &Minimum) -> bool {
    let lead = fit.parameters[inverse::LEAD];
    (lead - lead.round()).abs() < WHOLE_LEAD
}

/// Tells whether the controller reads the very samples that are logged.
fn shares_noise(data: &Data, fit: &Minimum, lags: DemandLags) -> Result<bool, EstimateError> {
    let left_rad_s = refit_stretch(data, &fit.parameters, lags)?.noise_variance().sqrt();
    Ok(left_rad_s < SHARED * noise_floor(&data.speed))
}

fn described(data: &Data, found: &Found) -> Result<(Estimate, Encoder), EstimateError> {
    let noise = refit_stretch(data, &found.fit.parameters, found.lags)?.noise_variance().sqrt();
    let (mut estimate, mut encoder) = describe(data, &found.fit, noise)?;
    if let Some(open) = &found.open_gate {
        let (other, _) = describe(data, &open.other, noise)?;
        let values = |estimate: &Estimate| estimate.parameters.iter().map(|p| p.value).collect::<Vec<f64>>();
        estimate.add_moves(&gate_moves(&values(&estimate), &values(&other)));
        encoder.gate_standard_error_s = data.demand.sample_time_s / 12f64.sqrt();
    } else if data.is_rounding_noticeable()? {
        // Of the gate that was found all or nothing may be rounding; half of it is in the delay.
        estimate.add_systematic(&[Quantity::ControllerDelay], encoder.gate_s / 12f64.sqrt());
    }
    Ok((estimate, encoder))
}

impl SpeedControllerFit {
    /// The delay, in whole samples of the controller.
    pub(super) fn delay_samples(&self) -> i32 {
        self.lags.speed_error
    }
}

/// A PI controller that is known, and the gate of the encoder that it reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownController {
    /// K_p, Nm s/rad.
    pub proportional_nm_s_per_rad: f64,
    /// K_i, Nm/rad.
    pub integral_nm_per_rad: f64,
    /// τ, s.
    pub delay_s: f64,
    /// T_g, s.
    pub gate_s: f64,
    /// Time between updates, s.
    pub sample_time_s: f64,
}

/// Once-a-turn error of N_d in a recording in speed control, as far as the controller does not answer it: coefficients
/// of cos φ and sin φ, φ = T Σ ω_d from the recording's first sample on. `None` where the recording cannot show.
pub fn once_a_turn(
    experiment: &Experiment,
    controller: &KnownController,
    torque_limit_nm: Option<f64>,
) -> Option<(f64, f64)> {
    let KnownController { proportional_nm_s_per_rad: k_p, integral_nm_per_rad: k_i, delay_s, gate_s, sample_time_s } =
        *controller;
    let mut theta = vec![0.0; COUNT];
    theta[inverse::P] = 1.0 / k_p;
    theta[inverse::Q] = k_i * sample_time_s / k_p;
    theta[inverse::LEAD] = (delay_s - 0.5 * gate_s) / sample_time_s;
    theta[inverse::GATE_SQUARED] = (gate_s / sample_time_s).powi(2);
    let lags = DemandLags { speed_error: (delay_s / sample_time_s).round() as i32, feed_forward: 0 };
    let data = Data::of(experiment, torque_limit_nm).ok()?;
    let fit = refit_stretch(&data, &theta, lags).ok()?;
    let found = (fit.parameters[inverse::COSINE], fit.parameters[inverse::SINE]);
    (found.0.hypot(found.1) < LARGEST_ECCENTRICITY).then_some(found)
}

/// Fits with the lag of N_d* in the speed error made consistent with the delay found, and without a gate where there is
/// none.
fn fit_with_lag(
    data: &Data,
    mut start: Vec<f64>,
    free: impl Fn(usize) -> bool,
) -> Result<(Minimum, DemandLags), EstimateError> {
    let of = |speed_error| DemandLags { speed_error, feed_forward: 0 };
    let mut lag = 1;
    let mut fit = run(data, of(lag), &start, &free)?;
    let gate = fit.parameters[inverse::GATE_SQUARED].sqrt();
    let is_gated = gate >= SHORTEST_GATE;
    if !is_gated {
        start[inverse::GATE_SQUARED] = 0.0;
    }
    let free = |j: usize| free(j) && (is_gated || j != inverse::GATE_SQUARED);
    let found = fit.parameters[inverse::LEAD] + if is_gated { gate / 2.0 } else { 0.0 };
    let right_lag = found.round().max(0.0) as i32;
    if right_lag != lag || !is_gated {
        lag = right_lag;
        fit = run(data, of(lag), &start, free)?;
    }
    Ok((fit, of(lag)))
}

fn fit_without_delay(data: &Data, mut start: Vec<f64>, lags: DemandLags) -> Result<Minimum, EstimateError> {
    (start[inverse::LEAD], start[inverse::GATE_SQUARED]) = (0.0, 0.0);
    let free = |j: usize| matches!(j, inverse::P | inverse::Q | inverse::FIRST_ERROR | inverse::COSINE | inverse::SINE);
    run(data, lags, &start, free)
}

/// Minimises the residual over the free parameters, from `start`; one number for each further term of the feed-forward
/// may be missing there, which then starts at zero.
pub(super) fn run(
    data: &Data,
    lags: DemandLags,
    start: &[f64],
    free: impl Fn(usize) -> bool,
) -> Result<Minimum, EstimateError> {
    let unbounded = |j: usize| match j {
        inverse::P => Bounds::new(1e-9, 1e9),
        inverse::Q => Bounds::new(0.0, 1.0),
        inverse::LEAD => Bounds::new(-5.0, 15.0),
        inverse::GATE_SQUARED => Bounds::new(0.0, 100.0),
        // Below half, inverting the filter or the derivative is not stable.
        inverse::FILTER | inverse::DERIVATIVE => Bounds::new(-0.45, 1e4),
        inverse::SECOND_INTEGRATOR => Bounds::new(-0.25, 0.25),
        _ => Bounds::NONE,
    };
    let mut start = start.to_vec();
    start.resize(COUNT + data.further.len(), 0.0);
    let bounds: Vec<Bounds> =
        start.iter().enumerate().map(|(j, v)| if free(j) { unbounded(j) } else { Bounds::new(*v, *v) }).collect();
    let mut model = data.model(lags, &free);
    minimise(&mut model, &start, &bounds, NonlinearOptions::default()).map_err(|source| ident_error(data, source))
}

/// Gains, delay and gate with their covariance, from the internal parameters.
fn describe(data: &Data, fit: &Minimum, noise_rad_s: f64) -> Result<(Estimate, Encoder), EstimateError> {
    let (covariance, dof) = at_least_white(fit, BATCHES).map_err(|e| ident_error(data, e))?;
    let t = data.demand.sample_time_s;
    let first_demand = data.demand.samples[0];
    let gate = |g: &[f64]| g[inverse::GATE_SQUARED].max(0.0).sqrt() * t;
    let outputs: [ReadOut<'_>; 5] = [
        (Quantity::ProportionalGain, &|g| 1.0 / g[inverse::P]),
        (Quantity::IntegralGain, &|g| g[inverse::Q] / (g[inverse::P] * t)),
        (Quantity::ControllerDelay, &|g| g[inverse::LEAD] * t + gate(g) / 2.0),
        (Quantity::IntegratorState, &|g| first_demand - g[inverse::FIRST_ERROR] / g[inverse::P]),
        (Quantity::DynoEncoderGate, &gate),
    ];
    // Without a gate of its own the logged speed is the one the controller sees: nothing to report.
    let reported = if fit.at_bound[inverse::GATE_SQUARED] { &outputs[..4] } else { &outputs[..] };
    let mut estimate = transformed(reported, fit, &covariance, dof, &data.stretch);
    estimate.add_systematic(&[Quantity::ControllerDelay], timing_floor_s(t));
    let gate_standard_error_s = estimate.parameter(Quantity::DynoEncoderGate).map_or(0.0, |p| p.standard_error);
    let encoder = Encoder {
        gate_s: gate(&fit.parameters),
        gate_standard_error_s,
        noise_rad_s,
        once_a_turn: (fit.parameters[inverse::COSINE], fit.parameters[inverse::SINE]),
    };
    Ok((estimate, encoder))
}

fn describe_without_delay(data: &Data, fit: &Minimum) -> Result<Estimate, EstimateError> {
    let (covariance, dof) = at_least_white(fit, BATCHES).map_err(|e| ident_error(data, e))?;
    let (t, first_demand) = (data.demand.sample_time_s, data.demand.samples[0]);
    let outputs: [ReadOut<'_>; 3] = [
        (Quantity::ProportionalGain, &|g| 1.0 / g[inverse::P]),
        (Quantity::IntegralGain, &|g| g[inverse::Q] / (g[inverse::P] * t)),
        (Quantity::IntegratorState, &|g| first_demand - g[inverse::FIRST_ERROR] / g[inverse::P]),
    ];
    Ok(transformed(&outputs, fit, &covariance, dof, &data.stretch))
}

/// T_d* computed from measured speed, against T_d* recorded; residual tests on the inverted form, whose residual is the
/// encoder's noise if the model is right.
pub(super) fn validate(data: &Data, theta: &[f64], lags: DemandLags) -> Result<Validation, EstimateError> {
    let modelled = forward(data, theta, lags)?;
    let measured = &data.demand.samples;
    let of = |e| ident_error(data, e);
    Ok(Validation {
        stretch: data.stretch.clone(),
        quantity: Role::DynoTorqueDemand.symbol().to_owned(),
        unit: "Nm".to_owned(),
        fit_percent: fit_percent(measured, &modelled).map_err(of)?,
        rms_error: rms_error(measured, &modelled).map_err(of)?,
        measured: trace(&data.demand, measured.clone()),
        modelled: trace(&data.demand, modelled),
        residuals: Some(residual_test(data, theta, lags)?),
    })
}

fn trace(clock: &Signal, values: Vec<f64>) -> Trace {
    Trace { start_s: clock.start_s, sample_time_s: clock.sample_time_s, values }
}

/// Simulates T_d* from the measured speed, the integrator's initial state fitted.
fn forward(data: &Data, theta: &[f64], lags: DemandLags) -> Result<Vec<f64>, EstimateError> {
    let turn = |(w, angle): (&f64, &f64)| {
        w * (1.0 - theta[inverse::COSINE] * angle.cos() - theta[inverse::SINE] * angle.sin())
    };
    let seen = data.speed.samples.iter().zip(&data.phase_rad).map(turn).collect();
    let spline = UniformSpline::new(seen).map_err(|e| signal_error(&data.stretch.file, e))?;
    let (k_p, step) = (1.0 / theta[inverse::P], theta[inverse::Q] / theta[inverse::P]);
    let reference = &data.reference.samples;
    let mut integral = 0.0;
    let mut output = Vec::with_capacity(data.demand.len());
    for k in 0..data.demand.len() {
        let instant = data.demand.time_s(k) - theta[inverse::LEAD] * data.demand.sample_time_s;
        let at = ((instant - data.speed.start_s) / data.speed.sample_time_s).clamp(0.0, data.speed.len() as f64 - 1.0);
        let error = spline.value(at) - lagged(reference, k, lags.speed_error);
        let [now, before] = [0, 1].map(|more| lagged(reference, k, lags.feed_forward + more));
        let feed = theta[inverse::K] * now + theta[inverse::K_A] * (now - before);
        output.push(k_p * error + integral + feed);
        integral += step * error;
    }
    let offset = data.demand.samples.iter().zip(&output).map(|(m, s)| m - s).sum::<f64>() / output.len() as f64;
    output.iter_mut().for_each(|v| *v += offset);
    Ok(output)
}

fn residual_test(data: &Data, theta: &[f64], lags: DemandLags) -> Result<ResidualTest, EstimateError> {
    let fit = refit_stretch(data, theta, lags)?;
    let positions = data.model(lags, &|_| false).kept();
    let input = demand_at_speed(data, positions);
    let test = validate::ResidualTest { lags: LAGS, level: TEST_LEVEL, ..Default::default() };
    let seen = Dataset::siso(data.speed.sample_time_s, &input, &fit.residuals).map_err(|e| ident_error(data, e))?;
    let mut found = test.run_on_residuals(&seen).map_err(|e| ident_error(data, e))?;
    let (own, cross) = (found.whiteness.swap_remove(0), found.independence.swap_remove(0).swap_remove(0));
    Ok(ResidualTest {
        sample_time_s: data.speed.sample_time_s,
        level: TEST_LEVEL,
        autocorrelation_bound: own.widest_bound(),
        autocorrelation: own.auto,
        cross_correlation_bound: cross.widest_bound(),
        cross_correlation: cross.cross,
        input: Role::DynoTorqueDemand.symbol().to_owned(),
    })
}

/// Fits what belongs to a stretch itself, its initial state and the angle's zero, and leaves the controller as it is.
fn refit_stretch(data: &Data, theta: &[f64], lags: DemandLags) -> Result<Minimum, EstimateError> {
    let mut start = theta.to_vec();
    start[inverse::FIRST_ERROR] = data.speed.samples[0] - data.reference.samples[0];
    run(data, lags, &start, |j| matches!(j, inverse::FIRST_ERROR | inverse::COSINE | inverse::SINE))
}

/// T_d* held at the instants of N_d.
fn demand_at_speed(data: &Data, samples: std::ops::Range<usize>) -> Vec<f64> {
    let last = data.demand.len() - 1;
    let index = |i: usize| (data.speed.time_s(i) - data.demand.start_s) / data.demand.sample_time_s;
    samples.map(|i| data.demand.samples[(index(i).round().max(0.0) as usize).min(last)]).collect()
}
