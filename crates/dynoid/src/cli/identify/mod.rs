//! Arguments of the commands that identify, judge and use linear models.

mod explore;
mod fit;
mod judge;
mod look;

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::number;

pub(crate) use explore::{DelayArguments, OrderArguments, SpectrumArguments, SpectrumMethod};
pub(crate) use fit::{
    ArxArguments, FitArguments, FitCommand, Initial, PolynomialArguments, ProcessArguments, StateSpaceArguments,
    SubspaceWeighting, TransferFunctionArguments, TransferFunctionBy,
};
pub(crate) use judge::{CompareArguments, MeetArguments, MeetDetrend, PredictArguments, ResidArguments, RunArguments};
pub(crate) use look::{CurveArguments, ModelArguments};

/// The part of a recording that is used.
#[derive(Debug, Clone, Copy, Default, Args)]
pub(crate) struct Window {
    /// Leaves out everything before this time of the recording
    #[arg(long = "from", value_name = "SECONDS", value_parser = number::finite, help_heading = "Data")]
    pub(crate) from_s: Option<f64>,
    /// Leaves out everything after this time of the recording
    #[arg(long = "to", value_name = "SECONDS", value_parser = number::finite, help_heading = "Data")]
    pub(crate) to_s: Option<f64>,
}

/// Channels, time and clock of the data.
#[derive(Debug, Clone, Args)]
pub(crate) struct DataArguments {
    /// Recordings, one experiment each (MDF 2 to 4, CSV, MAT, HDF5, Parquet, Arrow; text without a time column with --sample-time)
    #[arg(value_name = "RECORDING", required = true)]
    pub(crate) recordings: Vec<PathBuf>,
    /// A channel that acts on the system; give it again for each input
    #[arg(long = "input", short = 'u', value_name = "CHANNEL", help_heading = "Data")]
    pub(crate) inputs: Vec<String>,
    /// A channel that answers; give it again for each output
    #[arg(long = "output", short = 'y', value_name = "CHANNEL", help_heading = "Data")]
    pub(crate) outputs: Vec<String>,
    #[command(flatten)]
    pub(crate) window: Window,
    /// Sample time of the data [default: that of the slowest channel; for delay and for fits to the simulated output (oe, tf,
    /// process, greybox) that of the fastest]. For text without a time column, the time from row to row
    #[arg(long = "sample-time", value_name = "SECONDS", value_parser = number::positive, help_heading = "Data")]
    pub(crate) sample_time_s: Option<f64>,
    /// What is taken off every channel first
    #[arg(long, value_enum, default_value_t = Detrend::Mean, value_name = "WHAT", help_heading = "Data")]
    pub(crate) detrend: Detrend,
    /// What the inputs do between the samples of the recording. A continuous model (tf, process, greybox) is exact for each,
    /// for band-limited inputs up to 0.45 of the sample rate and but for 32 samples at either end, which are left out. An
    /// input faster than --sample-time is filtered, and band-limited since [default: held]
    #[arg(long, value_enum, value_name = "HOW", help_heading = "Data")]
    pub(crate) between: Option<Between>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Detrend {
    /// The mean of each recording
    Mean,
    /// The straight line of each recording
    Line,
    /// Nothing
    None,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Between {
    /// They stay, as the outputs of a computer do
    Held,
    /// They run straight to the next sample
    Straight,
    /// They hold nothing above half the sample rate
    BandLimited,
}

/// What comes out besides the text on the terminal.
#[derive(Debug, Clone, Args)]
pub(crate) struct ResultArguments {
    /// Draws the result into a file, its kind by the ending: .html (interactive), .svg or .png
    #[arg(long, value_name = "FILE")]
    pub(crate) plot: Option<PathBuf>,
    /// Prints the result as JSON
    #[arg(long)]
    pub(crate) json: bool,
}
