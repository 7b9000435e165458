//! Integration tests of `ident`.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod conformance;
mod covariance;
mod distributions;
mod frequency;
mod least_squares;
mod noise;
mod nonlinear;
mod prediction;
mod stand_in;
mod uncertainty;
mod validate;
