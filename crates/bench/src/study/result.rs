//! The types a study is made of. They hold numbers and structure only; wording and drawing belong to the report.

use serde::Serialize;

use crate::model::{AssembledModel, ModelParameter};
use crate::{ControlMode, Diagnostic, Role};

/// Everything learnt from one campaign.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Study {
    /// Where it came from.
    pub provenance: Provenance,
    /// What the bench file states about the bench.
    pub bench: BenchFacts,
    /// The recordings that were looked at, used or not.
    pub recordings: Vec<RecordingSummary>,
    /// Delay of each torque signal.
    pub timing: Part<Timing>,
    /// PI with delay.
    pub speed_controller: Part<SpeedController>,
    /// Feed-forward of the speed controller.
    pub feed_forward: Part<FeedForward>,
    /// Inverter and machine, closed loop from T_d* to T_d.
    pub torque_control: Part<TorqueControl>,
    /// Stiffness and damping, with gate and skew.
    pub shaft: Part<Shaft>,
    /// The assembled model's analysis.
    pub whole: Part<WholeModel>,
    /// The assembled model itself, in SI, for those who compute with it.
    pub model: Option<AssembledModel>,
    /// Replays of recordings on the assembled model.
    pub replays: Vec<Replay>,
    /// Doubts.
    pub diagnostics: Vec<Diagnostic>,
}

/// Where a study came from: enough to repeat it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Provenance {
    /// Version of dynoid.
    pub version: String,
    /// The bench file, word for word.
    pub bench_file: String,
    /// Name of the bench file.
    pub bench_file_name: String,
    /// Seed, when the recordings were simulated.
    pub seed: Option<u64>,
}

/// What the bench file states.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BenchFacts {
    /// The bench's name.
    pub name: String,
    /// Load cell or torque flange.
    pub variant: BenchVariant,
    /// Cylinders of the engine.
    pub cylinders: u32,
    /// Strokes of the engine, 2 or 4.
    pub strokes: u32,
    /// J_d, kg m².
    pub dynamometer_inertia_kg_m2: f64,
    /// Its standard uncertainty, % of it, if stated.
    pub dynamometer_inertia_uncertainty_percent: Option<f64>,
    /// J_e, kg m².
    pub engine_inertia_kg_m2: f64,
    /// Its standard uncertainty, % of it, if stated.
    pub engine_inertia_uncertainty_percent: Option<f64>,
    /// Inverter torque limit, Nm.
    pub torque_limit_nm: Option<f64>,
    /// Shaft torque limit, Nm.
    pub shaft_torque_limit_nm: Option<f64>,
    /// Speed limit, rad/s.
    pub speed_limit_rad_s: Option<f64>,
}

/// How torque is measured at the bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BenchVariant {
    /// DTB: T_d measured by a load cell, shaft torque computed, two masses.
    LoadCell,
    /// TB: shaft torque measured by a flange, T_d computed, dual-mass flywheel.
    TorqueFlange,
}

/// One recording as the study saw it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordingSummary {
    /// File, as the user knows it.
    pub file: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
    /// Label, if it has one.
    pub label: Option<String>,
    /// Length, s.
    pub duration_s: f64,
    /// Mean dynamometer speed, rad/s.
    pub mean_speed_rad_s: Option<f64>,
    /// Sample times by role.
    pub sample_times_s: Vec<(Role, f64)>,
    /// What it was used for.
    pub used_for: Vec<String>,
}

/// A part of the study, estimated or not.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "status", rename_all = "snake_case")]
pub enum Part<T> {
    /// The estimate.
    Estimated(T),
    /// What is needed before it can be estimated.
    NotEstimated {
        /// Each need; any one of the alternatives inside fulfils it.
        needs: Vec<Need>,
    },
}

impl<T> Part<T> {
    /// The estimate, if there is one.
    pub fn estimated(&self) -> Option<&T> {
        match self {
            Part::Estimated(value) => Some(value),
            Part::NotEstimated { .. } => None,
        }
    }
}

/// Something a part needs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Need {
    /// A recording of one of these experiments, e.g. `BS_T_NT`.
    Recording {
        /// Labels, any one of which will do.
        any_of: Vec<String>,
    },
    /// A channel in the recording that is there.
    Channel {
        /// File.
        file: String,
        /// Role.
        role: Role,
    },
    /// Another part of the study.
    Part {
        /// Its name.
        name: String,
    },
    /// Data on which the estimate converges to something usable.
    UsableData {
        /// File.
        file: String,
        /// The estimator's own words.
        reason: String,
    },
}

