//! The shaft: stiffness and damping, estimated together with the encoder's gate and the skew of the rasters.
//!
//! A shift of one raster against another by a fraction of a millisecond looks like damping: e^{sδ}(K + Bs) ≈ K + (B +
//! Kδ)s. Timing is therefore part of the model. Errors of all three signals are part of it too, since none of them is
//! free of noise, and engine torque, which is not measured, does not enter: the equation holds on the dynamometer's
//! side of the shaft, whatever the engine does and however the loop is closed. The once-a-turn errors of both encoders
//! are estimated too: a speed that swings throws them over a wide band, so that leaving out their own frequency would
//! not do.
//!
//! # Source
//! Thesis (6.1), (6.10), §6.3.5.2; Pintelon & Schoukens 2012, ch. 9.

pub mod checks;
mod engine_side;
mod equation;
mod estimate;
mod inputs;
mod places;
mod response;
mod skew_search;
mod solution;
mod spectra;
mod springs;
mod term;
mod terms;

pub use estimate::{Fitted, Wanted, estimate, fit};
pub(crate) use inputs::LARGEST_SKEW_S;
pub use inputs::{ShaftInputs, TorqueDelay};
pub use part_torque::air_gap_torque::NoisyTorque;
pub(crate) use places::{DYNO, ENGINE, TORQUE};
pub(crate) use solution::{ECCENTRICITY, SLOWEST_RAD_S, WITHOUT_FIRING_S, model_errors};
pub(crate) use spectra::{CLEAN_PART, HIGHEST_HZ};
pub use term::{Term, Weight};
pub use terms::{Beyond, TermTest};
