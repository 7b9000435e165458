//! Findings of an analysis of the assembled model.

use numerics::null::nan_if_null;
use rig::ControlMode;
use rig::results::{Parameter, Quantity, read_notation, write_notation};
use serde::{Deserialize, Serialize};

use crate::model::ModelParameter;

/// Analysis of the assembled model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WholeModel {
    /// Resonance of T_d → T_shaft in torque control, Hz.
    pub resonance_hz: Parameter,
    /// Gain of T_d → T_shaft at the resonance.
    pub resonance_gain: Parameter,
    /// Static gain J_e/(J_d + J_e) of T_d → T_shaft.
    #[serde(deserialize_with = "nan_if_null")]
    pub static_gain: f64,
    /// Engine speed at which firing meets the resonance.
    #[serde(rename = "firing_meets_resonance_rpm")]
    pub firing_meets_resonance: Parameter,
    /// Damping ratio of the resonant pole pair.
    pub damping_ratio: Parameter,
    /// Bode curves with confidence bands.
    pub bode: Vec<BodeCurve>,
    /// Gains measured by sine tests.
    pub sine_points: Vec<SinePoint>,
    /// Phase and gain margin of the speed loop, degrees and dB, with crossover in Hz.
    pub speed_loop_margins: Option<Margins>,
    /// Influence of each parameter on resonance, gain, damping ratio and the speed loop.
    pub influences: Vec<Influence>,
}

/// Influence of all parameters on a result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Influence {
    /// The result.
    #[cfg_attr(feature = "schema", schemars(with = "rig::results::WrittenQuantity"))]
    #[serde(flatten, serialize_with = "write_notation", deserialize_with = "read_notation")]
    pub quantity: Quantity,
    /// The parameters that move it.
    pub parameters: Vec<ParameterInfluence>,
}

/// Influence of one parameter on a result.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ParameterInfluence {
    /// The parameter.
    pub parameter: ModelParameter,
    /// By how many per cent the result moves for one per cent of the parameter.
    #[serde(deserialize_with = "nan_if_null")]
    pub elasticity: f64,
    /// The part of the result's variance that would go if the parameter were known exactly, 0 … 1; parameters of one
    /// part are known together, so that these parts need not add up to one. `None` where the parameter's uncertainty is
    /// not known.
    pub variance_share: Option<f64>,
}

/// Stability margins of the speed loop.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Margins {
    /// Gain margin, dB.
    #[serde(deserialize_with = "nan_if_null")]
    pub gain_margin_db: f64,
    /// Phase margin, degrees.
    #[serde(deserialize_with = "nan_if_null")]
    pub phase_margin_deg: f64,
    /// Gain crossover, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub crossover_hz: f64,
}

/// One Bode curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BodeCurve {
    /// Input, e.g. `T_d`.
    pub input: String,
    /// Output, e.g. `T_shaft`.
    pub output: String,
    /// Remark that separates curves with equal ends, e.g. `with feed-forward`.
    pub variant: Option<String>,
    /// Control mode.
    pub mode: ControlMode,
    /// Frequencies, Hz.
    pub frequencies_hz: Vec<f64>,
    /// Gain, dB.
    #[serde(deserialize_with = "nan_if_null")]
    pub gain_db: Vec<f64>,
    /// Phase, degrees.
    #[serde(deserialize_with = "nan_if_null")]
    pub phase_deg: Vec<f64>,
    /// 95 % band of the gain, dB: lower, upper.
    #[serde(deserialize_with = "nan_if_null")]
    pub gain_band_db: (Vec<f64>, Vec<f64>),
    /// Unit of the gain before dB, e.g. `Nm/Nm`.
    pub unit: String,
}

/// Gain measured at one sine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SinePoint {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Measured gain T_shaft/T_d, amplitudes by least squares over whole periods.
    #[serde(deserialize_with = "nan_if_null")]
    pub gain: f64,
    /// Its standard error, from the noise at neighbouring frequencies.
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_error: f64,
    /// The same gain the thesis's way: band-pass and A = √2·RMS (7.1).
    #[serde(deserialize_with = "nan_if_null")]
    pub band_pass_gain: f64,
    /// Gain of the model at that frequency, for a constant engine torque (7.2).
    #[serde(deserialize_with = "nan_if_null")]
    pub model_gain: f64,
    /// Gain of the model with the engine torque that acted, T_e = J_e dω_e/dt + T_shaft; to be compared with `gain`.
    /// `None` where N_e was not recorded.
    pub model_gain_with_engine: Option<f64>,
    /// Measured gain without the part that the engine torque caused; to be compared with `model_gain`, and to be drawn
    /// on the curve of (7.2). `None` where N_e was not recorded.
    pub gain_corrected_for_engine: Option<f64>,
    /// True where the sine meets an engine order, at which the fired engine excites the shaft by itself: not to be
    /// relied on.
    pub at_engine_order: bool,
    /// File.
    pub file: String,
}
