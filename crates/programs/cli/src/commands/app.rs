//! `dynoid app`: the app, until it is ended.

use std::path::PathBuf;

use dynoid_app::{App, Program};

use crate::cli::Cli;
use crate::cli::app::AppArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &AppArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let commands = serde_json::to_value(Cli::described()).map_err(CliError::internal)?;
    let (path, before) = program()?;
    let app = App::open(&arguments.folder, arguments.port, Program { path, before, commands })?;
    let address = app.address();
    // In one line, however long it is.
    terminal.script(&format!("{address}\n"));
    terminal.note("The address lets one browser in. Ctrl-C ends the app; studies that run go on.");
    terminal.finish()?;
    if !arguments.no_browser && open::that_detached(&address).is_err() {
        terminal.warning("no browser opens; open the address yourself");
    }
    app.serve()?;
    Ok(Outcome::Done)
}

/// The file of this program, and the words that come before those of a command: in a wheel an interpreter runs it.
fn program() -> Result<(PathBuf, Vec<String>), CliError> {
    let path = std::env::current_exe().map_err(|source| CliError::NoProgram { source })?;
    let is_interpreter = path.file_stem().is_some_and(|stem| stem.to_string_lossy().starts_with("python"));
    let before = if is_interpreter { vec!["-m".to_owned(), "dynoid".to_owned()] } else { Vec::new() };
    Ok((path, before))
}
