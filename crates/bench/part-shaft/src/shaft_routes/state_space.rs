//! K and B in the time domain: (T_d, ω_e) → ω_d, thesis (6.11).
//!
//! J_d dω_d/dt = K φ + B (ω_e − ω_d) − T_d, dφ/dt = ω_e − ω_d: two states, sampled exactly under inputs that are
//! band-limited, the state at the start estimated. Nothing is differentiated, and nothing is said of the engine. A
//! constant offset of the torque is a twist at the start. All signals pass one band-pass, which leaves the equation as
//! it is and takes away drifts, friction that changes slowly, and what folds; they are then taken every 2 ms or so.
//!
//! The errors are those of a simulation (output error): their covariance is taken from what autocorrelation they show.
//! An error of ω_e is one of an input. It bends the minimum by what K, B and J_d do to the power that the encoders'
//! noise has at the output, which is taken off again.
//!
//! # Source
//! Thesis (6.11), §6.3.5.3; Söderström, *Errors-in-variables methods in system identification*, Automatica 43, 2007
//! (compensation of the bias).

use std::f64::consts::TAU;
use std::ops::Range;

use faer::{Mat, mat};
use ident::prediction::simulate;
use ident::validate::{fit_percent, rms_error};
use ident::{
    Dataset, Fit, GreyBox, GreyBoxModel, GreyParameter, IdentError, InitialState, Intersample, Parametric, Structure,
    least_squares,
};
use lti::{LtiError, StateSpace};
use numerics::linalg::FullyPivotedLu;
use numerics::null::nan_if_null;
use rig::estimation::{ESTIMATION_SHARE, EstimateError, timing_floor_s};
use rig::results::{Estimate, Quantity, Stretch, Trace, Validation};
use serde::{Deserialize, Serialize};
use signal::{Complex64, Sos};
use units::RPM_RAD_S;

use super::aligned::{Aligned, Clocks, TorqueSample, inner_stretch, once_a_turn};
use super::{Timing, estimate_of, flange_torque};
use crate::shaft::{ECCENTRICITY, ShaftInputs};

/// About how far the samples are apart that the model is fitted to, s.
const SAMPLE_TIME_S: f64 = 2e-3;
/// Band of the signals: lowest frequency, Hz, and the highest as a part of the sample rate.
const LOWEST_HZ: f64 = 0.7;
const HIGHEST_PART: f64 = 0.2;
/// Order of the band's lower edge.
const LOWER_EDGE_ORDER: usize = 2;
/// Order of the band's upper edge.
const UPPER_EDGE_ORDER: usize = 8;
/// Time for which the band-pass remembers its start, s.
const SETTLING_S: f64 = 1.5;
/// Largest skew looked for in a round, s, and rounds in which signals are dated anew.
const LARGEST_SKEW_S: f64 = 5e-3;
const ROUNDS: usize = 6;
/// A skew that is left, s, and is no more worth a round.
const NEGLIGIBLE_SKEW_S: f64 = 1e-7;

/// Rows at the ends of a stretch whose inputs between the samples are not well known.
const EDGE_ROWS: usize = 32;
/// Stretches between which the errors' scatter is taken.
const BATCHES: usize = 20;
/// Step of the integral over the noise's spectrum, Hz.
const NOISE_STEP_HZ: f64 = 0.1;

/// Treatment of the skews.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Skews {
    /// They are those given, within their uncertainties.
    Given,
    /// They are estimated along, as if nothing were known of them.
    Estimated,
}

/// The shaft by its state space.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StateSpaceRoute {
    /// K and B, J_d where it is uncertain, δ_e and δ_T where they are not exactly known.
    pub estimate: Estimate,
    /// Treatment of the skews.
    pub skews: Skews,
    /// ω_d in the band on the stretch that was not estimated from.
    pub validation: Validation,
    /// Sample time that the model was fitted on, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub sample_time_s: f64,
    /// Band of the signals, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub band_hz: (f64, f64),
    /// By how much the encoders' noise had bent K and B, which was taken off: Nm/rad, Nm s/rad.
    #[serde(deserialize_with = "nan_if_null")]
    pub bias_taken_off: (f64, f64),
}

