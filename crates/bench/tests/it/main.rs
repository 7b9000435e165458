//! Integration tests of the bench: bench files, recordings, estimators, the virtual bench.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod align;
mod bench_file;
mod channels;
mod prepare;
mod recorded;
mod support;
mod timing;
mod torque_bench;
mod torque_control;
mod units;
mod virtual_bench;
