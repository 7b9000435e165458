//! Integration tests of `ident`.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod advice;
mod arx;
mod closed_loop;
mod conformance;
mod covariance;
mod dataset;
mod delay;
mod distributions;
mod frequency;
mod impulse_response;
mod instrumental;
mod least_squares;
mod long;
mod noise;
mod nonlinear;
mod order_scan;
mod prediction;
mod prediction_error;
mod recursive;
mod shared;
mod stand_in;
mod uncertainty;
mod validate;
