//! Experiments before they are run on the bench: designed, checked, simulated.

mod check;
mod design;
mod optimal;
mod planned;
mod rated;
mod simulate;
mod virtual_recordings;

pub use check::{CheckFacts, CheckedExperiment};
pub use design::{DesignFacts, DesignedExperiment, PredictedRun};
pub use optimal::{DemandForm, OPTIMAL, OptimalExcitation, OptimalFacts, OptimalOptions};
pub(crate) use planned::refused;
pub use planned::{Given, PlanDoubt, Planned, settings};
pub use rated::{RatedExperiments, RatedFacts};
pub use rig::bench_parameters::BenchParameters;
pub use rig::experiment::ExperimentPlan;
pub use simulate::{SimulatedExperiment, SimulationFacts};
pub use study::NextOptions;
pub use virtual_recordings::VirtualRecordings;
