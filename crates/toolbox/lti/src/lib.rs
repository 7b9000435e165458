#![doc = include_str!("../README.md")]
//!
//! Conventions: rows are time and columns are channels in every table of signals; polynomial coefficients are in
//! descending powers; angular frequencies are in rad/s; a system without a sample time is continuous.

mod analysis;
mod channel_pair;
mod delay;
mod delayed;
mod dimensions;
mod error;
mod expm;
mod frequency_response;
mod innovations;
mod logm;
mod matrix;
pub mod polynomial;
mod polynomial_model;
mod process_model;
mod reduction;
mod sampling;
mod schur;
mod simulation;
mod state_space;
pub mod text;
mod transfer_function;
mod zero_pole_gain;

pub use analysis::{
    GainMargin, Margins, Mode, PhaseMargin, StepCharacteristics, TimeGrid, common_frequency_grid, settled,
};
pub use channel_pair::ChannelPair;
pub use delayed::DelayedStateSpace;
pub use dimensions::Dimensions;
pub use error::LtiError;
pub use expm::expm;
pub use frequency_response::{FrequencyResponse, Peak};
pub use innovations::Innovations;
pub use logm::logm;
pub use matrix::{from_rows, to_rows};
pub use polynomial_model::{PolynomialEquation, PolynomialModel};
pub use process_model::{ProcessModel, ProcessPair};
pub use reduction::Reduction;
pub use sampling::Discretisation;
pub use signal::Complex64;
pub use simulation::Simulator;
pub use state_space::{FirstOrderHold, StateSpace};
pub use transfer_function::TransferFunction;
pub use zero_pole_gain::ZeroPoleGain;
