//! The dynamometer test bench: what its signals mean, what its parts are, and how they are estimated, assembled and
//! judged.
//!
//! Raw channel names and units end here (`channels`, `units`); after that everything is SI with a [`Role`]. The crate
//! reads no file, knows no path, no clock, no web, no command line: it turns decoded [`recording::Recording`]s and a
//! [`BenchFile`] into a [`Study`], which is plain data that others write down.
//!
//! Notation follows Glans & Kärnell, *Development of a Method on how to Model a Dynamometer for Driveline Testing*,
//! Chalmers EX112/2018; equation numbers in the documentation are that thesis's.

pub mod align;
pub mod analysis;
pub mod bench_file;
pub mod channels;
pub mod dataset;
pub mod diagnostics;
pub mod estimate;
pub mod excitation_design;
pub mod experiment;
pub mod friction;
pub mod look;
pub mod model;
pub mod prediction;
pub mod prepare;
mod processors;
mod random;
pub mod replay;
pub mod role;
pub mod safety;
pub mod shaft_study;
pub mod simulate;
pub mod speed_control;
pub mod study;
pub mod torque_control_study;
pub mod torque_signals;
pub mod units;
pub mod virtual_bench;

pub use bench_file::BenchFile;
pub use diagnostics::{Diagnostic, Finding, Place, Severity};
pub use experiment::{ControlMode, Excitation, Experiment, ExperimentLabel};
pub use prepare::{PrepareError, prepare};
pub use role::Role;
pub use study::Study;
