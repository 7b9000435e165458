//! The results of the bench's parts.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::estimate::{Estimate, Parameter, Stretch};
use super::validation::Validation;
use numerics::null::nan_if_null;

use crate::numbers::unscaled;
use crate::quantity::Quantity;
use crate::role::Role;

/// Delays of the torque signals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Timing {
    /// One row a signal.
    pub delays: Vec<SignalDelay>,
}

/// Delay of one signal, by several routes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SignalDelay {
    /// The signal.
    pub role: Role,
    /// Against the torque demand T_d*.
    pub against_demand: Option<Parameter>,
    /// Against the bend in N_d (the mechanical effect of T_d).
    pub against_speed_bend: Option<Parameter>,
    /// The same delay against T_d* by each route that applies. Routes without a model see the mean delay over the
    /// demand's spectrum, so that they agree to about a tenth of a millisecond at best.
    pub routes: Vec<DelayRoute>,
    /// Length of the moving average that reproduces the signal from N_d and T_d,calc, in samples of N_d.
    pub moving_average_length: Option<usize>,
    /// Dynamics of a load cell: its own delay τ_cell in s, ω_n in rad/s, ζ.
    pub dynamics: Option<Estimate>,
    /// Where it was measured.
    pub stretch: Stretch,
}

/// A delay by one route.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DelayRoute {
    /// Name of the route.
    pub name: String,
    /// Delay, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub delay_s: f64,
    /// 95 % interval, s; `None` where the recording is too short.
    #[serde(deserialize_with = "nan_if_null")]
    pub interval_s: Option<(f64, f64)>,
    /// How far the route may be off by what it is, s: what of the signal's dynamics it takes for delay.
    #[serde(deserialize_with = "nan_if_null")]
    pub systematic_s: f64,
}

impl SignalDelay {
    /// Tells whether all routes agree with `against_demand`, within their intervals and what they may be off by; `None`
    /// where there is nothing to compare.
    #[must_use]
    pub fn routes_agree(&self) -> Option<bool> {
        let own = self.against_demand.as_ref()?;
        let half = |(low, high): (f64, f64)| 0.5 * (high - low);
        let agrees = |route: &DelayRoute| {
            let allowed = route.interval_s.map_or(0.0, half) + half(own.interval) + route.systematic_s;
            (route.delay_s - own.value).abs() <= allowed
        };
        (self.routes.len() > 1).then(|| self.routes.iter().all(agrees))
    }
}

/// PI with delay: T_d* = e^{−sτ}(K_p + K_i/s)(N_d − N_d*) + x_0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SpeedController {
    /// K_p, K_i, τ, I_0 (initial integrator state) and, where the data show it, T_g (encoder gate).
    /// K_p is that of integration by forward Euler; backward Euler has the same sequence with K_p less by K_i T.
    pub estimate: Estimate,
    /// The zero −K_i/K_p of (K_p s + K_i)/s, rad/s.
    pub zero: Parameter,
    /// Sample time of the controller, s.
    pub sample_time_s: f64,
    /// Coefficients b_0, b_1 of the discrete form (b_0 + b_1 q⁻¹)/(1 − q⁻¹) on the speed error, Nm s/rad; written on
    /// that in rpm.
    #[cfg_attr(feature = "schema", schemars(with = "(f64, f64)"))]
    #[serde(serialize_with = "write_discrete", deserialize_with = "read_discrete")]
    pub discrete: (f64, f64),
    /// On held-out data, with the delay.
    pub validation: Validation,
    /// On the same data, with τ = 0 but re-estimated: the residuals that betray the delay.
    pub without_delay: Validation,
}

/// b_0 and b_1 in the unit people read.
fn write_discrete<S: Serializer>(discrete: &(f64, f64), serializer: S) -> Result<S::Ok, S::Error> {
    let per_si = Quantity::PresentErrorGain.notation().per_si;
    (discrete.0 * per_si, discrete.1 * per_si).serialize(serializer)
}

/// b_0 and b_1 from the unit people read; null is read as NaN.
fn read_discrete<'de, D: Deserializer<'de>>(deserializer: D) -> Result<(f64, f64), D::Error> {
    let (present, previous): (f64, f64) = nan_if_null(deserializer)?;
    let per_si = Quantity::PresentErrorGain.notation().per_si;
    Ok((unscaled(present, &[per_si]), unscaled(previous, &[per_si])))
}

/// Feed-forward k N_d* + m + k_a dN_d*/dt; m is not separable from the integrator's initial state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FeedForward {
    /// k and k_a. Their intervals also hold what they are where the delay acts at another of the places that the
    /// recording allows; their standard errors are those of the first place.
    pub estimate: Estimate,
    /// By how much N_d* is late in the controller.
    pub lags: DemandLags,
    /// Where the controller's delay may act, the likeliest first; empty where N_d* is late in a way that no place
    /// explains.
    pub delay_places: Vec<DelayPlace>,
    /// Held-out data: PI and feed-forward.
    pub validation: Validation,
    /// Same data: PI alone.
    pub pi_alone: Validation,
}

