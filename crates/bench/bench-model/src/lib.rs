#![doc = include_str!("../README.md")]
//!
//! The model of a bench: two masses, a shaft, speed controller and torque control, with the uncertainty of its numbers;
//! its analysis, and the bench simulated, predicted and replayed with it.
//!
//! The crate knows what a bench is ([`rig`]) and linear systems. It knows no estimator and no study.

pub mod analysis;
pub mod disturbances;
pub mod document;
pub mod drive_ripple;
pub mod friction;
pub mod intake;
pub mod model;
pub mod prediction;
pub mod pulse_shape;
pub mod replay;
pub mod simulate;
pub mod skews;
