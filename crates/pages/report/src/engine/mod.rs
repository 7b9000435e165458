//! The torque of the engine: words and figures, and the analysis of all recordings.

mod analysis;
mod words;

pub(crate) use analysis::analysis;
pub use words::*;
