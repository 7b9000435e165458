//! Which data, and what is done with the result.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use dynoid::linear::DataOptions;
use ident::{Intersample, TrendShape};

use crate::cli::number;

/// The part of a recording that is used.
#[derive(Debug, Clone, Copy, Default, Args)]
pub(crate) struct Window {
    /// Leave out everything before this time
    #[arg(long = "from", value_name = "SECONDS", value_parser = number::seconds, help_heading = "Data")]
    pub(crate) from_s: Option<f64>,
    /// Leave out everything after this time
    #[arg(long = "to", value_name = "SECONDS", value_parser = number::seconds, help_heading = "Data")]
    pub(crate) to_s: Option<f64>,
}

/// Channels, time and clock of the data.
#[derive(Debug, Clone, Args)]
pub(crate) struct DataArguments {
    /// Recordings, one experiment each (MDF 2 to 4, CSV, MAT, HDF5, Parquet, Arrow; text without a time column with
    /// --sample-time)
    #[arg(value_name = "RECORDING", required = true)]
    pub(crate) recordings: Vec<PathBuf>,
    /// An input channel; repeat it for each input
    #[arg(long = "input", short = 'u', value_name = "CHANNEL", help_heading = "Data")]
    pub(crate) inputs: Vec<String>,
    /// An output channel; repeat it for each output
    #[arg(long = "output", short = 'y', value_name = "CHANNEL", help_heading = "Data")]
    pub(crate) outputs: Vec<String>,
    #[command(flatten)]
    pub(crate) window: Window,
    /// Sample time of the data. In text without a time column: the time from row to row [default: that of the slowest
    /// channel; for delay, oe, tf, process and greybox that of the fastest]
    #[arg(long = "sample-time", value_name = "SECONDS", value_parser = number::positive_seconds, help_heading = "Data")]
    pub(crate) sample_time_s: Option<f64>,
    /// What to subtract from every channel first
    #[arg(long, value_enum, default_value_t = Detrend::Mean, value_name = "WHAT", help_heading = "Data")]
    pub(crate) detrend: Detrend,
    /// How the inputs run between their samples. Continuous models (tf, process, greybox) are exact for each; for
    /// band-limited inputs up to 0.45 of the sample rate, without 32 samples at either end. An input faster than
    /// --sample-time is filtered and then band-limited [default: held]
    #[arg(long, value_enum, value_name = "HOW", help_heading = "Data")]
    pub(crate) between: Option<Between>,
}

impl DataArguments {
    /// The same for the library.
    pub(crate) fn options(&self) -> DataOptions {
        DataOptions {
            recordings: self.recordings.clone(),
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
            from_s: self.window.from_s,
            to_s: self.window.to_s,
            sample_time_s: self.sample_time_s,
            detrend: match self.detrend {
                Detrend::Mean => Some(TrendShape::Mean),
                Detrend::Line => Some(TrendShape::Line),
                Detrend::None => None,
            },
            between: self.between.map(Between::intersample),
        }
    }
}

impl Between {
    /// The same for the library.
    pub(crate) fn intersample(self) -> Intersample {
        match self {
            Between::Held => Intersample::ZeroOrderHold,
            Between::Straight => Intersample::FirstOrderHold,
            Between::BandLimited => Intersample::BandLimited,
        }
    }
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
    /// Constant, like the outputs of a computer
    Held,
    /// Straight to the next sample
    Straight,
    /// Nothing above half the sample rate
    BandLimited,
}

/// Results besides the text on the terminal.
#[derive(Debug, Clone, Args)]
pub(crate) struct ResultArguments {
    /// Draw the result into a file; its ending gives the kind: .html (interactive), .pdf, .svg or .png
    #[arg(long, value_name = "FILE")]
    pub(crate) plot: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Where a model is written, and which data judge it.
#[derive(Debug, Clone, Args)]
pub(crate) struct FitArguments {
    #[command(flatten)]
    pub(crate) data: DataArguments,
    /// The model file to write
    #[arg(long, short, value_name = "MODEL.json")]
    pub(crate) out: Option<PathBuf>,
    /// Estimate from this first share of each recording, and judge on the rest
    #[arg(long, value_name = "SHARE", conflicts_with = "validate", value_parser = number::share)]
    pub(crate) split: Option<f64>,
    /// Judge on another recording, at the operating point of the estimation data. `dynoid model compare --detrend mean`
    /// judges the dynamics alone
    #[arg(long, value_name = "RECORDING")]
    pub(crate) validate: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