/// Estimates K and B from the first part of a recording and judges them on the rest.
///
/// # Errors
/// A recording that is too short, a torque that is that of a flange, or data that do not determine the parameters.
pub fn estimate(inputs: &ShaftInputs<'_>, timing: &Timing, skews: Skews) -> Result<StateSpaceRoute, EstimateError> {
    let of = |source| EstimateError::Ident { file: inputs.file.to_owned(), source };
    let Some(inertia) = inputs.inertia_kg_m2 else {
        return Err(flange_torque(inputs, "state space"));
    };
    let stretch = inner_stretch(inputs)?;
    let free = |uncertainty: f64| if skews == Skews::Estimated { f64::INFINITY } else { uncertainty };
    let mut clocks =
        Clocks { engine_s: timing.engine_skew_s.0, torque_s: timing.torque_skew_s.0, gate_s: timing.gate_s.0 };
    let mut structure = Shaft {
        start: (1.0, 1.0),
        inertia,
        skews: [
            (0.0, free(timing.engine_skew_s.1)),
            // What is uncertain of the gate shifts the mean of the torque by half of it.
            (0.0, free(timing.torque_skew_s.1.hypot(0.5 * timing.gate_s.1))),
        ],
    };
    let mut round = 0;
    let (mut found, record) = loop {
        let record = Record::new(inputs, &stretch, clocks)?;
        let data = record.part(record.estimation()).map_err(of)?;
        if round == 0 {
            structure.start = record.starting_values(inertia.0).map_err(of)?;
        }
        let fit = GreyBox::new(structure.clone()).fit(&data).map_err(of)?;
        let theta = fit.parameters();
        let left = [theta[SKEWS[0]], theta[SKEWS[1]]];
        round += 1;
        if round == ROUNDS || left.iter().all(|l| l.abs() < NEGLIGIBLE_SKEW_S) {
            break (fit, record);
        }
        // Skews are first-order terms: signals are dated by them, which leaves the next round less to err about.
        clocks.engine_s += left[0];
        clocks.torque_s += left[1];
        for (skew, by) in structure.skews.iter_mut().zip(left) {
            skew.0 -= by;
        }
        structure.start = (theta[STIFFNESS], theta[DAMPING]);
    };
    let Judged { bias, inflation } = record.judge(inputs, &found).map_err(of)?;
    let scaled = |i: usize, j: usize| found.covariance[(i, j)] * inflation[i] * inflation[j];
    found.covariance = Mat::from_fn(inflation.len(), inflation.len(), scaled);
    found.degrees_of_freedom = BATCHES as f64 - 1.0;
    let theta: Vec<f64> = found.parameters().iter().zip(&bias).map(|(t, b)| t - b).collect();
    found.model = found.model.with_parameters(&theta).map_err(|e| of(e.into()))?;
    let known = Stretch { end_s: record.time_s(record.estimation().end), ..stretch };
    let mut estimate = read_out(&found, &structure, clocks, known);
    let fastest_s = inputs.signals().map(|signal| signal.sample_time_s).fold(f64::INFINITY, f64::min);
    for skew in [Quantity::EngineSpeedSkew, Quantity::TorqueSkew] {
        estimate.add_systematic(&[skew], timing_floor_s(fastest_s));
    }
    Ok(StateSpaceRoute {
        estimate,
        skews,
        validation: record.validation(inputs, &found.model)?,
        sample_time_s: record.sample_time_s,
        band_hz: record.band_hz,
        bias_taken_off: (bias[STIFFNESS], bias[DAMPING]),
    })
}

