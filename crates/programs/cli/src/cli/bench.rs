//! Arguments of the commands for the whole bench: `dynoid init`, `study` and `demo`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::number;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid init recordings/
  dynoid init monday/*.mf4 tuesday/*.mf4 --out cell4.toml
  dynoid init wednesday/ --out cell4.toml --update

Check the proposal: a channel with the wrong role gives a wrong model. Then fill in what recordings cannot show: the number of cylinders and both inertias.")]
pub(crate) struct InitArguments {
    /// Recordings, or folders of recordings (MDF, CSV, MAT, HDF5, Parquet, Arrow)
    #[arg(value_name = "RECORDINGS", required = true)]
    pub(crate) recordings: Vec<PathBuf>,
    /// The bench file to write
    #[arg(long, value_name = "FILE", default_value = "bench.toml")]
    pub(crate) out: PathBuf,
    /// Replace a bench file that is already there
    #[arg(long)]
    pub(crate) force: bool,
    /// Add to a bench file that is already there what it lacks: channels, recordings, places for labels. Values,
    /// comments and order stay
    #[arg(long, conflicts_with = "force")]
    pub(crate) update: bool,
    /// Print the proposal as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid study bench.toml
  dynoid study cell4/bench.toml --out results/2026-05-03
  dynoid study bench.toml --full
  dynoid study bench.toml --pdf --summary
  dynoid study bench.toml --pdf=letter
  dynoid study bench.toml --json | jq .verdict.level

The study writes report.html, one file for any browser, and model.json, the bench model, which other commands take. For programs it writes every number to study.json, and the measured and modelled series to study-series.parquet. It replaces older results only when the new ones are complete. `dynoid init` proposes the bench file.

With --full the study also writes report-full.html, which contains `dynoid lines`, `torque-signals`, `torque-control`, `controller`, `controller noise-test`, `shaft`, `engine`, `friction` and `experiment next`. If an analysis lacks its recording, the report names the experiment to run.

With --pdf each report is also written as a PDF, report.pdf, with contents, bookmarks and tags. With --summary the study writes summary.pdf: verdict, range of validity, next step, six numbers and a replay on one page.")]
pub(crate) struct StudyArguments {
    /// The bench file: what is known of the bench, its channels, and its recordings
    #[arg(value_name = "BENCH.toml")]
    pub(crate) bench: PathBuf,
    /// Folder for the results [default: study/ next to the bench file]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Write report-full.html too: the report with all analyses of single parts
    #[arg(long)]
    pub(crate) full: bool,
    /// Write report.pdf too, for paper of this size [default: a4]
    #[arg(long, value_name = "PAPER", num_args = 0..=1, require_equals = true, default_missing_value = "a4", hide_default_value = true)]
    pub(crate) pdf: Option<PaperSize>,
    /// Write summary.pdf: the answer of the study on one page
    #[arg(long)]
    pub(crate) summary: bool,
    /// Print verdict, estimates and findings as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// A size of paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum PaperSize {
    /// 210 mm × 297 mm
    A4,
    /// 8.5 in × 11 in
    Letter,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid demo
  dynoid demo --out first-try --seed 7
  dynoid demo --json | jq '.comparison[] | select(.contains_truth | not)'

The folder then contains recordings/*.mf4, bench.toml, report.html, effects.html, model.json, study.json and study-series.parquet. Change bench.toml and run `dynoid study` on it: leave recordings out, or change an inertia.")]
pub(crate) struct DemoArguments {
    /// Folder to write to; created if it does not exist
    #[arg(long, value_name = "DIR", default_value = "dynoid-demo")]
    pub(crate) out: PathBuf,
    /// Seed of the simulation; the same seed gives the same recordings
    #[arg(long, value_name = "N", value_parser = number::seed, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Print the comparison as JSON
    #[arg(long)]
    pub(crate) json: bool,
}
