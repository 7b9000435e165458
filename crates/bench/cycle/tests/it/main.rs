//! Integration tests of cycles, requirement sets and statistics.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]
#![allow(clippy::disallowed_methods)] // reference data outside the project are read from a folder

mod cycles;
mod omission;
mod own;
mod regression;
mod requirements;
mod support;
mod validation;
mod vehicle;
