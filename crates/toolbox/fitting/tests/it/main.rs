//! Integration tests of `fitting`.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod covariance;
mod frequency;
mod least_squares;
mod nonlinear;
mod smoothing;
