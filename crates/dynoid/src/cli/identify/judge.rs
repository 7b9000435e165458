//! Arguments of the commands that hold models against recordings.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{ResultArguments, Window};
use crate::cli::number;

/// Recordings that a model meets; channels and clock are those of the model.
#[derive(Debug, Clone, Args)]
pub(crate) struct MeetArguments {
    /// A recording with the model's channels; give it again for more
    #[arg(long = "on", value_name = "RECORDING", required = true, help_heading = "Data")]
    pub(crate) on: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) window: Window,
    /// Clock that a continuous model is sampled on, and, for text without a time column, the time from row to row
    /// [default: the model's sample time]
    #[arg(long = "sample-time", value_name = "SECONDS", value_parser = number::positive, help_heading = "Data")]
    pub(crate) sample_time_s: Option<f64>,
    /// What is taken off every channel first, and put back on what the model says of it
    #[arg(long, value_enum, default_value_t = MeetDetrend::Model, value_name = "WHAT", help_heading = "Data")]
    pub(crate) detrend: MeetDetrend,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MeetDetrend {
    /// What was taken off the model's own data (nothing where nothing was): the model with its operating point answers for
    /// levels too. On a recording that it was estimated from, that recording's own; on others, the mean of those levels
    Model,
    /// The mean of each recording: judges the dynamics alone, wherever a recording rests
    Mean,
    /// The straight line of each recording
    Line,
    /// Nothing
    None,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid compare arx.json armax.json ss.json --on unseen.mf4 --plot compare.html
  dynoid compare model.json --on unseen.mf4 --horizon 10")]
pub(crate) struct CompareArguments {
    /// Model files
    #[arg(value_name = "MODEL.json", required = true)]
    pub(crate) models: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) meet: MeetArguments,
    /// Compares predictions so many samples ahead, not simulations
    #[arg(long, value_name = "SAMPLES", value_parser = number::count)]
    pub(crate) horizon: Option<usize>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid resid model.json --on unseen.mf4 --plot residuals.html")]
pub(crate) struct ResidArguments {
    /// The model file
    #[arg(value_name = "MODEL.json")]
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) meet: MeetArguments,
    /// Correlations up to this lag, in samples
    #[arg(long, default_value_t = 25, value_parser = number::count)]
    pub(crate) lags: usize,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid predict model.json --on run.mf4 --horizon 10 --out predicted.mf4 --plot predicted.html")]
pub(crate) struct RunArguments {
    /// The model file
    #[arg(value_name = "MODEL.json")]
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) meet: MeetArguments,
    /// Starts from rest; otherwise the initial state is fitted to the measured outputs
    #[arg(long)]
    pub(crate) from_rest: bool,
    /// Writes the outputs to a recording, its format by the ending: .mf4, .csv, .tsv, .mat, .parquet or .arrow
    #[arg(long, short, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
pub(crate) struct PredictArguments {
    #[command(flatten)]
    pub(crate) run: RunArguments,
    /// How many samples ahead
    #[arg(long, default_value_t = 1, value_name = "SAMPLES", value_parser = number::count)]
    pub(crate) horizon: usize,
}
