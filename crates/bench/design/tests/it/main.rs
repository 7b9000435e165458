//! Integration tests of designed experiments and their check.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]
#![allow(clippy::disallowed_methods)] // recordings outside the project are read from a folder

mod excitation_design;
mod optimal_goals;
mod results;
mod safety;
mod safety_calibration;
