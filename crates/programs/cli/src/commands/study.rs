//! `dynoid study`: from a bench file to a report.

use std::path::Path;

use bench_model::document::BenchModelDocument;
use dynoid::facts::WrittenFacts;
use dynoid::{Bench, Session, StudyFolder, StudyOptions, WrittenStudy, paths};
use page::Paper;
use report::wording;
use rig::Severity;

use crate::cli::bench::{PaperSize, StudyArguments};
use crate::error::{CliError, Outcome};
use crate::summary;
use crate::terminal::Terminal;

/// The files that are wanted.
fn options(arguments: &StudyArguments) -> StudyOptions {
    let paper = arguments.pdf.map(|size| match size {
        PaperSize::A4 => Paper::A4,
        PaperSize::Letter => Paper::Letter,
    });
    let summary = arguments.summary.then(|| paper.unwrap_or_default());
    StudyOptions { full: arguments.full, pdf: paper, summary }
}

pub(crate) fn run(arguments: &StudyArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let out = arguments.out.clone().unwrap_or_else(|| paths::folder_of(&arguments.bench).join("study"));
    let written = study(&arguments.bench, &out, None, options(arguments), terminal)?;
    if arguments.json {
        terminal.json(&WrittenFacts::of(&written))?;
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
    options: StudyOptions,
    terminal: &mut Terminal,
) -> Result<WrittenStudy, CliError> {
    let files = terminal.files();
    let bench = Bench::load(bench, &files)?;
    let folder = StudyFolder::check(&bench, out, options, &files)?;
    folder.remark().iter().for_each(|remark| terminal.note(remark));
    // Reading is the part beside those of the folder.
    let step = terminal.work().step("study", folder.parts() + 1);
    let session = Session::open(bench, &files, &step)?.with_seed(seed);
    let written = folder.write(&session, &step)?;
    drop(step);
    written.without_glyph.iter().for_each(|missing| terminal.warning(missing));
    Ok(written)
}

/// The bench model of the recordings that a bench file lists; nothing is written.
pub(in crate::commands) fn model_of(bench: &Path, terminal: &Terminal) -> Result<BenchModelDocument, CliError> {
    let files = terminal.files();
    let bench = Bench::load(bench, &files)?;
    let step = terminal.work().step("study", 2);
    Ok(Session::open(bench, &files, &step)?.bench_model(&step)?)
}
