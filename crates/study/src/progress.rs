//! Work in progress, for a display.

use rig::results::Part;

/// Work in progress, for a display.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Progress {
    /// A recording is understood and checked.
    Preparing {
        /// File.
        file: String,
    },
    /// A part of the bench is estimated.
    Estimating {
        /// The part.
        part: Part,
    },
    /// A recording is replayed on the model.
    Replaying {
        /// File.
        file: String,
    },
    /// An analysis of all recordings is made: `lines`, `torque signals`, `speed controller`, `torque control`, `friction`,
    /// `shaft`, `engine torque`.
    Analysing {
        /// The analysis.
        what: &'static str,
    },
}
