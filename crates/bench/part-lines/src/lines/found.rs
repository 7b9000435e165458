//! Lines as they are found in a recording.

use numerics::null::nan_if_null;
use rig::{ExperimentLabel, Role};
use serde::{Deserialize, Serialize};

use super::campbell::ShortSpectrum;
use super::cause::Cause;
use crate::lines::track::OrderTrack;

/// Signals that the masses move.
pub(super) const OF_THE_MASSES: [Role; 4] =
    [Role::DynoSpeed, Role::EngineSpeed, Role::SystemShaftTorque, Role::FlangeTorque];

/// Sensors with a resonance of their own, and the signal that shows the same without it.
pub(super) const SENSORS: [(Role, Role); 1] = [(Role::LoadCellTorque, Role::AirGapTorque)];

/// Slower than this, Hz, is drift; a line without a cause cannot be separated from it.
pub(super) const DRIFT_HZ: f64 = 3.0;

/// A speed changes where it ranges over more than this share of its mean.
pub(super) const CHANGES: f64 = 0.03;

/// Findings of one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordingLines {
    /// The file.
    pub file: String,
    /// The experiment's label.
    pub label: ExperimentLabel,
    /// The order of the firing; none without the shaft.
    pub firing_order: Option<f64>,
    /// Its parts: each sine of a sine test, or the whole.
    pub parts: Vec<PartLines>,
}

/// Findings of a part of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PartLines {
    /// From, s of the recording's clock.
    #[serde(deserialize_with = "nan_if_null")]
    pub start_s: f64,
    /// To, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub end_s: f64,
    /// Mean speed of the engine, or of the dynamometer where that is not recorded, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_rad_s: f64,
    /// Lowest and highest speed, each a mean over a tracking window, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_range_rad_s: [f64; 2],
    /// Demanded sines, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub demanded_hz: Vec<f64>,
    /// Signals.
    pub signals: Vec<SignalLines>,
}

/// A signal's spectrum and its lines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SignalLines {
    /// Which.
    pub role: Role,
    /// Time between its samples, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub sample_time_s: f64,
    /// Frequencies of the spectrum, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub frequency_hz: Vec<f64>,
    /// Amplitude of a sine there, in SI.
    #[serde(deserialize_with = "nan_if_null")]
    pub amplitude: Vec<f64>,
    /// Lines, the strongest first.
    pub lines: Vec<Line>,
    /// Spectra of moments, for a Campbell map.
    pub short: Vec<ShortSpectrum>,
    /// Orders over time, where the speed changes.
    pub tracks: Vec<OrderTrack>,
}

/// A line, or a broad peak.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Line {
    /// Where it shows, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub frequency_hz: f64,
    /// Amplitude, in SI; of a broad peak, of what a bandwidth of half a hertz holds.
    #[serde(deserialize_with = "nan_if_null")]
    pub amplitude: f64,
    /// Its standard error; none of a broad peak.
    pub standard_error: Option<f64>,
    /// Where it comes from.
    pub cause: Cause,
}
