//! Integration tests of `ident`.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod covariance;
mod distributions;
mod frequency;
mod least_squares;
mod noise;
mod nonlinear;
mod prediction_error;
mod shared;
mod validate;
