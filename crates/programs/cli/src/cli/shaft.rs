//! Arguments of `dynoid shaft`.

use clap::Args;

use super::given::GivenRecordings;
use super::identify::ResultArguments;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid shaft bench.toml
  dynoid shaft bench.toml WhiteNoise_T_TN_1200.mf4 --plot shaft.html
  dynoid shaft bench.toml --json | jq '.together.stiffness'

The command estimates stiffness K and damping B from every recording with a shaft; encoder gate and clock skews are part of the model. It repeats the estimate by frequency band, and with exact time stamps assumed. A joint estimate tests whether all recordings show the same shaft.

Checks on a bench with load cell: state space (T_d, ω_e) → ω_d; a black box T_d → ω_d with the engine motored (Unfired_N_NT); averaged periods of a periodic demand (Multisine_T_TN). Wide-band torque demands (WhiteNoise_T_TN, Multisine_T_TN) also give both inertias.

Effects beyond K and B are tested one at a time: a loss factor, a second mass, dependence on torque or speed, backlash.")]
pub(crate) struct ShaftArguments {
    #[command(flatten)]
    pub(crate) given: GivenRecordings,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
