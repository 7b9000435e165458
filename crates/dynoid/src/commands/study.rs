//! `dynoid study`: from a bench file to a report.

use std::path::Path;

use bench_model::document::{BenchModelDocument, format_of};
use report::{Origin, wording};
use rig::BenchFile;
use study::{Analyses, Campaign, Progress as StudyProgress, Source, Study, StudyError};

use super::bench_model::MODEL;
use crate::cli::bench::StudyArguments;
use crate::date;
use crate::error::{CliError, Outcome};
use crate::formats;
use crate::input;
use crate::output::OutputFolder;
use crate::paths;
use crate::summary::{self, Earlier, Written};
use crate::terminal::{Progress, Terminal};

pub(crate) const REPORT: &str = "report.html";
/// The report with all analyses, which a study without them leaves alone.
pub(crate) const FULL_REPORT: &str = "report-full.html";
pub(crate) const DATA: &str = "study.json";
/// The measured and modelled series of a study, in a table.
#[cfg(feature = "parquet")]
pub(crate) const SERIES: &str = "study-series.parquet";
#[cfg(not(feature = "parquet"))]
pub(crate) const SERIES: &str = "study-series.mf4";
/// Parts that are estimated, and replays there usually are: steps of the progress display.
const PARTS: u64 = 6;
const REPLAYS: u64 = 4;

/// How much a report holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// The model, and what it rests on.
    Model,
    /// All analyses of the recordings beside it.
    Full,
}

pub(crate) fn run(arguments: &StudyArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let out = arguments.out.clone().unwrap_or_else(|| paths::folder_of(&arguments.bench).join("study"));
    let extent = if arguments.full { Extent::Full } else { Extent::Model };
    let written = study(&arguments.bench, &out, (None, extent), terminal)?;
    if arguments.json {
        terminal.json(&summary::short(&written))?;
    } else if !terminal.is_quiet() {
        terminal.page(&summary::page(&written));
    }
    Ok(summary::outcome(&written.study))
}

/// Reads a bench file and its recordings, studies them, and writes the results.
pub(crate) fn study(
    bench: &Path,
    out: &Path,
    (seed, extent): (Option<u64>, Extent),
    terminal: &mut Terminal,
) -> Result<Written, CliError> {
    let (file, text) = read_bench(bench)?;
    let folder = OutputFolder::check(out)?;
    let earlier = earlier_model(&out.join(MODEL), terminal)?;
    let analyses = if extent == Extent::Full { Analyses::COUNT as u64 } else { 0 };
    let progress = terminal.progress(PARTS + REPLAYS + analyses);
    let sources = read_sources(bench, &file, &progress)?;
    let name = bench.file_name().unwrap_or(bench.as_os_str()).to_string_lossy().into_owned();
    let campaign = Campaign { bench: &file, bench_file: (&name, &text), sources, seed };
    let origin = origin(&text);
    let (study, html, full) = studied(campaign, &origin, extent, &progress).map_err(|error| no_study(bench, error))?;
    let series = study::series(&study).map(|table| formats::encode_table(&table)).transpose()?;
    let json = report::json(&study, series.as_ref().map(|_| SERIES));
    let model = document(&study, &text);
    let earlier = earlier.map(|earlier| Earlier::new(&earlier, model.as_ref()));
    let model = model.map(|document| document.to_json().map_err(CliError::internal)).transpose()?;
    if let Some(full) = &full {
        folder.write(&[(FULL_REPORT, full.as_bytes())])?;
    }
    let results = [
        (DATA, Some(json.as_bytes())),
        (REPORT, Some(html.as_bytes())),
        (SERIES, series.as_deref()),
        (MODEL, model.as_ref().map(String::as_bytes)),
    ];
    let [Some(data), Some(report), series, model] = folder.write_or_remove(results)? else {
        return Err(CliError::internal("results without a path"));
    };
    drop(progress);
    let full_report = full.map(|_| out.join(FULL_REPORT));
    Ok(Written { study, report, full_report, data, series, model, earlier })
}

/// The bench model of the recordings that a bench file lists; nothing is written.
pub(in crate::commands) fn model_of(bench: &Path, terminal: &Terminal) -> Result<BenchModelDocument, CliError> {
    let (file, text) = read_bench(bench)?;
    let progress = terminal.progress(PARTS + REPLAYS);
    let sources = read_sources(bench, &file, &progress)?;
    let name = bench.file_name().unwrap_or(bench.as_os_str()).to_string_lossy().into_owned();
    let campaign = Campaign { bench: &file, bench_file: (&name, &text), sources, seed: None };
    let study = study::run(campaign, &mut |step| show(&progress, &step)).map_err(|error| no_study(bench, error))?;
    document(&study, &text).ok_or_else(|| CliError::NoModelOfBench { path: bench.to_owned() })
}

