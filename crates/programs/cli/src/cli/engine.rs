//! Arguments of `dynoid engine`.

use std::path::PathBuf;

use clap::Args;

use super::given::GivenRecordings;
use super::identify::ResultArguments;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid engine bench.toml
  dynoid engine bench.toml BS_T_NT_1200.mf4 --plot engine.html
  dynoid engine bench.toml BS_T_NT_1200.mf4 --out engine_torque.parquet
  dynoid engine bench.toml --json | jq '.recordings[].cycles.found.cylinders'

Nobody records the engine torque. A smoother reconstructs it from both speeds, T_d, the shaft and the inertias, with its standard deviation. It is then shown by cycle, and by cylinder in firing order.

Give all recordings of the campaign: BS_T_NT or WhiteNoise_T_TN gives the shaft, WhiteNoise_T_TN the engine's inertia.")]
pub(crate) struct EngineArguments {
    #[command(flatten)]
    pub(crate) given: GivenRecordings,
    /// Write the reconstructed engine torque and its standard deviation as a recording, its format by the ending; needs
    /// one recording
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