const STIFFNESS: usize = 0;
const DAMPING: usize = 1;
const INERTIA: usize = 2;
/// Skews of ω_e and T_d that are left.
const SKEWS: [usize; 2] = [3, 4];
/// Amplitudes of the once-a-turn errors of ω_d and ω_e.
const DYNO_TURN: [usize; 2] = [5, 6];
const ENGINE_TURN: [usize; 2] = [7, 8];

/// The shaft beside the dynamometer. Inputs: T_d, ω_e, then ω cos θ and ω sin θ of both encoders.
#[derive(Debug, Clone)]
struct Shaft {
    start: (f64, f64),
    inertia: (f64, f64),
    /// Rest of the skews of ω_e and T_d beforehand, with its standard uncertainty.
    skews: [(f64, f64); 2],
}

impl Structure for Shaft {
    fn parameters(&self) -> Vec<GreyParameter> {
        let known = |name: &str, (value, uncertainty): (f64, f64)| match uncertainty {
            0.0 => GreyParameter::new(name, value).fixed(),
            u if u.is_finite() => GreyParameter::new(name, value).with_prior(value, u),
            _ => GreyParameter::new(name, 0.0).within(-LARGEST_SKEW_S, LARGEST_SKEW_S),
        };
        let positive = |name: &str, value: f64| GreyParameter::new(name, value).within(0.0, f64::INFINITY);
        let mut parameters = vec![positive("K", self.start.0), positive("B", self.start.1), known("J_d", self.inertia)];
        parameters.extend([known("δ_e", self.skews[0]), known("δ_T", self.skews[1])]);
        parameters.extend(["a_d", "b_d", "a_e", "b_e"].map(|name| known(name, (0.0, ECCENTRICITY))));
        parameters
    }

    /// A record r(t) = x(t − δ) holds x = r + δ dr/dt; the derivative of an input is taken out of the equation by the
    /// change of states x − δ B r, which leaves B + δ A B and δ C B.
    fn system(&self, p: &[f64]) -> Result<StateSpace, LtiError> {
        let (stiffness, damping, inertia) = (p[STIFFNESS], p[DAMPING], p[INERTIA]);
        let a = mat![[-damping / inertia, stiffness / inertia], [-1.0, 0.0]];
        let speed = mat![[damping / inertia], [1.0]];
        let torque = mat![[-1.0 / inertia], [0.0]];
        let late = |b: &Mat<f64>, delta: f64| (b + faer::Scale(delta) * (&a * b), delta * b[(0, 0)]);
        let (speed, speed_now) = late(&speed, p[SKEWS[0]]);
        let (torque, torque_now) = late(&torque, p[SKEWS[1]]);
        let mut b = Mat::zeros(2, INPUTS);
        let mut d = Mat::zeros(1, INPUTS);
        for i in 0..2 {
            b[(i, 0)] = torque[(i, 0)];
            b[(i, 1)] = speed[(i, 0)];
            for (k, amplitude) in ENGINE_TURN.into_iter().enumerate() {
                b[(i, 4 + k)] = -p[amplitude] * speed[(i, 0)];
            }
        }
        (d[(0, 0)], d[(0, 1)]) = (torque_now, speed_now);
        for k in 0..2 {
            d[(0, 2 + k)] = p[DYNO_TURN[k]];
            d[(0, 4 + k)] = -p[ENGINE_TURN[k]] * speed_now;
        }
        StateSpace::continuous(a, b, mat![[1.0, 0.0]], d)
    }
}

const INPUTS: usize = 6;

/// Corrections of a fit beyond its covariance, by parameter.
struct Judged {
    bias: Vec<f64>,
    /// Factors on the standard errors.
    inflation: Vec<f64>,
}

/// Signals in the band, every few milliseconds.
struct Record {
    start_s: f64,
    sample_time_s: f64,
    band_hz: (f64, f64),
    filter: [Sos; 2],
    inputs: [Vec<f64>; INPUTS],
    output: Vec<f64>,
}

