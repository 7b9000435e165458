#![doc = include_str!("../README.md")]
//!
//! Terms of a dynamometer test bench: signals and their roles, stated facts, experiments planned and recorded, and
//! plain types of its estimated parts.
//!
//! Raw channel names and units end here ([`channels`], [`bench_file`], [`prepare`](mod@prepare)); after that everything
//! is SI with a [`Role`]. The crate reads no file, and knows no model, no simulation and no estimator.
//!
//! Notation follows Glans & Kärnell, *Development of a Method on how to Model a Dynamometer for Driveline Testing*,
//! Chalmers EX112/2018; equation numbers in the documentation are that thesis's.

pub mod align;
pub mod bench_file;
pub mod bench_parameters;
pub mod channels;
pub mod diagnostics;
pub mod dyno_friction;
pub mod engine_pulses;
mod error;
pub mod estimation;
pub mod experiment;
pub mod facts;
pub mod numbers;
pub mod prepare;
mod quantity;
pub mod random;
pub mod results;
pub mod role;
mod words;

pub use bench_file::{BenchFile, RunChannels};
pub use diagnostics::{Diagnostic, Finding, LikelyUnit, NotReplayed, Place, SeenInstead, Severity};
pub use experiment::{ControlMode, Excitation, Experiment, ExperimentLabel};
pub use prepare::{PrepareError, prepare, prepare_run, prepare_validation};
pub use role::Role;
/// How the comment of a recording ends that a virtual bench made.
pub const SIMULATED: &str = "virtual bench";
pub use words::InWords;
