//! Estimators of the bench's parts. Each takes experiments in SI and returns a part of the [`crate::Study`].
//!
//! Order matters: the speed controller tells how noisy and how eccentric the dynamometer's encoder is, the torque control
//! gives the air-gap torque between the samples of T_d,calc, and the shaft needs both.

mod error;
mod parameter;

pub use error::EstimateError;
pub(crate) use parameter::Label;
