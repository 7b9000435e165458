//! Integration tests of `bench`.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod timing;
mod torque_bench;
mod torque_control;
