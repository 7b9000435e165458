//! The speed controller and its feed-forward: words and figures, the analysis of all recordings, and the sections of a
//! study.

mod analysis;
mod section;
mod words;

pub(crate) use analysis::{analysis, feed_forward_analysis, pi_study};
pub(crate) use section::{feed_forward_section, section};
pub use words::*;
