//! Models of polynomials in the shift operator.

pub(crate) mod arx;
pub(crate) mod instrumental;
pub mod prediction_error;
pub mod recursive;
