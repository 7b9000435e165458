//! Integration tests of the exports. A name's prefix says what it proves.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]
#![allow(clippy::disallowed_methods)] // other programs read the exports from a folder

mod cases;
mod draws;
mod fmu;
mod fmu_linear;
mod lead;
mod linear;
mod matlab;
mod model;
mod modelica;
mod names;
mod others;
mod python;
mod ssv;
mod system;
