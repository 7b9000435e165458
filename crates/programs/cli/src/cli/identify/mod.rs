//! Arguments of `dynoid data`, `fit` and `model`: identification of linear models from any channels.

mod convert;
mod data;
mod explore;
mod fit;
mod greybox;
mod judge;
mod show;

use clap::Subcommand;

pub(crate) use convert::{ModelConvertArguments, Representation, Sampling};
pub(crate) use data::{Between, DataArguments, Detrend, FitArguments, ResultArguments};
pub(crate) use explore::{DelayArguments, OrderArguments, Period, SpectrumArguments, SpectrumMethod};
pub(crate) use fit::{
    ArxArguments, FitCommand, Initial, PolynomialArguments, ProcessArguments, StateSpaceArguments, SubspaceWeighting,
    TransferFunctionArguments, TransferFunctionBy,
};
pub(crate) use greybox::GreyBoxArguments;
pub(crate) use judge::{
    BenchArguments, CompareArguments, MeetArguments, PredictArguments, ResidualsArguments, RunArguments,
    SimulateModelArguments,
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

/// Views of data before a model is chosen.
#[derive(Debug, Subcommand)]
pub(crate) enum DataCommand {
    /// Estimate spectra of channels, and frequency responses between them
    Spectrum(SpectrumArguments),
    /// Estimate the delay from inputs to an output
    Delay(DelayArguments),
    /// Choose order and delay of an ARX model by several criteria
    Order(OrderArguments),
}

/// Uses of model files.
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
    Simulate(SimulateModelArguments),
    /// Convert a model: transfer function, poles and zeros, state space
    Convert(ModelConvertArguments),
}
