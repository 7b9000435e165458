//! Arguments of `dynoid model bode`, `step` and `poles`.

use std::path::PathBuf;

use clap::Args;

use super::data::ResultArguments;
use crate::cli::number;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid model poles model.json --plot poles.png
  dynoid model poles arx.json ss.json --level 0.99")]
pub(crate) struct ModelArguments {
    /// Model files
    #[arg(value_name = "MODEL.json", required = true)]
    pub(crate) models: Vec<PathBuf>,
    /// Confidence level of bands and regions
    #[arg(long, default_value_t = 0.95, value_name = "SHARE", value_parser = number::share)]
    pub(crate) level: f64,
    /// Show the path from the noise e to each output too; always shown for a time series
    #[arg(long)]
    pub(crate) noise: bool,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid model bode model.json --plot bode.html
  dynoid model bode arx.json ss.json --plot bode.svg
  dynoid model bode study/model.json --plot bench.html
  dynoid model step model.json --table
  dynoid model step model.json --json | jq '.[0].summary'")]
pub(crate) struct CurveArguments {
    #[command(flatten)]
    pub(crate) models: ModelArguments,
    /// Print every point of the curves instead of a summary
    #[arg(long, conflicts_with = "json")]
    pub(crate) table: bool,
}
