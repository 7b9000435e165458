//! The torque control: words and figures, the analysis of all recordings, and the section of a study.

mod analysis;
mod section;
mod words;

pub(crate) use analysis::{analysis, analysis_in_report};
pub(crate) use section::section;
pub use words::*;
