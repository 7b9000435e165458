//! Integration tests of the virtual bench.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]
#![allow(clippy::disallowed_methods)] // recordings outside the project are read from a folder

mod virtual_bench;
mod virtual_engine;
mod virtual_modes;
mod virtual_train;
