//! Arguments of `dynoid friction`.

use clap::Args;

use super::given::GivenRecordings;
use super::identify::ResultArguments;
use super::number;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid friction bench.toml
  dynoid friction bench.toml NoShaft_N_NT_1200.mf4 --plot friction.html
  dynoid friction bench.toml NoShaft_T_TN.mf4 --slowest 200
  dynoid friction bench.toml --json | jq '.friction.parameters'

The command needs recordings without shaft. Speed steps (NoShaft_N_NT) give friction and inertia; a run-out with T_d* at zero (NoShaft_T_TN) gives friction over inertia. All of them are used together.

Coulomb and viscous friction are always estimated. Terms in the square and the cube of the speed are added where they differ from zero with 99 % confidence. The delay between the clocks of torque and speed is estimated too.")]
pub(crate) struct FrictionArguments {
    #[command(flatten)]
    pub(crate) given: GivenRecordings,
    /// Ignore slower speeds [default: a fiftieth of the highest speed]
    #[arg(long, value_name = "RPM", value_parser = number::positive_rpm)]
    pub(crate) slowest: Option<f64>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
