//! `dynoid study`: from a bench file to a report.

use std::path::Path;

use bench_model::document::BenchModelDocument;
use dynoid::{Bench, Error, Files, Mark, OutputFolder, Session, check_replaceable, paths};
use page::{Logo, Page, Paper, PdfOptions};
use report::wording;
use rig::Severity;
use rig::bench_file::ReportIdentity;
use study::{Analyses, Origin, Study};
use work::Context;

use super::bench_model::{Kind, MODEL};
use crate::cli::bench::{PaperSize, StudyArguments};
use crate::error::{CliError, Outcome};
use crate::summary::{self, Earlier, Written};
use crate::terminal::Terminal;

pub(crate) const REPORT: &str = "report.html";
/// The report with all analyses, which a study without them leaves alone.
pub(crate) const FULL_REPORT: &str = "report-full.html";
/// The reports on paper, and the first page alone.
pub(crate) const REPORT_PDF: &str = "report.pdf";
pub(crate) const FULL_REPORT_PDF: &str = "report-full.pdf";
pub(crate) const SUMMARY_PDF: &str = "summary.pdf";
pub(crate) const DATA: &str = "study.json";
/// The measured and modelled series of a study, in a table.
#[cfg(feature = "parquet")]
pub(crate) const SERIES: &str = "study-series.parquet";
#[cfg(not(feature = "parquet"))]
pub(crate) const SERIES: &str = "study-series.mf4";
/// The results of one study, of which none may be older than another. Full reports take minutes, and stay until the
/// next one.
const RESULTS: [&str; 6] = [DATA, REPORT, SERIES, MODEL, REPORT_PDF, SUMMARY_PDF];

/// How much a report holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// The model, and what it rests on.
    Model,
    /// All analyses of the recordings beside it.
    Full,
}

/// Files that a study writes beside its report and its data.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wanted {
    pub(crate) extent: Extent,
    /// The paper of PDFs.
    pub(crate) pdf: Option<Paper>,
    /// The paper of a summary.
    pub(crate) summary: Option<Paper>,
}

impl Wanted {
    /// The report in a browser, and nothing for paper.
    pub(crate) const REPORT: Wanted = Wanted { extent: Extent::Model, pdf: None, summary: None };

    fn of(arguments: &StudyArguments) -> Self {
        let paper = arguments.pdf.map(|size| match size {
            PaperSize::A4 => Paper::A4,
            PaperSize::Letter => Paper::Letter,
        });
        Wanted {
            extent: if arguments.full { Extent::Full } else { Extent::Model },
            pdf: paper,
            summary: arguments.summary.then(|| paper.unwrap_or_default()),
        }
    }
}

pub(crate) fn run(arguments: &StudyArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let out = arguments.out.clone().unwrap_or_else(|| paths::folder_of(&arguments.bench).join("study"));
    let written = study(&arguments.bench, &out, None, Wanted::of(arguments), terminal)?;
    if arguments.json {
        terminal.json(&summary::short(&written))?;
    } else if terminal.is_quiet() {
        let errors = written.study.diagnostics.iter().filter(|found| found.severity == Severity::Error);
        errors.for_each(|found| terminal.warning(&wording::remark(found)));
    } else {
        terminal.page(&summary::page(&written));
    }
    Ok(summary::outcome(&written.study))
}

/// Reads a bench file and its recordings, studies them, and writes the results.
pub(crate) fn study(
    bench: &Path,
    out: &Path,
    seed: Option<u64>,
    wanted: Wanted,
    terminal: &mut Terminal,
) -> Result<Written, CliError> {
    let files = terminal.files();
    let bench = Bench::load(bench, &files)?;
    let folder = OutputFolder::check(out, &files)?;
    check_results(out, wanted, &files)?;
    let earlier = earlier_model(&out.join(MODEL), terminal);
    let logo = bench.logo(&files)?;
    // Reading, studying, analysing, and writing.
    let step = terminal.work().step("study", if wanted.extent == Extent::Full { 4 } else { 3 });
    let session = Session::open(bench, &files, &step)?.with_seed(seed);
    let (study, analyses) = studied(&session, wanted.extent, &step)?;
    let origin = session.bench().origin();
    let writing = step.step("writing the report", 0);
    let pages = Pages::of(&study, &origin, analyses.as_ref(), logo.as_ref(), wanted);
    let series = study::series(&study).map(|table| dynoid::encode_table(&table, &terminal.files())).transpose()?;
    let json = study::document::json(&study, series.as_ref().map(|_| SERIES));
    let model = session.model(&study);
    let earlier = earlier.map(|earlier| Earlier::new(&earlier, model.as_ref()));
    let model = model.map(|document| document.to_json().map_err(CliError::internal)).transpose()?;
    let beside = pages.files(&session.bench().file().report, wanted, &terminal.files())?;
    let html = super::result::html(&pages.report, &terminal.files());
    let mut files: Vec<(&str, &[u8])> = beside.iter().map(|(name, bytes)| (*name, bytes.as_slice())).collect();
    files.extend([(DATA, json.as_bytes()), (REPORT, html.as_bytes())]);
    files.extend(series.as_deref().map(|series| (SERIES, series)));
    files.extend(model.as_ref().map(|model| (MODEL, model.as_bytes())));
    folder.replace(&files, &RESULTS)?;
    let path = |name: &str| files.iter().any(|(written, _)| *written == name).then(|| out.join(name));
    let is_of_earlier = |name: &&str| path(name).is_none() && out.join(name).is_file();
    let of_earlier =
        [FULL_REPORT, FULL_REPORT_PDF].into_iter().filter(is_of_earlier).map(|name| out.join(name)).collect();
    drop((writing, step));
    if let Some((file, page)) = pages.on_paper(wanted) {
        super::result::warn_without_glyph(file, page, terminal)?;
    }
    Ok(Written {
        report: out.join(REPORT),
        full_report: path(FULL_REPORT),
        paper: [REPORT_PDF, FULL_REPORT_PDF, SUMMARY_PDF].into_iter().filter_map(path).collect(),
        data: out.join(DATA),
        series: path(SERIES),
        model: path(MODEL),
        of_earlier,
        earlier,
        study,
    })
}

