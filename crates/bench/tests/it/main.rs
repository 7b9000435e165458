//! Tests of the bench crate.
#![allow(clippy::expect_used, clippy::print_stdout)] // a test that cannot go on should say why

mod virtual_bench;
