//! The assembled bench model: parameters in SI, linear forms, resonance, and how uncertainty passes through them.
//!
//! Mechanics (6.1, 6.4, 2.7): J_d dω_d/dt = T_shaft − T_d, J_e dω_e/dt = T_e − T_shaft,
//! T_shaft = K Δθ + B (ω_e − ω_d) with dΔθ/dt = ω_e − ω_d. T_d is positive when it brakes.

mod assembled;
mod linear;
mod of_bench;
mod parameter;
mod resonance;
mod uncertainty;

use serde::{Deserialize, Serialize};

pub use assembled::AssembledModel;
pub use linear::mean_over;
pub(crate) use parameter::short;
pub use parameter::{Bound, ModelParameter};
pub use resonance::Resonance;
pub use uncertainty::{Derived, ModelUncertainty, PartCovariance, UncertaintyError};

/// Part of a sample below which two instants count as one.
pub(crate) const INSTANT: f64 = 1e-9;

/// Two masses and a shaft.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Mechanics {
    /// J_d, kg m².
    pub dyno_inertia_kg_m2: f64,
    /// J_e, kg m², flywheel included.
    pub engine_inertia_kg_m2: f64,
    /// K, Nm/rad.
    pub stiffness_nm_per_rad: f64,
    /// B, Nm s/rad.
    pub damping_nm_s_per_rad: f64,
}

/// The speed controller's PI part with its transport delay, T_d* = e^{−sτ}(K_p + K_i/s)(ω_d − ω_d*) (6.2, 6.6), as it
/// runs: every `sample_time_s`, on the encoder's reading, its output held. The output of an update takes effect τ
/// later.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PiController {
    /// K_p, Nm s/rad.
    pub proportional_nm_s_per_rad: f64,
    /// K_i, Nm/rad.
    pub integral_nm_per_rad: f64,
    /// τ, s.
    pub delay_s: f64,
    /// The delay of ω_d* in the speed error, s: τ where the delay acts on that error, less where it acts on the
    /// measured speed.
    pub demand_delay_s: f64,
    /// Time between updates, s.
    pub sample_time_s: f64,
}

/// Feed-forward k ω_d* + k_a dω_d*/dt (6.7 and the acceleration term). The constant m is part of the integrator's
/// initial state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FeedForwardGains {
    /// k, Nm s/rad.
    pub speed_nm_s_per_rad: f64,
    /// k_a, Nm s²/rad.
    pub acceleration_nm_s2_per_rad: f64,
    /// Its delay, s: zero where it acts at once.
    pub delay_s: f64,
}

/// Torque control: T_d = e^{−s d} a/(s + a) T_d*.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TorqueControlModel {
    /// d, s.
    pub delay_s: f64,
    /// a, rad/s; `None` for a delay alone.
    pub bandwidth_rad_s: Option<f64>,
}

/// The assembled bench. What could not be estimated is `None`; then speed control (no controller, no torque control) or
/// torque demand (no torque control) cannot be simulated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BenchModel {
    /// Inertias and shaft.
    pub mechanics: Mechanics,
    /// PI of the speed controller.
    pub speed_controller: Option<PiController>,
    /// Feed-forward of the speed controller.
    pub feed_forward: Option<FeedForwardGains>,
    /// Torque control.
    pub torque_control: Option<TorqueControlModel>,
    /// Limit of |T_d*|, Nm.
    pub torque_limit_nm: Option<f64>,
    /// Time over which an encoder averages the speed, s; the reading at t is the mean over t − gate … t.
    pub encoder_gate_s: f64,
}

impl BenchModel {
    /// Samples of the controller by which ω_d* is late in the speed error, beside the reading, and in the feed-forward.
    /// Both are those of ω_d* as the controller has it, [`Self::demand_lead`] samples before recordings have it. Below
    /// zero the error waits so many samples for its demand: its output is not needed before.
    pub fn demand_lags(&self) -> (isize, usize) {
        let (error, feed_forward) = self.recorded_demand_lags();
        let lead = self.demand_lead() as isize;
        (error + lead, (feed_forward + lead).unsigned_abs())
    }

    /// Samples by which recordings have ω_d* later than the controller has it: a recorded demand is advanced by as many
    /// before a model takes it that runs in real time. At least so many that no delay of the demand is negative, and
    /// that the error has its demand when its output acts.
    pub fn demand_lead(&self) -> usize {
        let Some(pi) = self.speed_controller else { return 0 };
        let (error, _) = self.recorded_demand_lags();
        let fed_s = self.feed_forward.map_or(0.0, |feed| feed.delay_s);
        let early = (-pi.demand_delay_s.min(fed_s) / pi.sample_time_s).round() as isize;
        let acts_after_s = pi.delay_s + self.torque_control.map_or(0.0, |control| control.delay_s);
        let longest_wait = (acts_after_s / pi.sample_time_s + INSTANT).floor() as isize;
        early.max(-error - longest_wait).max(0).unsigned_abs()
    }

    /// The same of ω_d* as recordings have it, which may be later than the controller has it: negative then.
    pub(crate) fn recorded_demand_lags(&self) -> (isize, isize) {
        let Some(pi) = self.speed_controller else { return (0, 0) };
        let samples = |time_s: f64| (time_s / pi.sample_time_s).round() as isize;
        (samples(pi.demand_delay_s - pi.delay_s), samples(self.feed_forward.map_or(0.0, |feed| feed.delay_s)))
    }

    /// The same whose input is ω_d* as the controller has it. Recordings may have it whole samples later, so that a
    /// delay is negative; without that, what runs in real time would have to know the demand in advance.
    #[must_use]
    pub fn with_demand_of_controller(&self) -> Self {
        self.with_demand_advanced(self.demand_lead())
    }

    /// The same whose input is ω_d* so many samples of the controller before recordings have it.
    #[must_use]
    pub fn with_demand_advanced(&self, samples: usize) -> Self {
        let Some(pi) = self.speed_controller else { return self.clone() };
        let early_s = samples as f64 * pi.sample_time_s;
        BenchModel {
            speed_controller: Some(PiController { demand_delay_s: pi.demand_delay_s + early_s, ..pi }),
            feed_forward: self.feed_forward.map(|feed| FeedForwardGains { delay_s: feed.delay_s + early_s, ..feed }),
            ..self.clone()
        }
    }

    /// The model without feed-forward.
    pub fn without_feed_forward(&self) -> Self {
        BenchModel { feed_forward: None, ..self.clone() }
    }
}