/// The bench model of the recordings that a bench file lists; nothing is written.
pub(in crate::commands) fn model_of(bench: &Path, terminal: &Terminal) -> Result<BenchModelDocument, CliError> {
    let files = terminal.files();
    let bench = Bench::load(bench, &files)?;
    let step = terminal.work().step("study", 2);
    Ok(Session::open(bench, &files, &step)?.bench_model(&step)?)
}

/// Refuses, before any work, a folder where a result would replace a file that is none.
fn check_results(out: &Path, wanted: Wanted, files: &Files) -> Result<(), CliError> {
    let full = wanted.extent == Extent::Full;
    let pages = [
        (REPORT, true),
        (SERIES, true),
        (FULL_REPORT, full),
        (REPORT_PDF, wanted.pdf.is_some()),
        (FULL_REPORT_PDF, full && wanted.pdf.is_some()),
        (SUMMARY_PDF, wanted.summary.is_some()),
    ];
    let pages = pages.into_iter().filter(|(_, is_written)| *is_written).map(|(name, _)| (name, Mark::of_run(files)));
    let documents = [(DATA, Mark::Document(Kind::Study)), (MODEL, Mark::Document(Kind::Bench))];
    Ok(pages.chain(documents).try_for_each(|(name, mark)| check_replaceable(&out.join(name), Some(&mark), files))?)
}

/// The bench model that an earlier study wrote here.
fn earlier_model(path: &Path, terminal: &mut Terminal) -> Option<BenchModelDocument> {
    let text = std::fs::read_to_string(path).ok().filter(|text| Kind::of(text) == Kind::Bench)?;
    let read = BenchModelDocument::from_json(&text);
    if let Err(fault) = &read {
        terminal.note(&format!("{}: {fault}; this study is not compared with it", path.display()));
    }
    read.ok()
}

/// The study, and all analyses where they are wanted.
fn studied(session: &Session, extent: Extent, context: &Context) -> Result<(Study, Option<Analyses>), Error> {
    match extent {
        Extent::Model => Ok((session.study(context)?, None)),
        Extent::Full => session.study_full(context).map(|(study, analyses)| (study, Some(analyses))),
    }
}

/// The reports of a study.
struct Pages {
    report: Page,
    full: Option<Page>,
    summary: Option<Page>,
}

impl Pages {
    fn of(study: &Study, origin: &Origin, analyses: Option<&Analyses>, logo: Option<&Logo>, wanted: Wanted) -> Self {
        let with_logo = |page: Page| Page { logo: logo.cloned(), ..page };
        Pages {
            report: with_logo(report::study(study, origin)),
            full: analyses.map(|found| with_logo(report::full_study(study, origin, found))),
            summary: wanted.summary.map(|_| with_logo(report::summary_page(study, origin))),
        }
    }

    /// Files that are wanted beside the report for a browser: the full report, and all that is for paper.
    fn files(
        &self,
        identity: &ReportIdentity,
        wanted: Wanted,
        files: &Files,
    ) -> Result<Vec<(&'static str, Vec<u8>)>, CliError> {
        let pdf = |page: &Page, paper: Paper, on_one_page: bool| {
            let author = identity.author.clone().unwrap_or_default();
            super::result::pdf(page, PdfOptions { paper, author, on_one_page, ..PdfOptions::default() }, files)
        };
        let mut all = Vec::new();
        if let Some(full) = &self.full {
            all.push((FULL_REPORT, super::result::html(full, files).into_bytes()));
        }
        if let Some(paper) = wanted.pdf {
            all.push((REPORT_PDF, pdf(&self.report, paper, false)?));
        }
        if let (Some(paper), Some(full)) = (wanted.pdf, &self.full) {
            all.push((FULL_REPORT_PDF, pdf(full, paper, false)?));
        }
        if let (Some(paper), Some(summary)) = (wanted.summary, &self.summary) {
            all.push((SUMMARY_PDF, pdf(summary, paper, true)?));
        }
        Ok(all)
    }

    /// The page with the most text of those that are written for paper, and its file.
    fn on_paper(&self, wanted: Wanted) -> Option<(&'static str, &Page)> {
        match (wanted.pdf, &self.full, &self.summary) {
            (Some(_), Some(full), _) => Some((FULL_REPORT_PDF, full)),
            (Some(_), None, _) => Some((REPORT_PDF, &self.report)),
            (None, _, Some(summary)) => Some((SUMMARY_PDF, summary)),
            (None, _, None) => None,
        }
    }
}
