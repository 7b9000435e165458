//! What all estimators share: which data they may use, what can go wrong, and numbers made into [`crate::results`].

mod error;
mod outcome;
mod parameter;
mod precision;
mod stretch;

pub use error::EstimateError;
pub(crate) use parameter::{Label, ReadOut, transformed};
pub(crate) use precision::{noise_floor, timing_floor_s};
pub(crate) use stretch::{longest_unsaturated, need};