impl Record {
    fn new(inputs: &ShaftInputs<'_>, stretch: &Stretch, clocks: Clocks) -> Result<Self, EstimateError> {
        let of = |source| EstimateError::Signal { file: inputs.file.to_owned(), source };
        let signals = Aligned::new(inputs, stretch, clocks, TorqueSample::Momentary)?;
        let fast_s = signals.sample_time_s;
        let factor = (SAMPLE_TIME_S / fast_s).round().max(1.0) as usize;
        let sample_time_s = fast_s * factor as f64;
        let settled = (SETTLING_S / fast_s).ceil() as usize;
        if signals.dyno.len() < 3 * settled {
            return Err(EstimateError::TooShort {
                file: inputs.file.to_owned(),
                duration_s: stretch.end_s - stretch.start_s,
                needed_s: 3.0 * SETTLING_S,
            });
        }
        let highest_hz = HIGHEST_PART / sample_time_s;
        let low = Sos::butterworth_highpass(LOWER_EDGE_ORDER, LOWEST_HZ, fast_s).map_err(of)?;
        let high = Sos::butterworth_lowpass(UPPER_EDGE_ORDER, highest_hz, fast_s).map_err(of)?;
        let through = |x: &[f64]| {
            let x = low.filter(x, &mut low.state_at_level(x[0]));
            let x = high.filter(&x, &mut high.state_at_rest());
            x.into_iter().skip(settled).step_by(factor).collect::<Vec<f64>>()
        };
        let [dyno_cos, dyno_sin] = once_a_turn(&signals.dyno, fast_s);
        let [engine_cos, engine_sin] = once_a_turn(&signals.engine, fast_s);
        let rows = [&signals.torque, &signals.engine, &dyno_cos, &dyno_sin, &engine_cos, &engine_sin];
        Ok(Record {
            start_s: signals.start_s + settled as f64 * fast_s,
            sample_time_s,
            band_hz: (LOWEST_HZ, highest_hz),
            inputs: rows.map(|x| through(x)),
            output: through(&signals.dyno),
            filter: [low, high],
        })
    }

    fn time_s(&self, row: usize) -> f64 {
        self.start_s + row as f64 * self.sample_time_s
    }

    /// Rows that are estimated from.
    fn estimation(&self) -> Range<usize> {
        0..(ESTIMATION_SHARE * self.output.len() as f64) as usize
    }

    fn part(&self, rows: Range<usize>) -> Result<Dataset, IdentError> {
        let inputs = Mat::from_fn(rows.len(), INPUTS, |i, j| self.inputs[j][rows.start + i]);
        let output = Mat::from_fn(rows.len(), 1, |i, _| self.output[rows.start + i]);
        Ok(Dataset::new(self.sample_time_s, inputs, output)?.with_intersample(Intersample::BandLimited))
    }

    /// K and B to start from: least squares of J_d dω_d/dt + T_d on the twist and its rate.
    fn starting_values(&self, inertia: f64) -> Result<(f64, f64), IdentError> {
        let [torque, engine, ..] = &self.inputs;
        let rate = |i: usize| engine[i] - self.output[i];
        let mut twist = vec![0.0; self.output.len()];
        for i in 1..twist.len() {
            twist[i] = twist[i - 1] + 0.5 * self.sample_time_s * (rate(i - 1) + rate(i));
        }
        let rows = self.output.len().saturating_sub(2);
        let regressors = Mat::from_fn(rows, 3, |i, j| [twist[i + 1], rate(i + 1), 1.0][j]);
        let target: Vec<f64> = (1..=rows)
            .map(|i| inertia * (self.output[i + 1] - self.output[i - 1]) / (2.0 * self.sample_time_s) + torque[i])
            .collect();
        let found = least_squares(regressors.as_ref(), &target)?;
        Ok((found.parameters[0].max(1.0), found.parameters[1].max(1e-3)))
    }

