//! Integration tests of `ident`.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod continuous;
mod covariance;
mod distributions;
mod frequency;
mod frequency_domain;
mod least_squares;
mod noise;
mod nonlinear;
mod process;
mod validate;
