//! Arguments of `dynoid data`, `fit` and `model`: identification of linear models from any channels.

mod convert;
mod explore;
mod fit;
mod judge;
mod show;

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use super::number;

pub(crate) use convert::{ModelConvertArguments, Representation, Sampling};
pub(crate) use explore::{DelayArguments, OrderArguments, SpectrumArguments, SpectrumMethod};
pub(crate) use fit::{
    ArxArguments, FitArguments, FitCommand, Initial, PolynomialArguments, ProcessArguments, StateSpaceArguments,
    SubspaceWeighting, TransferFunctionArguments, TransferFunctionBy,
};
pub(crate) use judge::{
    CompareArguments, MeetArguments, MeetDetrend, PredictArguments, ResidualsArguments, RunArguments,
};
pub(crate) use show::{CurveArguments, ModelArguments};

pub(crate) const DATA_EXAMPLES: &str = "\
Examples:
  dynoid data spectrum run.mf4 -u T_demand -y N_dyno --plot response.html
  dynoid data delay run.mf4 -u T_demand -y T_calc
  dynoid data order run.mf4 -u T_demand -y N_dyno

`dynoid inspect` lists the channels of a recording.";

pub(crate) const FIT_EXAMPLES: &str = "\
Examples:
  dynoid fit arx run.mf4 -u T_demand -y N_dyno --na 2 --nb 2 --nk 3
  dynoid fit tf run.mf4 -u T_demand -y T_calc --poles 1 --delay 0:0.01
  dynoid fit ss run.mf4 -u T_d -y w_d -y w_e --order auto --out model.json

`dynoid data` shows delay and order before a fit, `dynoid model` uses the model file.";

pub(crate) const MODEL_EXAMPLES: &str = "\
Examples:
  dynoid model bode model.json --plot bode.html
  dynoid model compare arx.json ss.json --on unseen.mf4
  dynoid model residuals model.json --on unseen.mf4

`dynoid fit … --out model.json` writes a model file.";

/// What data show before a model is chosen.
#[derive(Debug, Subcommand)]
pub(crate) enum DataCommand {
    /// Estimate spectra of channels, and frequency responses between them
    Spectrum(SpectrumArguments),
    /// Estimate the delay from inputs to an output
    Delay(DelayArguments),
    /// Choose order and delay of an ARX model by several criteria
    Order(OrderArguments),
}

/// What is done with model files.
#[derive(Debug, Subcommand)]
pub(crate) enum ModelCommand {
    /// Show frequency responses with confidence bands
    Bode(CurveArguments),
    /// Show step responses with confidence bands
    Step(CurveArguments),
    /// Show poles and zeros with confidence regions
    Poles(ModelArguments),
    /// Compare models on recordings: fit and RMS error
    Compare(CompareArguments),
    /// Test whether residuals are white and independent of the inputs
    Residuals(ResidualsArguments),
    /// Predict the outputs of a recording some samples ahead
    Predict(PredictArguments),
    /// Simulate a model on the inputs of a recording
    Simulate(RunArguments),
    /// Convert a model: transfer function, poles and zeros, state space
    Convert(ModelConvertArguments),
}

/// The part of a recording that is used.
#[derive(Debug, Clone, Copy, Default, Args)]
pub(crate) struct Window {
    /// Leave out everything before this time
    #[arg(long = "from", value_name = "SECONDS", value_parser = number::finite, help_heading = "Data")]
    pub(crate) from_s: Option<f64>,
    /// Leave out everything after this time
    #[arg(long = "to", value_name = "SECONDS", value_parser = number::finite, help_heading = "Data")]
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
    #[arg(long = "sample-time", value_name = "SECONDS", value_parser = number::positive, help_heading = "Data")]
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
    /// Draw the result into a file; its ending gives the kind: .html (interactive), .svg or .png
    #[arg(long, value_name = "FILE")]
    pub(crate) plot: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    pub(crate) json: bool,
}
