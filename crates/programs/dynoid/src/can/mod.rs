//! Tests: a bench can run one or not, how probably, and why; a run of one is valid or not; how large a sine may be.

mod compared;
mod cycle_table;
mod engine_map;
mod facts;
mod known_tests;
mod map;
mod predicted;
mod recorded;
mod requirements;
mod test;
mod tried;

pub use capability::LimitOf;
pub use facts::{CapabilityFacts, PredictedFacts, RunFacts};
pub use known_tests::KnownTests;
pub use map::{Capability, CapabilityOptions};
pub use predicted::Predicted;
pub use recorded::JudgedRun;
pub use requirements::Requirements;
pub use test::{Test, TestOptions};
pub use tried::{LimitedCourseFacts, Tried, TriedFacts};
