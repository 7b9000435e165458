//! Estimators of the bench's parts. Each takes experiments in SI and returns a part of the [`crate::Study`].
//!
//! Order matters: the speed controller tells how noisy and how eccentric the dynamometer's encoder is, the torque control
//! gives the air-gap torque between the samples of T_d,calc, and the shaft needs both.

mod error;
mod parameter;
pub mod shaft;
pub mod speed_controller;
mod stretch;

pub use error::EstimateError;

/// Standard uncertainty of the instant a time stamp stands for, s.
///
/// A sample is dated no better than to a twentieth of the fastest raster either way (when in its cycle a controller
/// latches a value is not recorded); taken as uniform, that is T/(20 √3). It bounds what any delay or skew can claim,
/// however long the recording.
pub(crate) fn timing_floor_s(sample_time_s: f64) -> f64 {
    sample_time_s / (20.0 * 3f64.sqrt())
}