/// One estimated number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parameter {
    /// Symbol of the thesis, e.g. `K_p`.
    pub symbol: String,
    /// What it is, e.g. `proportional gain`.
    pub name: String,
    /// Unit, as written in reports.
    pub unit: String,
    /// Estimate.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
    /// Degrees of freedom of the Student-t interval.
    pub degrees_of_freedom: f64,
    /// 95 % interval.
    pub interval: (f64, f64),
}

/// A stretch of one recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stretch {
    /// File.
    pub file: String,
    /// Start, s of the recording's clock.
    pub start_s: f64,
    /// End, s.
    pub end_s: f64,
}

/// Parameters and their joint uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Parameters.
    pub parameters: Vec<Parameter>,
    /// Covariance, in the parameters' order and units.
    pub covariance: Vec<Vec<f64>>,
    /// Data it was estimated from.
    pub stretches: Vec<Stretch>,
    /// Iterations taken; 0 for a direct solution.
    pub iterations: usize,
    /// Condition number of the scaled Jacobian or regressor.
    pub condition: f64,
}

impl Estimate {
    /// The parameter with this symbol.
    pub fn parameter(&self, symbol: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|p| p.symbol == symbol)
    }
}

/// A uniformly sampled curve for plots, in the unit people use.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trace {
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Sample time, s.
    pub sample_time_s: f64,
    /// Values.
    pub values: Vec<f64>,
}

/// Measured against modelled, on data the estimate has not seen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Validation {
    /// The held-out stretch.
    pub stretch: Stretch,
    /// What is compared, e.g. `T_d*`.
    pub quantity: String,
    /// Unit of the traces.
    pub unit: String,
    /// 100(1 − ‖y − ŷ‖/‖y − ȳ‖).
    pub fit_percent: f64,
    /// Root of the mean squared error, in `unit`.
    pub rms_error: f64,
    /// Measured.
    pub measured: Trace,
    /// Modelled.
    pub modelled: Trace,
    /// Residual tests, where the sampling makes them meaningful.
    pub residuals: Option<ResidualTest>,
}

/// Residual correlations with their region of confidence (Ljung 1999, §16.6; thesis §2.3.5).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResidualTest {
    /// Sample time of the residuals, s.
    pub sample_time_s: f64,
    /// Level of the regions, e.g. 0.99.
    pub level: f64,
    /// Autocorrelation at lags 0…M, normalised to one at lag 0.
    pub autocorrelation: Vec<f64>,
    /// Half-width of the region for the autocorrelation at lags 1…M.
    pub autocorrelation_bound: f64,
    /// Cross-correlation of residual and past input at lags −M…M, normalised. Positive lags: the input comes first.
    pub cross_correlation: Vec<f64>,
    /// Half-width of the region for each cross-correlation lag.
    pub cross_correlation_bound: f64,
    /// Name of the input.
    pub input: String,
}

impl ResidualTest {
    /// Share of lags outside the region beyond which residuals are called correlated with the input: at 99 % and 26 lags,
    /// chance puts two or more outside less than once in thirty recordings.
    pub const MANY_OUTSIDE: f64 = 0.05;

    /// Share of the lags 0…M at which the residual depends on present and past input beyond the region.
    pub fn share_outside(&self) -> f64 {
        let past = &self.cross_correlation[self.cross_correlation.len() / 2..];
        let outside = past.iter().filter(|c| c.abs() > self.cross_correlation_bound).count();
        outside as f64 / past.len().max(1) as f64
    }
}

/// Delays of the torque signals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Timing {
    /// One row a signal.
    pub delays: Vec<SignalDelay>,
}

/// Delay of one signal, by several routes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SignalDelay {
    /// The signal.
    pub role: Role,
    /// Against the torque demand T_d*.
    pub against_demand: Option<Parameter>,
    /// Against the bend in N_d (the mechanical effect of T_d).
    pub against_speed_bend: Option<Parameter>,
    /// The same delay against T_d* by each route that applies. Routes without a model see the mean delay over the demand's
    /// spectrum, so that they agree to about a tenth of a millisecond at best.
    pub routes: Vec<DelayRoute>,
    /// Length of the moving average that reproduces the signal from N_d and T_d,calc, in samples of N_d.
    pub moving_average_length: Option<usize>,
    /// Dynamics of a load cell: its own delay τ_cell in s, ω_n in rad/s, ζ.
    pub dynamics: Option<Estimate>,
    /// Where it was measured.
    pub stretch: Stretch,
}

