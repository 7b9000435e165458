//! Arguments of the commands that show what models are like.

use std::path::PathBuf;

use clap::Args;

use super::ResultArguments;
use crate::cli::number;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid poles model.json --plot poles.png
  dynoid poles arx.json ss.json --level 0.99")]
pub(crate) struct ModelArguments {
    /// Model files
    #[arg(value_name = "MODEL.json", required = true)]
    pub(crate) models: Vec<PathBuf>,
    /// Confidence of bands and regions
    #[arg(long, default_value_t = 0.95, value_name = "SHARE", value_parser = number::share)]
    pub(crate) level: f64,
    /// Shows the way from the noise e to each output too; of a time series it is shown anyway
    #[arg(long)]
    pub(crate) noise: bool,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid bode model.json --plot bode.html
  dynoid bode arx.json ss.json --plot bode.svg
  dynoid step model.json --table
  dynoid step model.json --json | jq '.[0].summary'")]
pub(crate) struct CurveArguments {
    #[command(flatten)]
    pub(crate) models: ModelArguments,
    /// Prints every point of the curves, not their summary
    #[arg(long, conflicts_with = "json")]
    pub(crate) table: bool,
}
