//! Helpers that tests of the bench's rooms share: recordings made in memory, benches and models with known truth.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]
#![allow(clippy::disallowed_methods)] // recordings outside the project are read from a folder

pub mod benches;
pub mod documents;
pub mod models;
pub mod recordings;
pub mod runs;
pub mod schemas;
pub mod torque_bench;
