//! Integration tests of the model of a bench.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]
#![allow(clippy::disallowed_methods)] // recordings outside the project are read from a folder

mod analysis;
mod course;
mod disturbances;
mod document;
mod linear_form;
mod model;
mod prediction;
mod replay;
