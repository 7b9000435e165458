//! Whether a bench can run a test, whether a run of one is valid, and how large a sine may be.

mod map;
mod predicted;
mod recorded;
mod words;

pub use map::page as map;
pub use predicted::{Asked, page as predicted};
pub use recorded::{AlignedOn, RecordedRun, page as recorded};
pub use words::{answer, limit_of, omission, own, required, statistic, value_of};
