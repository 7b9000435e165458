//! Integration tests of the study.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]
#![allow(clippy::disallowed_methods)] // recordings outside the project are read from a folder

mod comparison;
mod damages;
mod drawn_benches;
mod next_experiment;
mod recorded_bench;
mod recorded_benches;
mod results;
mod shaft_benches;
mod shaft_terms;
mod study;
mod study_recorded;
mod torques_exchanged;