/// The bench model of a study, if it has one.
fn document(study: &Study, bench_file: &str) -> Option<BenchModelDocument> {
    report::bench_model(study, origin(bench_file))
}

fn origin(bench_file: &str) -> Origin {
    Origin { date: date::today(), bench_file_sha256: input::sha256_of_text(bench_file) }
}

/// The bench model that an earlier study wrote here. A file that is no bench model is not replaced.
fn earlier_model(path: &Path, terminal: &mut Terminal) -> Result<Option<BenchModelDocument>, CliError> {
    if !path.is_file() {
        return Ok(None);
    }
    let text = std::fs::read_to_string(path).unwrap_or_default();
    if !format_of(&text).is_some_and(|format| BenchModelDocument::is_format(&format)) {
        return Err(CliError::NotABenchModel { path: path.to_owned() });
    }
    let read = BenchModelDocument::from_json(&text);
    if let Err(fault) = &read {
        terminal.note(&format!("{}: {fault}; this study is not compared with it", path.display()));
    }
    Ok(read.ok())
}

/// The recordings that a bench file lists. Each is read here, and checked by the study: two steps.
pub(in crate::commands) fn read_sources(
    bench: &Path,
    file: &BenchFile,
    progress: &Progress,
) -> Result<Vec<Source>, CliError> {
    let files = input::listed(bench, &file.recordings.files)?;
    progress.more(2 * files.len() as u64);
    let read = |file: &input::InputFile| {
        progress.say(&format!("reading {}", file.name));
        let source = input::read_source(file);
        progress.step();
        source
    };
    files.iter().map(read).collect()
}

/// The study, the report of it and, if it is wanted, that with all analyses.
fn studied(
    campaign: Campaign<'_>,
    origin: &Origin,
    extent: Extent,
    progress: &Progress,
) -> Result<(Study, String, Option<String>), StudyError> {
    let mut step = |step| show(progress, &step);
    let (study, analyses) = match extent {
        Extent::Model => (study::run(campaign, &mut step)?, None),
        Extent::Full => study::run_full(campaign, &mut step).map(|(study, analyses)| (study, Some(analyses)))?,
    };
    progress.say("writing the report");
    let html = |page: &page::Page| page::html(page, super::result::PROGRAM);
    let full = analyses.map(|analyses| html(&report::full_study(&study, origin, &analyses)));
    let report = html(&report::study(&study, origin));
    Ok((study, report, full))
}

/// A bench file and its text.
pub(crate) fn read_bench(bench: &Path) -> Result<(BenchFile, String), CliError> {
    let text = bench_text(bench)?;
    let file = text.parse().map_err(|source| CliError::BenchFile { path: bench.to_owned(), source })?;
    Ok((file, text))
}

fn bench_text(bench: &Path) -> Result<String, CliError> {
    if bench.is_dir() {
        let inside = bench.join("bench.toml");
        let remedy = match inside.is_file() {
            true => format!("did you mean {}?", inside.display()),
            false => "name a bench file, or have one proposed with `dynoid init`".into(),
        };
        return Err(CliError::IsFolder { path: bench.to_owned(), remedy });
    }
    input::read_text(bench, "a bench file such as `dynoid init` writes")
}

pub(in crate::commands) fn show(progress: &Progress, step: &StudyProgress) {
    match step {
        StudyProgress::Preparing { file } => progress.say(&format!("checking {file}")),
        StudyProgress::Estimating { part } => progress.say(&format!("estimating: {}", wording::part(*part))),
        StudyProgress::Replaying { file } => progress.say(&format!("replaying {file}")),
        StudyProgress::Analysing { what } => progress.say(&format!("analysing: {what}")),
    }
    progress.step();
}

pub(in crate::commands) fn no_study(bench: &Path, error: StudyError) -> CliError {
    match error {
        StudyError::NoChannels => CliError::NoChannelsNamed { path: bench.to_owned() },
        StudyError::NoRecordings => CliError::NoRecordingsListed { path: bench.to_owned() },
        StudyError::NothingUsable { count, diagnostics } => CliError::NothingUsable {
            bench: bench.to_owned(),
            count,
            reasons: diagnostics.iter().map(|found| format!("  {}", wording::diagnostic(found))).collect(),
        },
    }
}
