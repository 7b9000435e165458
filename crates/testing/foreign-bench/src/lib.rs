#![doc = include_str!("../README.md")]
//!
//! [`draw`] draws a [`Bench`], [`run`] runs a [`Demand`] on it, and [`campaign`] makes the recordings that a study
//! needs. SI throughout; torques of the dynamometer brake where they are positive.

pub mod bench;
pub mod campaign;
mod control;
mod demand;
mod draw;
mod physics;
mod random;
mod run;
mod sensors;

pub use bench::Bench;
pub use demand::{Demand, Mode};
pub use draw::draw;
pub use random::Random;
pub use run::{Run, Truth, run, run_in_steps};
