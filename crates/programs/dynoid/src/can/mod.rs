//! Tests: a bench can run one or not, how probably, and why; a run of one is valid or not; how large a sine may be.

mod compared;
mod cycle_table;
mod engine_map;
mod facts;
mod map;
mod predicted;
mod recorded;
mod requirements;
mod test;

pub use facts::{CapabilityFacts, PredictedFacts, RunFacts};
pub use map::{Capability, CapabilityOptions};
pub use predicted::Predicted;
pub use recorded::JudgedRun;
pub use requirements::Requirements;
pub use test::{Test, TestOptions};
