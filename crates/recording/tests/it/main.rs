//! Tests of `recording`; the prefix of a name says what a test proves.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stderr
)]

mod bench_files;
mod csv;
mod damage;
mod mdf;
mod round_trip;
