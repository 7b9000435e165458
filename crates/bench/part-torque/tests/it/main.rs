//! Integration tests of torque control and torque signals.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]
#![allow(clippy::disallowed_methods)] // recordings outside the project are read from a folder

mod timing;
mod torque_control;
mod torque_control_study;
mod torque_signals;