    /// By how much the white noise of the encoders moves the minimum: −H⁻¹ ½ N ∂V/∂θ, with V the power that it has at
    /// the output and H = ΨᵀΨ, Ψ the slopes of what is simulated; and by how much the scatter of Ψᵀε between stretches
    /// widens the intervals, where errors go with the inputs, as what folds of ω_e does.
    fn judge(&self, inputs: &ShaftInputs<'_>, fit: &Fit<GreyBoxModel<Shaft>>) -> Result<Judged, IdentError> {
        let theta = fit.parameters();
        let data = self.part(self.estimation())?;
        let free: Vec<usize> = (0..theta.len()).filter(|j| fit.covariance[(*j, *j)] > 0.0).collect();
        let rows = data.samples();
        let mut slopes = Mat::zeros(rows + free.len(), free.len());
        let mut gradient = Mat::zeros(free.len(), 1);
        let deviation = fit.noise_covariance[(0, 0)].sqrt();
        for (column, j) in free.iter().enumerate() {
            let step = 0.1 * fit.covariance[(*j, *j)].sqrt();
            let moved = |by: f64| {
                let mut point = theta.clone();
                point[*j] += by;
                let model = fit.model.with_parameters(&point)?;
                let power = self.noise_power(&model.system()?, inputs);
                Ok::<_, IdentError>((simulate(&model, &data, &InitialState::Estimated)?, power))
            };
            let ((above, more), (below, less)) = (moved(step)?, moved(-step)?);
            for i in 0..rows {
                slopes[(i, column)] = (above.outputs[0][(i, 0)] - below.outputs[0][(i, 0)]) / (2.0 * step);
            }
            if let Some((_, uncertainty)) = fit.model.structure().parameters()[*j].prior {
                slopes[(rows + column, column)] = deviation / uncertainty;
            }
            gradient[(column, 0)] = -0.5 * rows as f64 * (more - less) / (2.0 * step);
        }
        let scale: Vec<f64> = (0..free.len()).map(|j| slopes.col(j).norm_l2()).collect();
        let scaled = Mat::from_fn(slopes.nrows(), free.len(), |i, j| slopes[(i, j)] / scale[j]);
        let hessian = FullyPivotedLu::new((scaled.transpose() * &scaled).as_ref());
        let solution = hessian.solve(Mat::from_fn(free.len(), 1, |i, _| gradient[(i, 0)] / scale[i]).as_ref());
        let errors = self.errors(&fit.model, &data)?;
        let length = rows / BATCHES;
        let sums = Mat::from_fn(free.len(), BATCHES, |j, batch| {
            (batch * length..(batch + 1) * length).map(|i| scaled[(i, j)] * errors[i]).sum::<f64>()
        });
        let scatter = hessian.solve(sums.as_ref());
        let mut judged = Judged { bias: vec![0.0; theta.len()], inflation: vec![1.0; theta.len()] };
        for (column, j) in free.iter().enumerate() {
            let squares = (0..BATCHES).map(|batch| scatter[(column, batch)].powi(2)).sum::<f64>();
            let robust = squares * BATCHES as f64 / (BATCHES as f64 - 1.0) / scale[column].powi(2);
            judged.bias[*j] = solution[(column, 0)] / scale[column];
            judged.inflation[*j] = (robust / fit.covariance[(*j, *j)]).max(1.0).sqrt();
        }
        Ok(judged)
    }

    /// Errors of a simulation; zero where inputs between the samples are not well known.
    fn errors(&self, model: &GreyBoxModel<Shaft>, data: &Dataset) -> Result<Vec<f64>, IdentError> {
        let simulated = simulate(model, data, &InitialState::Estimated)?;
        let rows = data.samples();
        let inner = EDGE_ROWS..rows.saturating_sub(EDGE_ROWS);
        let error = |i: usize| if inner.contains(&i) { self.output[i] - simulated.outputs[0][(i, 0)] } else { 0.0 };
        Ok((0..rows).map(error).collect())
    }

