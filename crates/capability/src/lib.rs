#![doc = include_str!("../README.md")]
//!
//! Tests are cycles ([`cycle::Reference`]), or plans of experiments ([`rig::experiment::ExperimentPlan`]), among them the shapes of
//! [`shapes`]. Cycles run in speed control, in steps of some milliseconds; see [`bench_model::simulate::simulate_course`]. Plans run
//! millisecond by millisecond, as a prediction of an experiment does.

mod answer;
mod cycle_run;
mod demand;
mod easier;
mod error;
mod extremes;
mod judged;
pub mod map;
mod plan_run;
mod pulses;
pub mod shapes;
mod trace;

pub use answer::{Answer, Bands, CanInputs, LimitVerdict, OwnVerdict, SetVerdict, StatisticVerdict, Verdict, can};
pub use demand::{CycleDemand, Demand};
pub use easier::{Change, Easier, easier};
pub use error::CapabilityError;
pub use extremes::{LimitOf, Peak};
pub use trace::Trace;
