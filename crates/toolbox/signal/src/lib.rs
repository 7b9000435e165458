#![doc = include_str!("../README.md")]
//!
//! Conventions: `f64` and SI throughout, frequencies named `_hz` are in hertz, a positive delay means *later*.

pub mod clock;
pub mod correlation;
pub mod derivative;
pub mod distributions;
pub mod drift;
mod error;
pub mod excitation;
mod extend;
pub mod filter;
pub mod frf;
pub mod histogram;
pub mod periodicity;
mod plans;
pub mod proportion;
pub mod quality;
pub mod resample;
mod runs;
mod series;
mod sinc;
pub mod spectrum;
pub mod spline;
pub mod updates;
pub mod window;
pub mod zero_phase;

pub use error::SignalError;
pub use filter::{Fir, Sos};
pub use realfft::num_complex::Complex64;
pub use runs::runs;
pub use series::{Signal, SignalView};