/// Samples of the controller by which N_d* is late where it is used; −1 where it is recorded one sample after the
/// controller has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DemandLags {
    /// In the speed error.
    pub speed_error: i32,
    /// In the feed-forward.
    pub feed_forward: i32,
}

/// Where the delay of a speed controller acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum DelayPlace {
    /// On the measured speed alone.
    MeasuredSpeed,
    /// On the speed error: PI is late, and the feed-forward acts at once (thesis 6.2).
    SpeedError,
    /// On the whole output: PI and feed-forward.
    WholeOutput,
}

/// Closed-loop torque control, T_d* → T_d.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TorqueControl {
    /// Delay alone: τ in s.
    pub pure_delay: Estimate,
    /// Delay and lag e^{−sτ} a/(s + a): τ in s, a in rad/s, and their total delay τ + 1/a in s.
    pub delay_and_lag: Estimate,
    /// Held-out data, delay alone.
    pub pure_delay_validation: Validation,
    /// Held-out data, delay and lag.
    pub delay_and_lag_validation: Validation,
    /// Skew δ_T of T_d,calc in s that the delays are without; `None` where they are as recorded and may contain one.
    pub torque_skew: Option<Parameter>,
}

impl TorqueControl {
    /// The same without what the clock of T_d,calc adds to the delays: its skew against N_d, and with it against T_d*.
    ///
    /// The errors count as independent. Where the shaft was estimated from the torque that this model gives, both
    /// contain the error of τ, which the difference does not: the uncertainty is then too large rather than too small.
    #[must_use]
    pub fn without_skew(mut self, skew: &Parameter) -> Self {
        let delays = [Quantity::TorqueControlDelay, Quantity::TorqueControlTotalDelay];
        for estimate in [&mut self.pure_delay, &mut self.delay_and_lag] {
            let moved = estimate.parameters.iter_mut().filter(|one| delays.contains(&one.quantity));
            moved.for_each(|one| one.value -= skew.value);
            estimate.add_systematic(&delays, skew.standard_error);
        }
        self.torque_skew = Some(skew.clone());
        self
    }
}

/// Shaft: T_shaft = K ∫(ω_e − ω_d) dt + B (ω_e − ω_d).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Shaft {
    /// K in Nm/rad, B in Nm s/rad, gate and skews in s, drag in Nm s/rad.
    pub estimate: Estimate,
    /// The zero −K/B of (K + B s)/s, rad/s.
    pub zero: Parameter,
    /// K, B and zero of a fit on the same data that ignores gate and skew.
    pub ignoring_timing: Estimate,
    /// Equation error over its standard deviation, by frequency.
    pub residual_spectrum: ResidualSpectrum,
    /// Frequency response Δω → T_shaft measured and modelled.
    pub frequency_response: MeasuredResponse,
    /// T_shaft on a held-out stretch.
    pub validation: Validation,
    /// Other recordings and other routes: name and estimate.
    pub cross_checks: Vec<(String, Estimate)>,
    /// J_d (where a load cell is the bench's) and J_e as if nothing were known of them, with K, B and timing: the
    /// recording in torque control that they are from, and the estimate.
    pub inertias: Option<(String, Estimate)>,
    /// Errors of K and B that come from prior knowledge. Documents of earlier versions do not hold them.
    #[serde(default)]
    pub shared_errors: Vec<SharedError>,
}

/// Errors of K and B that come from the error of one thing known beforehand. It is the same thing in every recording of
/// a bench, so more recordings do not make its error smaller.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SharedError {
    /// Quantity known beforehand.
    pub known: Quantity,
    /// The errors of K and B if it is wrong by one standard uncertainty, Nm/rad and Nm s/rad.
    #[serde(deserialize_with = "nan_if_null")]
    pub of_shaft: [f64; 2],
}

/// Equation error of a frequency-domain fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ResidualSpectrum {
    /// Frequencies used, Hz.
    pub frequencies_hz: Vec<f64>,
    /// |error|/σ at each.
    #[serde(deserialize_with = "nan_if_null")]
    pub normalised_magnitude: Vec<f64>,
    /// 99 % of the magnitudes lie below this if the model is right.
    #[serde(deserialize_with = "nan_if_null")]
    pub bound: f64,
    /// Frequencies left out, Hz.
    pub excluded_hz: Vec<f64>,
}

/// A measured frequency response beside a model's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MeasuredResponse {
    /// Frequencies, Hz.
    pub frequencies_hz: Vec<f64>,
    /// Measured gain in dB.
    #[serde(deserialize_with = "nan_if_null")]
    pub measured_gain_db: Vec<f64>,
    /// Measured phase, degrees.
    #[serde(deserialize_with = "nan_if_null")]
    pub measured_phase_deg: Vec<f64>,
    /// Modelled gain in dB.
    #[serde(deserialize_with = "nan_if_null")]
    pub modelled_gain_db: Vec<f64>,
    /// Modelled phase, degrees.
    #[serde(deserialize_with = "nan_if_null")]
    pub modelled_phase_deg: Vec<f64>,
}
