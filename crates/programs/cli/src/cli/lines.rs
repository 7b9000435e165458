//! Arguments of `dynoid lines`.

use clap::Args;

use super::given::GivenRecordings;
use super::identify::ResultArguments;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid lines bench.toml
  dynoid lines bench.toml --each
  dynoid lines bench.toml BS_T_NT_1200.mf4 --plot lines.html
  dynoid lines bench.toml Ramp_N_NT_1200.mf4 --plot campbell.svg
  dynoid lines bench.toml --json | jq '.recordings[].parts[].signals[].lines'

Each line gets the name of its cause: an order of the crank angle (aliases included), the demand, images of a held demand, the mains, or drive ripple. A broad peak is a resonance of the shaft only where N_d and N_e swing against each other as their inertias demand. Where two causes fit equally well, the line stays undecided, and a speed is proposed that separates them.

The lines of several recordings are summed up in one table. If the speed changes within or between recordings, the amplitude of each order over speed is shown too, and --plot draws a Campbell diagram.")]
pub(crate) struct LinesArguments {
    #[command(flatten)]
    pub(crate) given: GivenRecordings,
    /// Show only this many of the strongest lines of each signal; 0 for all
    #[arg(long, value_name = "N", default_value_t = 8)]
    pub(crate) lines: usize,
    /// Show the lines of each recording, not only the table that sums them up
    #[arg(long)]
    pub(crate) each: bool,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
