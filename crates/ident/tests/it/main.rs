//! Integration tests of `ident`.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod arx;
mod covariance;
mod distributions;
mod frequency;
mod impulse_response;
mod instrumental;
mod least_squares;
mod noise;
mod nonlinear;
mod order_scan;
mod shared;
mod validate;
