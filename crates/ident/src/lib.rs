//! System identification: estimators and their judgement.
//!
//! Notation follows Ljung, *System Identification: Theory for the User*, 2nd ed., 1999; the frequency-domain part
//! follows Pintelon & Schoukens, *System Identification: A Frequency Domain Approach*, 2nd ed., 2012. Rows are time,
//! columns are channels or parameters.
//!
//! The crate knows no file format, no test bench, prints nothing, reads no clock and holds no global random state.

pub mod covariance;
mod data;
pub mod distributions;
mod error;
mod fit;
pub mod frequency;
mod grey_box;
pub mod least_squares;
pub mod nonlinear;
mod state_space;
mod subspace;
mod triangle;
pub mod validate;

pub use data::{Dataset, Experiment, Intersample, Label};
pub use error::IdentError;
pub use fit::{Doubt, Fit, LinearModel, Parametric};
pub use grey_box::{
    Entry, GreyBox, GreyBoxModel, GreyNoise, GreyParameter, InitialStates, Structure, StructuredMatrices,
};
pub use least_squares::{LinearFit, least_squares};
pub use nonlinear::{Bounds, Minimum, NonlinearOptions, ResidualModel, Termination, minimise};
pub use state_space::{Focus, StateSpaceModel, StateSpacePem};
pub use subspace::{StateOrder, Subspace, Weighting};
pub use triangle::Triangle;
