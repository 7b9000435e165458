//! Arguments of most commands for a bench.

use std::path::PathBuf;

use clap::Args;

/// A bench file, and recordings of that bench.
#[derive(Debug, Args)]
pub(crate) struct GivenRecordings {
    /// The bench file: channels, cylinders, and where the recordings are
    #[arg(value_name = "BENCH.toml")]
    pub(crate) bench: PathBuf,
    /// Recordings, or folders of recordings [default: those of the bench file]
    #[arg(value_name = "RECORDING")]
    pub(crate) recordings: Vec<PathBuf>,
}
