//! Arguments of `dynoid look`.

use clap::Args;

use super::GivenRecordings;
use super::identify::ResultArguments;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid look bench.toml
  dynoid look bench.toml BS_T_NT_1200.mf4 --plot lines.html
  dynoid look bench.toml Ramp_N_NT_1200.mf4 --plot campbell.svg
  dynoid look bench.toml --json | jq '.recordings[].parts[].signals[].lines[] | select(.cause.cause == \"unknown\")'

Each line of the spectra is named by what it follows: the crank angle (orders, also those that fold from above half the sample rate), the demand, the images that a held demand has, the mains and the ripple of the drive; broad peaks are resonances. Lines that a recording cannot tell apart are undecided, with a speed at which they lie apart. Where the speed changes, in a recording or from one to the next, each order's amplitude over the speed is given too, and --plot draws a Campbell map.")]
pub(crate) struct LookArguments {
    #[command(flatten)]
    pub(crate) given: GivenRecordings,
    /// Shows the strongest lines of each signal alone, so many of them; 0 for all
    #[arg(long, value_name = "N", default_value_t = 8)]
    pub(crate) lines: usize,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
