#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod cancel;
mod context;
mod progress;

pub use cancel::{Cancel, Cancelled, checked, checkpoint, guarded};
pub use context::Context;
pub use progress::{Progress, State, Tree};
