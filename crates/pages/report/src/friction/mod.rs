//! Friction of the dynamometer: words and figures, and the analysis of all recordings.

mod analysis;
mod words;

pub(crate) use analysis::{analysis, analysis_of};
pub use words::*;
