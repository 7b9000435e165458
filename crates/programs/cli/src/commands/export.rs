//! `dynoid export`: a model as the files of another program.

use std::path::{Path, PathBuf};

use dynoid::Export;
use serde::Serialize;

use crate::cli::export::{ExportArguments, ExportTarget};
use crate::commands::result::Sorted;
use crate::error::{CliError, Outcome};
use crate::path::shown;
use crate::terminal::Terminal;

/// `dynoid export`
pub(crate) fn run(arguments: &ExportArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    if arguments.draws > 0 && arguments.to != ExportTarget::Ssv {
        return Err(CliError::Usage { what: "--draws belongs to --to ssv; give both".to_owned() });
    }
    let (target, out) = (arguments.to.with_draws(arguments.draws), arguments.out.as_deref());
    let export = Export::of_file(&arguments.model, target, out, &terminal.files())?;
    export.remark().iter().for_each(|remark| terminal.warning(remark));
    let written = export.write(&terminal.files())?;
    let is_replaced = |path: &PathBuf| written.replaced.iter().any(|other| other.file_name() == path.file_name());
    if arguments.json && !written.files.is_empty() {
        let facts = Facts { model: &arguments.model, files: &written.files, replaced: &written.replaced };
        terminal.json(&Sorted(facts))?;
    } else if !terminal.is_quiet() {
        for path in &written.files {
            terminal.line(&format!("{}: {}", if is_replaced(path) { "replaced" } else { "written" }, shown(path)));
        }
    }
    written.older_draws.iter().for_each(|warning| terminal.warning(warning));
    Ok(Outcome::Done)
}

/// The files that were written.
#[derive(Serialize)]
struct Facts<'a> {
    model: &'a Path,
    files: &'a [PathBuf],
    replaced: &'a [PathBuf],
}