/// A delay by one route.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DelayRoute {
    /// What the route is called.
    pub name: String,
    /// Delay, s.
    pub delay_s: f64,
    /// 95 % interval, s; `None` where the recording is too short to tell.
    pub interval_s: Option<(f64, f64)>,
    /// How far the route may be off by what it is, s: what of the signal's dynamics it takes for delay.
    pub systematic_s: f64,
}

impl SignalDelay {
    /// Whether all routes agree with `against_demand`, within their intervals and what they may be off by; `None` where there
    /// is nothing to compare.
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
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpeedController {
    /// K_p in Nm/rpm, K_i in Nm/(rpm s), τ in s, I_0 (initial integrator state) in Nm, T_g (encoder gate) in s.
    /// K_p is that of integration by forward Euler; backward Euler has the same sequence with K_p less by K_i T.
    pub estimate: Estimate,
    /// The zero −K_i/K_p of (K_p s + K_i)/s, rad/s.
    pub zero: Parameter,
    /// Sample time of the controller, s.
    pub sample_time_s: f64,
    /// Coefficients b_0, b_1 of the discrete form (b_0 + b_1 q⁻¹)/(1 − q⁻¹) on the speed error in rpm.
    pub discrete: (f64, f64),
    /// On held-out data, with the delay.
    pub validation: Validation,
    /// On the same data, with τ = 0 but re-estimated: the residuals that betray the delay.
    pub without_delay: Validation,
}

/// Feed-forward k N_d* + m + k_a dN_d*/dt; m is not separable from the integrator's initial state.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FeedForward {
    /// k in Nm/rpm, k_a in Nm/(rpm/s).
    pub estimate: Estimate,
    /// Held-out data: PI and feed-forward.
    pub validation: Validation,
    /// Same data: PI alone.
    pub pi_alone: Validation,
}

/// Closed-loop torque control, T_d* → T_d.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TorqueControl {
    /// Delay alone: τ in s.
    pub pure_delay: Estimate,
    /// Delay and lag e^{−sτ} a/(s + a): τ in s, a in rad/s, and their total delay τ + 1/a in s.
    pub delay_and_lag: Estimate,
    /// Held-out data, delay alone.
    pub pure_delay_validation: Validation,
    /// Held-out data, delay and lag.
    pub delay_and_lag_validation: Validation,
}

/// Shaft: T_shaft = K ∫(ω_e − ω_d) dt + B (ω_e − ω_d).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Shaft {
    /// K in Nm/rad, B in Nm s/rad, gate and skews in s, drag in Nm s/rad.
    pub estimate: Estimate,
    /// The zero −K/B of (K + B s)/s, rad/s.
    pub zero: Parameter,
    /// What a fit that ignores gate and skew gives on the same data: K, B, zero.
    pub ignoring_timing: Estimate,
    /// Equation error over its standard deviation, by frequency.
    pub residual_spectrum: ResidualSpectrum,
    /// Frequency response Δω → T_shaft measured and modelled.
    pub frequency_response: MeasuredResponse,
    /// T_shaft on a held-out stretch.
    pub validation: Validation,
    /// Other recordings and other routes: name and estimate.
    pub cross_checks: Vec<(String, Estimate)>,
    /// J_d (where a load cell is the bench's) and J_e as if nothing were known of them, with K, B and timing: the recording
    /// in torque control that they are from, and the estimate.
    pub inertias: Option<(String, Estimate)>,
}

/// Equation error of a frequency-domain fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResidualSpectrum {
    /// Frequencies used, Hz.
    pub frequencies_hz: Vec<f64>,
    /// |error|/σ at each.
    pub normalised_magnitude: Vec<f64>,
    /// 99 % of the magnitudes lie below this if the model is right.
    pub bound: f64,
    /// Frequencies left out, Hz.
    pub excluded_hz: Vec<f64>,
}

/// A measured frequency response beside a model's.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuredResponse {
    /// Frequencies, Hz.
    pub frequencies_hz: Vec<f64>,
    /// Measured gain in dB.
    pub measured_gain_db: Vec<f64>,
    /// Measured phase, degrees.
    pub measured_phase_deg: Vec<f64>,
    /// Modelled gain in dB.
    pub modelled_gain_db: Vec<f64>,
    /// Modelled phase, degrees.
    pub modelled_phase_deg: Vec<f64>,
}

