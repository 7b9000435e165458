//! The study: everything that can be learnt from a campaign of recordings, in one call.

mod estimates;
mod findings;
mod gather;
mod next;
mod result;
mod run;
pub(crate) mod shaft_inputs;
mod torque;
mod whole;

pub use gather::{Source, experiment_of};
pub use next::{Candidate, Gain, NextError, NextExperiments, NextOptions, next_experiments};
pub use result::*;
pub use run::{Campaign, Progress, StudyError, run};
pub(crate) use torque::inverter_of;
