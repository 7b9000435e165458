//! Integration tests of `ident`.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod covariance;
mod distributions;
mod frequency;
mod grey_box;
mod least_squares;
mod noise;
mod nonlinear;
mod shared;
mod state_space;
mod subspace;
mod systems;
mod validate;