    /// Power of the encoders' noise at the output, (rad/s)².
    fn noise_power(&self, system: &StateSpace, inputs: &ShaftInputs<'_>) -> f64 {
        let density = |sample_time_s: f64| 2.0 * inputs.encoder_noise_rad_s.powi(2) * sample_time_s;
        let (dyno, engine) = (density(inputs.dyno_speed.sample_time_s), density(inputs.engine_speed.sample_time_s));
        let at = |k: usize| {
            let f = (k as f64 + 0.5) * NOISE_STEP_HZ;
            let gain = system.evaluate(Complex64::new(0.0, TAU * f))[(0, 1)].norm_sqr();
            let passed: f64 = self.filter.iter().map(|s| s.response(f).norm_sqr()).product();
            NOISE_STEP_HZ * passed * (dyno + gain * engine)
        };
        (0..(0.5 / (self.sample_time_s * NOISE_STEP_HZ)) as usize).map(at).sum()
    }

    fn validation(&self, inputs: &ShaftInputs<'_>, model: &GreyBoxModel<Shaft>) -> Result<Validation, EstimateError> {
        let of = |source| EstimateError::Ident { file: inputs.file.to_owned(), source };
        let first = self.estimation().end;
        let data = self.part(first..self.output.len()).map_err(of)?;
        let simulated = simulate(model, &data, &InitialState::Estimated).map_err(of)?;
        // Near the ends inputs between the samples rest on a guess.
        let (start, end) = (first + EDGE_ROWS, self.output.len() - EDGE_ROWS);
        let measured: Vec<f64> = self.output[start..end].iter().map(|w| w / RPM_RAD_S).collect();
        let modelled: Vec<f64> = (start..end).map(|i| simulated.outputs[0][(i - first, 0)] / RPM_RAD_S).collect();
        let trace = |values| Trace { start_s: self.time_s(start), sample_time_s: self.sample_time_s, values };
        Ok(Validation {
            stretch: Stretch { file: inputs.file.to_owned(), start_s: self.time_s(start), end_s: self.time_s(end) },
            quantity: "N_d".to_owned(),
            unit: "rpm".to_owned(),
            fit_percent: fit_percent(&measured, &modelled).map_err(of)?,
            rms_error: rms_error(&measured, &modelled).map_err(of)?,
            measured: trace(measured),
            modelled: trace(modelled),
            residuals: None,
        })
    }
}

/// Estimate of the parameters that people read, skews counted from the time stamps.
fn read_out(fit: &Fit<GreyBoxModel<Shaft>>, structure: &Shaft, clocks: Clocks, stretch: Stretch) -> Estimate {
    let theta = fit.parameters();
    let mut chosen =
        vec![(Quantity::Stiffness, theta[STIFFNESS], STIFFNESS), (Quantity::Damping, theta[DAMPING], DAMPING)];
    if structure.inertia.1 > 0.0 {
        chosen.push((Quantity::DynoInertia, theta[INERTIA], INERTIA));
    }
    for (k, (quantity, dated)) in
        [(Quantity::EngineSpeedSkew, clocks.engine_s), (Quantity::TorqueSkew, clocks.torque_s)].into_iter().enumerate()
    {
        if structure.skews[k].1 > 0.0 {
            chosen.push((quantity, dated + theta[SKEWS[k]], SKEWS[k]));
        }
    }
    let covariance = chosen.iter().map(|(_, _, i)| chosen.iter().map(|(_, _, j)| fit.covariance[(*i, *j)]).collect());
    let found: Vec<_> = chosen.iter().map(|(quantity, value, _)| (*quantity, *value)).collect();
    let search = (fit.iterations, fit.condition);
    estimate_of(&found, covariance.collect(), fit.degrees_of_freedom, stretch, search)
}
