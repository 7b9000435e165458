//! Pages on a test: the bench can run it or not, a run of it is valid or not, and how large a sine may be.

mod changes;
mod map;
mod predicted;
mod recorded;
mod wanted;
mod words;

pub use changes::change;
pub use map::{MapPage, page as map};
pub(crate) use predicted::beyond as beyond_findings;
pub use predicted::{Asked, page as predicted, rests_on};
pub use recorded::{AlignedOn, JudgedOwn, RecordedRun, Referred, ScalesOf, page as recorded};
pub use words::{answer, beyond, limit_of, omission, own, required, statistic, value_of};
