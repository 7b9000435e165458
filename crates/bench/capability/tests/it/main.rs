//! Integration tests of whether a bench can run a test.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod answers;
mod calibration;
mod maps;
mod pulses;
mod results;
mod runs;
mod statistics;
mod support;
