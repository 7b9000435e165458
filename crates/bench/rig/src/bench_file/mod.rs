//! The bench file: what the user states about a bench, and which channel plays which role.
//!
//! ```
//! let file: rig::BenchFile = r#"
//! [bench]
//! name = "Cell 4"
//! variant = "load-cell"
//! cylinders = 4
//! dynamometer_inertia = "0.6 kg m²"
//! engine_inertia = "0.2 kg m²"
//!
//! [channels]
//! dyno_speed = "DynoSpeed"
//! engine_speed = { name = "EngineSpeed", unit = "rpm" }
//! air_gap_torque = { name = "TorqueCalc", sign = -1 }
//! "#
//! .parse()?;
//! assert_eq!(file.dynamometer_inertia_kg_m2, 0.6);
//! # Ok::<(), rig::bench_file::BenchFileError>(())
//! ```

mod fault;
mod keys;
mod read;
mod sections;
mod stated;
mod stretches;
mod virtual_bench;
mod write;

use std::str::FromStr;

pub use crate::channels::ChannelMapping;
pub use fault::{BenchFileError, Fault, FaultKind};
pub use keys::{KEYS, Key};
pub use stated::{
    BenchFile, DriveHeat, LabelOverride, Limits, RecordingList, ReportIdentity, RunChannels, ShaftPrior, StatedStretch,
    StretchUse,
};
pub use stated::{PLACEHOLDER, names_same_file};
pub use write::Draft;

impl FromStr for BenchFile {
    type Err = BenchFileError;

    /// Reads a bench file's text.
    ///
    /// # Errors
    ///
    /// [`BenchFileError`] with every fault found, each with its line, key and remedy.
    fn from_str(text: &str) -> Result<Self, BenchFileError> {
        read::read(text)
    }
}

impl FromStr for RunChannels {
    type Err = BenchFileError;

    /// Reads the channels of a bench file's text; whatever else it states may be missing.
    ///
    /// # Errors
    ///
    /// [`BenchFileError`] with every fault found in what is read, each with its line, key and remedy.
    fn from_str(text: &str) -> Result<Self, BenchFileError> {
        read::read_for_a_run(text)
    }
}
