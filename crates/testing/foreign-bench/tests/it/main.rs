//! The second simulated bench, and what the program says of benches that it did not simulate.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod calibration;
mod control;
mod known;
mod physics;
mod pulses;
mod recordings;
mod support;
