//! The torque signals: words and figures, the analysis of all recordings, and the section of a study.

mod analysis;
mod section;
mod words;

pub(crate) use analysis::analysis;
pub(crate) use section::timing;
pub use words::*;
