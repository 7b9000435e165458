//! `dynoid report`: the report of a study that was written.

use dynoid::{Mark, StudyFile, check_file};

use super::result::write_page;
use crate::cli::report::ReportArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// `dynoid report`
pub(crate) fn run(arguments: &ReportArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let out = arguments.out.clone().unwrap_or_else(|| arguments.study.with_extension("html"));
    let files = terminal.files();
    check_file(&out, &Mark::of_run(&files), &files)?;
    let StudyFile { study, origin, unread } = StudyFile::load(&arguments.study, &files, terminal.work())?;
    if let Some((table, why)) = unread {
        terminal.warning(&format!("{}: {why}; figures that show its curves are left out", table.display()));
    }
    write_page(&out, &report::study(&study, &origin), terminal)?;
    if !terminal.is_quiet() {
        terminal.line(&format!("written: {}", out.display()));
    }
    Ok(Outcome::Done)
}
