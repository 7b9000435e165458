//! Arguments of `dynoid torque`.

use std::path::PathBuf;

use clap::Args;

use super::GivenRecordings;
use super::identify::ResultArguments;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid torque bench.toml
  dynoid torque bench.toml WhiteNoise_T_TN_1200.mf4 --plot torque.html
  dynoid torque bench.toml BS_T_NT_1200.mf4 --out shaft_torque.parquet
  dynoid torque bench.toml --json | jq '.recordings[].delays.found[]?.against_demand'

How late each torque signal is against T_d* and against the bend in N_d, by all routes that apply; what filter stands in the system's own shaft torque; what the shaft torque really was, with its standard deviation; how the load cell moves; and whether T_d,calc can be trusted at rest.")]
pub(crate) struct TorqueArguments {
    #[command(flatten)]
    pub(crate) given: GivenRecordings,
    /// Writes the rebuilt shaft torque and its standard deviation as a recording, its format by the ending; of one recording
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
