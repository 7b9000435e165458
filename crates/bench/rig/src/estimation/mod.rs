//! Common ground of all estimators: data that they may use, errors, and numbers made into [`crate::results`].

mod once;
mod parameter;
mod precision;
mod stretch;

pub use crate::error::{EstimateError, Unsuitable};
pub use once::{Chosen, OncePerRecording, first, once};
pub use parameter::{INTERVAL_LEVEL, ReadOut, transformed};
pub use precision::{noise_floor, timing_floor_s};
pub use stretch::{ESTIMATION_SHARE, liveliest, liveliest_part, longest_unsaturated, need};
