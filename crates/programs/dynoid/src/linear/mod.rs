//! Linear models of any channels of recordings: data without trend, estimates, and their judgement.

mod data;
mod faults;
mod fit;
mod gaps;
mod loaded;
mod note;
pub mod operating_point;
mod recorded;
mod sources;

pub use data::DataOptions;
pub use faults::{check_movement, check_variation};
pub use fit::{FitData, FitNeeds, Judging, LinearFit, Method, Search};
pub use gaps::Gaps;
pub use loaded::Loaded;
pub use note::Note;
pub use recorded::RecordedFiles;
pub use sources::which_data;
