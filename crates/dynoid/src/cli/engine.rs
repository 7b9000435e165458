//! Arguments of `dynoid engine`.

use std::path::PathBuf;

use clap::Args;

use super::GivenRecordings;
use super::identify::ResultArguments;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid engine bench.toml
  dynoid engine bench.toml BS_T_NT_1200.mf4 WhiteNoise_T_TN_1200.mf4 --plot engine.html
  dynoid engine bench.toml BS_T_NT_1200.mf4 --out engine_torque.parquet
  dynoid engine bench.toml --json | jq '.recordings[].cycles.found.cylinders'

The engine's torque is not recorded. It is rebuilt from both speeds and T_d with the shaft and the inertias that the recordings tell, by a smoother that knows its own standard deviation; then by cycle, and cylinder by cylinder in the order of firing. Give all recordings of the campaign: a BS_T_NT or WhiteNoise_T_TN tells the shaft, a WhiteNoise_T_TN the engine's inertia.")]
pub(crate) struct EngineArguments {
    #[command(flatten)]
    pub(crate) given: GivenRecordings,
    /// Writes the rebuilt engine torque and its standard deviation as a recording, its format by the ending; of one recording
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
