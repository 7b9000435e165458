//! Studies with their pages, written into a folder.

use std::path::{Path, PathBuf};

use bench_model::document::BenchModelDocument;
use page::{Logo, Page, Paper, PdfOptions};
use rig::bench_file::ReportIdentity;
use study::Origin;
use study::document::SeriesFile;
use study::{Analyses, ModelComparison, Study, compare_models};
use work::Context;

use crate::bench::Bench;
use crate::error::Error;
use crate::features;
use crate::files::Files;
use crate::formats::encode_table;
use crate::mark::{Kind, Mark};
use crate::models::MODEL;
use crate::output::{OutputFolder, check_replaceable};
use crate::pages::{html, pdf, without_glyph};
use crate::read::sha256_of_bytes;
use crate::session::Session;

/// The report for a browser.
pub const REPORT: &str = "report.html";
/// The report with all analyses, which a study without them leaves alone.
pub const FULL_REPORT: &str = "report-full.html";
/// The report on paper.
pub const REPORT_PDF: &str = "report.pdf";
/// The report with all analyses on paper.
pub const FULL_REPORT_PDF: &str = "report-full.pdf";
/// The first page alone, on paper.
pub const SUMMARY_PDF: &str = "summary.pdf";
/// Every number of a study.
pub const DATA: &str = "study.json";
/// The measured and modelled series of a study, in a table.
#[cfg(feature = "parquet")]
pub const SERIES: &str = "study-series.parquet";
/// The measured and modelled series of a study.
#[cfg(not(feature = "parquet"))]
pub const SERIES: &str = "study-series.mf4";
/// The results of one study, of which none may be older than another. Full reports take minutes, and stay until the
/// next one.
const RESULTS: [&str; 6] = [DATA, REPORT, SERIES, MODEL, REPORT_PDF, SUMMARY_PDF];

/// Files of a study beside its report for a browser, its data and its model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StudyOptions {
    /// True for the report with all analyses.
    pub full: bool,
    /// The paper of reports as PDF.
    pub pdf: Option<Paper>,
    /// The paper of a summary.
    pub summary: Option<Paper>,
}

/// A folder that takes the results of a study.
#[derive(Debug)]
pub struct StudyFolder {
    out: PathBuf,
    folder: OutputFolder,
    options: StudyOptions,
    files: Files,
    logo: Option<Logo>,
    earlier: Option<BenchModelDocument>,
    remark: Option<String>,
}

/// A study and the files it was written to.
#[derive(Debug)]
pub struct WrittenStudy {
    /// The study.
    pub study: Study,
    /// All analyses, where they were wanted.
    pub analyses: Option<Analyses>,
    /// The report.
    pub report: PathBuf,
    /// The report with all analyses, where they were wanted.
    pub full_report: Option<PathBuf>,
    /// Files for paper.
    pub paper: Vec<PathBuf>,
    /// The numbers.
    pub data: PathBuf,
    /// The measured and modelled series, where something was estimated.
    pub series: Option<PathBuf>,
    /// The bench model, where the study has one.
    pub model: Option<PathBuf>,
    /// Reports of an earlier study that stay in the folder.
    pub of_earlier: Vec<PathBuf>,
    /// The study that was in the folder before, where it had a model.
    pub earlier: Option<EarlierStudy>,
    /// Characters that a file for paper does not show, in words.
    pub without_glyph: Option<String>,
}

/// An earlier study, and what has changed since.
#[derive(Debug)]
pub struct EarlierStudy {
    /// Its day.
    pub date: String,
    /// Its model against that of the new study; none where the new study has none.
    pub comparison: Option<ModelComparison>,
}

impl EarlierStudy {
    fn new(earlier: &BenchModelDocument, now: Option<&BenchModelDocument>) -> Self {
        let comparison = now.map(|now| compare_models(earlier, now));
        EarlierStudy { date: earlier.provenance.date.clone(), comparison }
    }
}

