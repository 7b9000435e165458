//! Lines of the spectra: words and figures, and the analysis of all recordings.

mod analysis;
mod map;
mod words;

pub(crate) use analysis::{analysis, every_line, summed_up, with_figures};
pub use map::MapFacts;
pub use words::*;
