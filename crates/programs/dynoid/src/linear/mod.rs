//! Linear models of any channels of recordings: data without trend, estimates, and their judgement.

mod converted;
mod data;
mod dynamics;
mod faults;
mod fit;
mod gaps;
mod greybox;
mod judged;
mod loaded;
mod meet;
mod models;
mod note;
pub mod operating_point;
mod recorded;
mod response;
mod sources;

pub use converted::ConvertedModel;
pub use data::DataOptions;
pub use dynamics::{DynamicsFacts, dynamics};
pub use faults::{check_movement, check_variation};
pub use fit::{FitData, FitNeeds, Judging, LinearFit, Method, Search};
pub use gaps::Gaps;
pub use greybox::structure;
pub use judged::{ComparedModels, ModelResponse, ResponseOptions, TestedResiduals};
pub use loaded::Loaded;
pub use meet::{MeetOptions, NamedModel};
pub use models::models_in;
pub use note::Note;
pub use recorded::RecordedFiles;
pub use response::check_recordings_file;
pub(crate) use response::{MEASURED, RESIDUAL};
pub use sources::which_data;
