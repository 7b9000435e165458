//! An order over a recording in which the speed moves.

use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};

/// An order over time, and with it over speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OrderTrack {
    /// The multiple of the engine's speed.
    #[serde(deserialize_with = "nan_if_null")]
    pub order: f64,
    /// Window by window; those in which it cannot be separated from another line are left out.
    pub points: Vec<TrackPoint>,
}

/// An order in one window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrackPoint {
    /// The window's middle, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub time_s: f64,
    /// Mean speed in it, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_rad_s: f64,
    /// Amplitude, in SI.
    #[serde(deserialize_with = "nan_if_null")]
    pub amplitude: f64,
    /// Phase φ of A cos(kθ + φ), rad, θ the crank angle since the speed's recording began.
    #[serde(deserialize_with = "nan_if_null")]
    pub phase_rad: f64,
    /// Standard error of the amplitude.
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_error: f64,
}
