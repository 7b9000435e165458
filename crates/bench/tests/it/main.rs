//! Integration tests of `bench`.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod analysis;
mod model;
mod replay;
