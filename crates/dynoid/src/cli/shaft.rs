//! Arguments of `dynoid shaft`.

use clap::Args;

use super::GivenRecordings;
use super::identify::ResultArguments;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid shaft bench.toml
  dynoid shaft bench.toml BS_T_NT_1200.mf4 WhiteNoise_T_TN_1200.mf4 --plot shaft.html
  dynoid shaft bench.toml --json | jq '.together.stiffness.parameter | {value, interval}'

Stiffness and damping from every recording with a shaft, with gate and skews of its signals as part of the model; the same by band of frequencies, and as if time stamps were exact; by other routes on a bench with load cell: state space (T_d, ω_e) → ω_d, a black box T_d → ω_d where the engine is motored (Unfired_N_NT), means over the periods of a demand that repeats (Multisine_T_TN); both inertias as if nothing were known of them, where a wide-band torque demand tells them (WhiteNoise_T_TN, Multisine_T_TN); what may be in the shaft beyond K and B, each term held against the data: a loss factor, a second mass, stiffness and damping that change with torque or speed, backlash; and all recordings together, with a test of whether they are of one shaft.")]
pub(crate) struct ShaftArguments {
    #[command(flatten)]
    pub(crate) given: GivenRecordings,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
