//! Arguments of `dynoid friction`.

use clap::Args;

use super::identify::ResultArguments;
use super::{GivenRecordings, number};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid friction bench.toml
  dynoid friction bench.toml NoShaft_N_NT_1200.mf4 --plot friction.html
  dynoid friction bench.toml NoShaft_T_TN.mf4 --slowest 200
  dynoid friction bench.toml --json | jq '.friction.parameters[] | {symbol, value, interval}'

Recordings without shaft tell friction and inertia: steps of the speed (NoShaft_N_NT) both, a run-out with T_d* at zero (NoShaft_T_TN) friction over inertia alone. All of them are used together. Coulomb and viscous friction are always estimated; terms that grow with the square and the cube of the speed where they are told from zero with 99 % confidence. By how much the torque's clock is late against the speed's is estimated with them.")]
pub(crate) struct FrictionArguments {
    #[command(flatten)]
    pub(crate) given: GivenRecordings,
    /// Leaves out what is slower [default: a fiftieth of the highest speed]
    #[arg(long, value_name = "RPM", value_parser = number::positive)]
    pub(crate) slowest: Option<f64>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
