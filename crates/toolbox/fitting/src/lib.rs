#![doc = include_str!("../README.md")]
//!
//! Notation follows Ljung, *System Identification: Theory for the User*, 2nd ed., 1999. Rows are time, columns are
//! parameters.

mod agreement;
pub mod condition;
pub mod covariance;
pub mod equation;
mod error;
pub mod frequency;
pub mod gram;
pub mod least_squares;
pub mod nonlinear;
pub mod smoothing;
mod structure_error;
mod termination;
pub mod triangle;

pub use agreement::{fit_percent, rms_error};
pub use error::{IdentError, StructureFault};
pub use least_squares::{LinearFit, least_squares};
pub use nonlinear::{Bounds, Minimum, NonlinearOptions, ResidualModel, minimise};
pub use structure_error::{BoundsFault, ChannelKind, Count, RefinedLimit, StructureError, UnstablePart};
pub use termination::Termination;
pub use triangle::Triangle;
