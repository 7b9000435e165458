//! Arguments of `dynoid data spectrum`, `delay` and `order`.

use clap::{Args, ValueEnum};

use super::data::{DataArguments, ResultArguments};
use crate::cli::number;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SpectrumMethod {
    /// Averaged periodograms (Welch)
    Welch,
    /// Blackman and Tukey's windowed correlations
    BlackmanTukey,
    /// The local polynomial method
    Lpm,
    /// The local rational method, for light damping
    Lrm,
    /// The quotient of the Fourier transforms
    Etfe,
}

/// The period of inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Period {
    None,
    Seconds(f64),
}

fn period(text: &str) -> Result<Period, String> {
    if text == "none" { Ok(Period::None) } else { number::positive_seconds(text).map(Period::Seconds) }
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid data spectrum run.mf4 -y N_dyno --plot spectrum.html
  dynoid data spectrum run.mf4 -u T_demand -y N_dyno --plot response.html
  dynoid data spectrum multisine.mf4 -u T_demand -y N_dyno --period 1

Where the inputs repeat, the response is the mean over periods, at the excited lines only. Its noise is that between periods, and periods in which the outputs have not settled are left out.")]
pub(crate) struct SpectrumArguments {
    #[command(flatten)]
    pub(crate) data: DataArguments,
    /// The method where the inputs do not repeat; without an input, Welch's power spectrum [default: lpm]
    #[arg(long, value_enum)]
    pub(crate) method: Option<SpectrumMethod>,
    /// The period of the inputs in seconds; `none` uses --method even if the inputs repeat [default: found in the data]
    #[arg(long, value_name = "SECONDS", value_parser = period)]
    pub(crate) period: Option<Period>,
    /// Length of Welch's segments or of the lag window, in samples: longer resolves closer peaks, shorter reduces
    /// variance [default: an eighth of the record, 1024 at most]
    #[arg(long, value_name = "SAMPLES", value_parser = number::count)]
    pub(crate) window: Option<usize>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid data delay run.mf4 -u T_demand -y T_calc
  dynoid data delay run.mf4 -u T_demand -y N_dyno --between straight

The delay is the dead time of the simplest model whose residuals are independent of the inputs: a gain, or 1 to 4 poles. Its interval is valid with coloured noise and ripple, and includes time stamp errors of a twentieth of the fastest raster. Without a valid model, or if methods disagree, the command gives no interval and says why.")]
pub(crate) struct DelayArguments {
    #[command(flatten)]
    pub(crate) data: DataArguments,
    /// Longest delay to try, in samples of the fastest channel [default: 30, and a quarter of a short recording]
    #[arg(long, value_name = "SAMPLES", value_parser = number::count)]
    pub(crate) longest: Option<usize>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid data order run.mf4 -u T_demand -y N_dyno --na 1:10 --nb 1:10")]
pub(crate) struct OrderArguments {
    #[command(flatten)]
    pub(crate) data: DataArguments,
    /// Orders of A, FIRST:LAST
    #[arg(long, default_value = "1:6", value_name = "RANGE")]
    pub(crate) na: String,
    /// Coefficients of B, FIRST:LAST
    #[arg(long, default_value = "1:6", value_name = "RANGE")]
    pub(crate) nb: String,
    /// Delays in samples, FIRST:LAST
    #[arg(long, default_value = "1:3", value_name = "RANGE")]
    pub(crate) nk: String,
    /// Fit on this share of the data, and rank on the rest too
    #[arg(long, value_name = "SHARE", value_parser = number::share)]
    pub(crate) split: Option<f64>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
