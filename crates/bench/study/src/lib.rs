//! The study: everything that can be learnt from a campaign of recordings, in one call.

mod analyses;
mod assemble;
mod clocks_and_pulses;
mod comparison;
mod disturbances;
pub mod document;
mod estimates;
mod findings;
mod fits;
mod gather;
pub mod known;
mod model_json;
mod next;
mod parts;
mod recorded;
mod replayed;
mod result;
mod run;
mod run_outs;
mod scale;
mod series;
mod struck;
mod validity;
pub mod verdict;
mod whole;

pub use analyses::{Analyses, lines};
pub use assemble::{StudyParts, assemble};
pub use comparison::{
    CHANGED, ComparedPart, ModelComparison, ParameterComparison, PartComparison, SourceChanges, WaldTest,
    compare_models,
};
pub use gather::{Prepared, Source, StudyError, experiment_of};
pub use known::known;
pub use model_json::{BenchModelError, Origin, Words, bench_model, model, model_with_validity, parameters};
pub use next::{
    Candidate, Gain, NextError, NextExperiments, NextOptions, RatedExperiment, next_experiments, rated_experiments,
    rated_plan,
};
pub use recorded::{RecordedCourse, StepResponse};
pub use replayed::{REPLAYED_S, ReplayModel, replayed_stretch};
pub use result::*;
pub use run::{Campaign, run, run_full};
pub use run_outs::friction_of;
pub use scale::{TorqueScale, torque_scale};
pub use series::series;
pub use verdict::verdict;
