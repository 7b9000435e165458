//! Analysis of a system: responses in time and their shape, modes, frequency grids, stability margins.

pub(crate) mod frequency_grid;
mod margins;
mod modes;
mod step_characteristics;
mod time_response;

pub use frequency_grid::common_frequency_grid;
pub use margins::{GainMargin, Margins, PhaseMargin};
pub use modes::{Mode, settled};
pub use step_characteristics::StepCharacteristics;
pub use time_response::TimeGrid;
