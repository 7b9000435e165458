//! Integration tests of the bench: bench files, recordings, estimators, model, the virtual bench.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]
#![allow(clippy::disallowed_methods)] // recordings outside the project are read from a folder

mod align;
mod analysis;
mod bench_file;
mod channels;
mod dataset;
mod engine_torque;
mod excitation_design;
mod experiment;
mod friction;
mod look;
mod model;
mod next_experiment;
mod optimal_goals;
mod prediction;
mod prepare;
mod recorded;
mod replay;
mod safety;
mod shaft;
mod shaft_benches;
mod shaft_routes;
mod shaft_terms;
mod speed_control;
mod speed_controller;
mod study;
mod study_recorded;
mod support;
mod thesis;
mod timing;
mod torque_bench;
mod torque_control;
mod torque_control_study;
mod torque_signals;
mod units;
mod virtual_bench;
mod virtual_engine;
mod virtual_modes;
mod virtual_train;
