//! An order over a recording in which the speed moves.

use serde::Serialize;

/// An order over time, and with it over speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OrderTrack {
    /// The multiple of the engine's speed.
    pub order: f64,
    /// Window by window; those in which it cannot be separated from another line are left out.
    pub points: Vec<TrackPoint>,
}

/// An order in one window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TrackPoint {
    /// The window's middle, s.
    pub time_s: f64,
    /// Mean speed in it, rad/s.
    pub speed_rad_s: f64,
    /// Amplitude, in SI.
    pub amplitude: f64,
    /// Phase φ of A cos(kθ + φ), rad, θ the crank angle since the speed's recording began.
    pub phase_rad: f64,
    /// Standard error of the amplitude.
    pub standard_error: f64,
}