impl StudyFolder {
    /// Checks, before any work, that the results of a bench can be written, and reads what they need: the logo, and the
    /// model of an earlier study.
    ///
    /// # Errors
    /// A folder that cannot be written to, or in which a result would replace a file that is none.
    pub fn check(bench: &Bench, out: &Path, options: StudyOptions, files: &Files) -> Result<Self, Error> {
        let folder = OutputFolder::check(out, files)?;
        check_results(out, options, files)?;
        let (earlier, remark) = earlier_model(&out.join(MODEL));
        let logo = bench.logo(files)?;
        Ok(StudyFolder { out: out.to_owned(), folder, options, files: files.clone(), logo, earlier, remark })
    }

    /// That an earlier study cannot be compared, and why.
    pub fn remark(&self) -> Option<&str> {
        self.remark.as_deref()
    }

    /// Parts that the work of [`StudyFolder::write`] has.
    pub fn parts(&self) -> u64 {
        if self.options.full { 3 } else { 2 }
    }

    /// Studies the recordings of a session, and writes the results: all of them, or, if one cannot be written, none.
    ///
    /// # Errors
    /// No recording that can be used, and a file that cannot be written.
    pub fn write(&self, session: &Session, context: &Context) -> Result<WrittenStudy, Error> {
        let (options, files) = (self.options, &self.files);
        let (study, analyses) = match options.full {
            false => (session.study(context)?, None),
            true => session.study_full(context).map(|(study, analyses)| (study, Some(analyses)))?,
        };
        let origin = session.bench().origin();
        let writing = context.step("writing the report", 0);
        let pages = Pages::of(&study, &origin, analyses.as_ref(), self.logo.as_ref(), options);
        let series = study::series(&study).map(|table| encode_table(&table, files)).transpose()?;
        let sum = series.as_ref().map(|series| sha256_of_bytes(series));
        let table = sum.as_deref().map(|sha256| SeriesFile { name: SERIES, sha256 });
        let json = study::document::json(&study, table);
        let model = session.model(&study);
        let earlier = self.earlier.as_ref().map(|earlier| EarlierStudy::new(earlier, model.as_ref()));
        let model = model.map(|document| document.to_json().map_err(Error::internal)).transpose()?;
        let beside = pages.files(&session.bench().file().report, options, files)?;
        let html = html(&pages.report, files);
        let mut results: Vec<(&str, &[u8])> = beside.iter().map(|(name, bytes)| (*name, bytes.as_slice())).collect();
        results.extend([(DATA, json.as_bytes()), (REPORT, html.as_bytes())]);
        results.extend(series.as_deref().map(|series| (SERIES, series)));
        results.extend(model.as_ref().map(|model| (MODEL, model.as_bytes())));
        self.folder.replace(&results, &RESULTS)?;
        drop(writing);
        let path = |name: &str| results.iter().any(|(written, _)| *written == name).then(|| self.out.join(name));
        let is_of_earlier = |name: &&str| path(name).is_none() && self.out.join(name).is_file();
        let on_paper = pages.on_paper(options).map(|(file, page)| without_glyph(file, page)).transpose()?;
        Ok(WrittenStudy {
            report: self.out.join(REPORT),
            full_report: path(FULL_REPORT),
            paper: [REPORT_PDF, FULL_REPORT_PDF, SUMMARY_PDF].into_iter().filter_map(path).collect(),
            data: self.out.join(DATA),
            series: path(SERIES),
            model: path(MODEL),
            of_earlier: [FULL_REPORT, FULL_REPORT_PDF]
                .into_iter()
                .filter(is_of_earlier)
                .map(|name| self.out.join(name))
                .collect(),
            earlier,
            without_glyph: on_paper.flatten(),
            study,
            analyses,
        })
    }
}

