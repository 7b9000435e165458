//! The dynamometer test bench: what its signals mean, what its parts are, and how they are estimated, assembled and
//! judged.
//!
//! Raw channel names and units end here (`channels`, `units`); after that everything is SI with a [`Role`]. The crate
//! reads no file, knows no path, no clock, no web, no command line: it turns decoded [`recording::Recording`]s and a
//! [`BenchFile`] into a [`Study`], which is plain data that others write down.
//!
//! Notation follows Glans & Kärnell, *Development of a Method on how to Model a Dynamometer for Driveline Testing*,
//! Chalmers EX112/2018; equation numbers in the documentation are that thesis's.

mod air_gap_torque;
pub mod align;
pub mod analysis;
pub mod bench_file;
pub mod bench_parameters;
pub mod channels;
pub mod dataset;
pub mod diagnostics;
pub mod drive_ripple;
pub mod effects;
pub mod engine_torque;
pub mod estimate;
pub mod estimation;
pub mod excitation_design;
pub mod experiment;
pub mod facts;
pub mod friction;
mod intake;
pub mod look;
pub mod model;
pub mod prediction;
pub mod prepare;
mod random;
pub mod replay;
pub mod results;
pub mod role;
pub mod safety;
pub mod segments;
mod shaft_inputs;
pub mod shaft_study;
pub mod simulate;
pub mod sine;
pub mod skews;
pub mod speed_control;
pub mod study;
pub mod torque_control_study;
pub mod torque_signals;
pub mod torque_smoother;
pub mod units;
pub mod virtual_bench;

pub use bench_file::BenchFile;
pub use diagnostics::{Diagnostic, Finding, Place, Severity};
pub use experiment::{ControlMode, Excitation, Experiment, ExperimentLabel};
pub use prepare::{PrepareError, prepare};
pub use role::Role;
pub use study::Study;
