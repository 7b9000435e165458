//! Integration tests of the speed controller.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]
#![allow(clippy::disallowed_methods)] // recordings outside the project are read from a folder

mod speed_control;
mod speed_controller;
mod stretches;