/// Refuses, before any work, a folder where a result would replace a file that is none.
fn check_results(out: &Path, options: StudyOptions, files: &Files) -> Result<(), Error> {
    let StudyOptions { full, pdf, summary } = options;
    let pages = [
        (REPORT, true),
        (SERIES, true),
        (FULL_REPORT, full),
        (REPORT_PDF, pdf.is_some()),
        (FULL_REPORT_PDF, full && pdf.is_some()),
        (SUMMARY_PDF, summary.is_some()),
    ];
    let pages = pages.into_iter().filter(|(_, is_written)| *is_written).map(|(name, _)| (name, Mark::of_run(files)));
    let on_paper = [(REPORT_PDF, pdf.is_some()), (SUMMARY_PDF, summary.is_some())];
    for (name, _) in on_paper.into_iter().filter(|(_, is_written)| *is_written) {
        features::PDF.check(&out.join(name), "PDF")?;
    }
    let documents = [(DATA, Mark::Document(Kind::Study)), (MODEL, Mark::Document(Kind::Bench))];
    pages.chain(documents).try_for_each(|(name, mark)| check_replaceable(&out.join(name), Some(&mark), files))
}

/// The bench model that an earlier study wrote here, or why it cannot be read.
fn earlier_model(path: &Path) -> (Option<BenchModelDocument>, Option<String>) {
    let text = std::fs::read_to_string(path).ok().filter(|text| Kind::of(text) == Kind::Bench);
    match text.map(|text| BenchModelDocument::from_json(&text)) {
        None => (None, None),
        Some(Ok(document)) => (Some(document), None),
        Some(Err(fault)) => (None, Some(format!("{}: {fault}; this study is not compared with it", path.display()))),
    }
}

/// The reports of a study.
struct Pages {
    report: Page,
    full: Option<Page>,
    summary: Option<Page>,
}

impl Pages {
    fn of(
        study: &Study,
        origin: &Origin,
        analyses: Option<&Analyses>,
        logo: Option<&Logo>,
        options: StudyOptions,
    ) -> Self {
        let with_logo = |page: Page| Page { logo: logo.cloned(), ..page };
        Pages {
            report: with_logo(report::study(study, origin)),
            full: analyses.map(|found| with_logo(report::full_study(study, origin, found))),
            summary: options.summary.map(|_| with_logo(report::summary_page(study, origin))),
        }
    }

    /// Files that are wanted beside the report for a browser: the full report, and all that is for paper.
    fn files(
        &self,
        identity: &ReportIdentity,
        options: StudyOptions,
        files: &Files,
    ) -> Result<Vec<(&'static str, Vec<u8>)>, Error> {
        let on_paper = |page: &Page, paper: Paper, on_one_page: bool| {
            let author = identity.author.clone().unwrap_or_default();
            pdf(page, PdfOptions { paper, author, on_one_page, ..PdfOptions::default() }, files)
        };
        let mut all = Vec::new();
        if let Some(full) = &self.full {
            all.push((FULL_REPORT, html(full, files).into_bytes()));
        }
        if let Some(paper) = options.pdf {
            all.push((REPORT_PDF, on_paper(&self.report, paper, false)?));
        }
        if let (Some(paper), Some(full)) = (options.pdf, &self.full) {
            all.push((FULL_REPORT_PDF, on_paper(full, paper, false)?));
        }
        if let (Some(paper), Some(summary)) = (options.summary, &self.summary) {
            all.push((SUMMARY_PDF, on_paper(summary, paper, true)?));
        }
        Ok(all)
    }

    /// The page with the most text of those that are written for paper, and its file.
    fn on_paper(&self, options: StudyOptions) -> Option<(&'static str, &Page)> {
        match (options.pdf, &self.full, &self.summary) {
            (Some(_), Some(full), _) => Some((FULL_REPORT_PDF, full)),
            (Some(_), None, _) => Some((REPORT_PDF, &self.report)),
            (None, _, Some(summary)) => Some((SUMMARY_PDF, summary)),
            (None, _, None) => None,
        }
    }
}
