//! Arguments of `dynoid diff`.

use std::path::PathBuf;

use clap::Args;

use super::identify::ResultArguments;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid diff may/model.json study/model.json
  dynoid diff may/model.json study/model.json --plot diff.html
  dynoid diff TestCell4.fmu new/bench.toml
  dynoid diff may/model.json study/model.json --quiet && echo same

FIRST and SECOND are a model.json, the study.json beside one, or an FMU of `dynoid export`. SECOND may be a bench file as well: its recordings are studied as `dynoid study` does, and nothing is written. The command tests each part as a whole, and each parameter, by the covariances of both models. The exit code is 1 if the bench has changed.")]
pub(crate) struct DiffArguments {
    /// The earlier bench model: model.json, study.json or an FMU
    #[arg(value_name = "FIRST")]
    pub(crate) first: PathBuf,
    /// The bench model of the new recordings, or the bench file that lists them
    #[arg(value_name = "SECOND")]
    pub(crate) second: PathBuf,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
