#![doc = include_str!("../README.md")]
//!
//! Tests are cycles ([`cycle::Reference`]), or plans of experiments ([`rig::experiment::ExperimentPlan`]), among them
//! the shapes of [`shapes`]. Cycles run in speed control, in steps of some milliseconds; see
//! [`bench_model::simulate::simulate_course`]. Plans run millisecond by millisecond, as a prediction of an experiment
//! does.

mod added;
mod answer;
pub mod beyond;
mod change;
mod courses;
mod cycle_run;
mod demand;
pub mod document;
mod doubt;
mod easier;
mod error;
mod extremes;
mod filter;
mod fired;
mod following;
pub mod gradient;
mod judged;
pub mod map;
mod outcome;
mod plan_run;
mod pulses;
mod runs;
pub mod shapes;
mod trace;
mod verdict;
pub mod wanted;

pub use beyond::Beyond;
pub use change::Change;
pub use courses::LimitedCourse;
pub use demand::{CycleDemand, Demand};
pub use doubt::{Doubt, Uncertain};
pub use easier::{Easier, easier};
pub use error::CapabilityError;
pub use extremes::{LimitOf, Peak};
pub use following::FollowingSpread;
pub use outcome::CanInputs;
pub use runs::{DrawnBench, Runs, can};
pub use trace::Trace;
pub use verdict::{Answer, Bands, LimitVerdict, OwnVerdict, SetVerdict, Spread, StatisticVerdict, Verdict};
