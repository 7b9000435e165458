//! Estimators of the bench's parts. Each takes experiments in SI and returns a part of the [`crate::Study`].
//!
//! Order matters: the speed controller tells how noisy and how eccentric the dynamometer's encoder is, the torque control
//! gives the air-gap torque between the samples of T_d,calc, and the shaft needs both.

pub mod shaft;
pub mod shaft_routes;
pub mod speed_controller;
pub mod timing;
pub mod torque_control;

pub use crate::estimation::EstimateError;
