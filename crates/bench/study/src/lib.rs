//! The study: everything that can be learnt from a campaign of recordings, in one call.

mod analyses;
mod assemble;
mod comparison;
mod demand_clock;
mod disturbances;
mod estimates;
mod findings;
mod firing;
mod fits;
mod folded_pulses;
mod gather;
mod next;
pub mod noise_test;
mod pulse_path;
mod recorded;
mod replayed;
mod result;
mod ripple_clock;
mod run;
mod run_outs;
mod series;
mod struck;
mod validity;
mod whole;

pub use analyses::{Analyses, lines};
pub use assemble::{StudyParts, assemble};
pub use comparison::{
    CHANGED, ComparedPart, ModelComparison, ParameterComparison, PartComparison, SourceChanges, WaldTest,
    compare_models,
};
pub use gather::{Prepared, Source, StudyError, experiment_of};
pub use next::{Candidate, Gain, NextError, NextExperiments, NextOptions, next_experiments};
pub use recorded::{RecordedCourse, StepResponse};
pub use replayed::{REPLAYED_S, ReplayModel, replayed_stretch};
pub use result::*;
pub use run::{Campaign, run, run_full};
pub use series::series;
