//! Experiments before they are run on the bench: designed, checked, simulated.

mod check;
mod design;
mod optimal;
mod planned;
mod simulate;

pub use check::{CheckFacts, CheckedExperiment};
pub use design::{DesignFacts, DesignedExperiment, PredictedRun};
pub use optimal::{DemandForm, OPTIMAL, OptimalExcitation, OptimalFacts, OptimalOptions};
pub(crate) use planned::refused;
pub use planned::{Given, PlanDoubt, Planned, settings};
pub use simulate::{SimulatedExperiment, SimulationFacts};