/// Analysis of the assembled model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WholeModel {
    /// Resonance of T_d → T_shaft in torque control, Hz.
    pub resonance_hz: Parameter,
    /// Gain of T_d → T_shaft at the resonance.
    pub resonance_gain: Parameter,
    /// Static gain J_e/(J_d + J_e) of T_d → T_shaft.
    pub static_gain: f64,
    /// Engine speed at which firing meets the resonance, rpm.
    pub firing_meets_resonance_rpm: Parameter,
    /// Damping ratio of the resonant pole pair.
    pub damping_ratio: Parameter,
    /// Bode curves with confidence bands.
    pub bode: Vec<BodeCurve>,
    /// Gains measured by sine tests.
    pub sine_points: Vec<SinePoint>,
    /// Phase and gain margin of the speed loop, degrees and dB, with crossover in Hz.
    pub speed_loop_margins: Option<Margins>,
    /// What each parameter does to resonance, gain, damping ratio and the speed loop.
    pub influences: Vec<Influence>,
}

/// What each parameter does to a result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Influence {
    /// Symbol of the result.
    pub symbol: String,
    /// What it is.
    pub name: String,
    /// The parameters that move it.
    pub parameters: Vec<ParameterInfluence>,
}

/// What a parameter does to a result.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ParameterInfluence {
    /// The parameter.
    pub parameter: ModelParameter,
    /// By how many per cent the result moves for one per cent of the parameter.
    pub elasticity: f64,
    /// The part of the result's variance that would go if the parameter were known exactly, 0 … 1; parameters of one part
    /// are known together, so that these parts need not add up to one. `None` where the parameter's uncertainty is not known.
    pub variance_share: Option<f64>,
}

/// Stability margins of the speed loop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Margins {
    /// Gain margin, dB.
    pub gain_margin_db: f64,
    /// Phase margin, degrees.
    pub phase_margin_deg: f64,
    /// Gain crossover, Hz.
    pub crossover_hz: f64,
}

/// One Bode curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BodeCurve {
    /// Input, e.g. `T_d`.
    pub input: String,
    /// Output, e.g. `T_shaft`.
    pub output: String,
    /// Remark that tells curves with equal ends apart, e.g. `with feed-forward`.
    pub variant: Option<String>,
    /// Control mode.
    pub mode: ControlMode,
    /// Frequencies, Hz.
    pub frequencies_hz: Vec<f64>,
    /// Gain, dB.
    pub gain_db: Vec<f64>,
    /// Phase, degrees.
    pub phase_deg: Vec<f64>,
    /// 95 % band of the gain, dB: lower, upper.
    pub gain_band_db: (Vec<f64>, Vec<f64>),
    /// Unit of the gain before dB, e.g. `Nm/Nm`.
    pub unit: String,
}

/// Gain measured at one sine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SinePoint {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Measured gain T_shaft/T_d, amplitudes by least squares over whole periods.
    pub gain: f64,
    /// Its standard error, from the noise at neighbouring frequencies.
    pub standard_error: f64,
    /// The same gain the thesis's way: band-pass and A = √2·RMS (7.1).
    pub band_pass_gain: f64,
    /// Gain of the model at that frequency, for a constant engine torque (7.2).
    pub model_gain: f64,
    /// Gain of the model with the engine torque that acted, T_e = J_e dω_e/dt + T_shaft; to be held against `gain`.
    /// `None` where N_e was not recorded.
    pub model_gain_with_engine: Option<f64>,
    /// Measured gain without the part that the engine torque caused; to be held against `model_gain`, and to be drawn on
    /// the curve of (7.2). `None` where N_e was not recorded.
    pub gain_corrected_for_engine: Option<f64>,
    /// Whether the sine meets an engine order, where the fired engine excites the shaft by itself: not to be relied on.
    pub at_engine_order: bool,
    /// File.
    pub file: String,
}

/// A recording replayed on the assembled model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Replay {
    /// The recording's file and label.
    pub stretch: Stretch,
    /// Label.
    pub label: String,
    /// Control mode.
    pub mode: ControlMode,
    /// Whether any part of the model was estimated from this recording.
    pub seen_in_estimation: bool,
    /// N_d, N_e, T_d, T_shaft: measured against modelled.
    pub signals: Vec<Validation>,
}
