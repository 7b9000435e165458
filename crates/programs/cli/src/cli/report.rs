//! Arguments of `dynoid report`.

use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid report study/study.json
  dynoid report study.json --out cell4.pdf

The command needs neither the recordings nor the bench file. The curves of figures come from the table that study.json names, if it lies beside it; figures without curves are left out. The report has neither the logo nor the analyses of `dynoid study --full`.")]
pub(crate) struct ReportArguments {
    /// The study.json of `dynoid study`
    #[arg(value_name = "STUDY")]
    pub(crate) study: PathBuf,
    /// File to write, .html or .pdf [default: STUDY with the ending .html]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}
