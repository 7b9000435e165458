//! Arguments of `dynoid diff`.

use std::path::PathBuf;

use clap::Args;

use super::identify::ResultArguments;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid diff may/model.json study/model.json
  dynoid diff may/model.json study/model.json --plot diff.html
  dynoid diff may/model.json study/model.json --quiet && echo same

Make new recordings of the bench, study them with `dynoid study`, and compare the new model with the earlier one. The command tests each part as a whole, and each parameter, by the covariances of both models. The exit code is 1 if the bench has changed.")]
pub(crate) struct DiffArguments {
    /// The earlier bench model
    #[arg(value_name = "FIRST.json")]
    pub(crate) first: PathBuf,
    /// The bench model of the new recordings
    #[arg(value_name = "SECOND.json")]
    pub(crate) second: PathBuf,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
