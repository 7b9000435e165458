//! Arguments of `dynoid look`.

use std::path::PathBuf;

use clap::Args;

use super::identify::ResultArguments;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid look bench.toml
  dynoid look bench.toml BS_T_NT_1200.mf4 --plot lines.html
  dynoid look bench.toml --json | jq '.recordings[].parts[].signals[].lines[] | select(.cause == \"unknown\")'

Each line of the spectra is named by what it follows: the crank angle (orders, also those that fold from above half the sample rate), the demand, the images that a held demand has, the mains and the ripple of the drive; broad peaks are resonances. Lines that a recording cannot tell apart are undecided, with a speed at which they lie apart.")]
pub(crate) struct LookArguments {
    /// The bench file: channels, cylinders, and where the recordings are
    #[arg(value_name = "BENCH.toml")]
    pub(crate) bench: PathBuf,
    /// Recordings, or folders of recordings [default: those of the bench file]
    #[arg(value_name = "RECORDING")]
    pub(crate) recordings: Vec<PathBuf>,
    /// Shows the strongest lines of each signal alone, so many of them; 0 for all
    #[arg(long, value_name = "N", default_value_t = 8)]
    pub(crate) lines: usize,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
