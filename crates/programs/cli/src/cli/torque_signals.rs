//! Arguments of `dynoid torque-signals`.

use std::path::PathBuf;

use clap::Args;

use super::given::GivenRecordings;
use super::identify::ResultArguments;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid torque-signals bench.toml
  dynoid torque-signals bench.toml WhiteNoise_T_TN_1200.mf4 --plot torque.html
  dynoid torque-signals bench.toml BS_T_NT_1200.mf4 --out shaft_torque.parquet
  dynoid torque-signals bench.toml --json | jq '.recordings[].delays'

The command estimates the delay of each torque signal against T_d* and against the bends of N_d, by every method that applies. It identifies the filter in the system's own shaft torque and the dynamics of the load cell. It reconstructs the true shaft torque with its standard deviation, and checks T_d,calc where torque is steady.")]
pub(crate) struct TorqueSignalsArguments {
    #[command(flatten)]
    pub(crate) given: GivenRecordings,
    /// Write the reconstructed shaft torque and its standard deviation as a recording, its format by the ending; needs
    /// one recording
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
