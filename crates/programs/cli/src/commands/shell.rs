//! `dynoid shell`: completions and manual pages, from the command line as it is.

use clap::CommandFactory;
use clap_mangen::Man;
use dynoid::{Error, OutputFolder, paths};

use crate::cli::Cli;
use crate::cli::shell::{CompletionsArguments, ManualArguments};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// `dynoid shell completions`
pub(crate) fn completions(arguments: &CompletionsArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "dynoid", &mut script);
    terminal.script(&String::from_utf8_lossy(&script));
    Ok(Outcome::Done)
}

/// `dynoid shell manual`
pub(crate) fn manual(arguments: &ManualArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let folder = OutputFolder::check(&arguments.folder, &terminal.files())?;
    let mut command = Cli::command();
    command.build();
    let mut pages = Vec::new();
    collect(&command, &mut pages).map_err(|source| Error::write(&arguments.folder, source))?;
    let files: Vec<(&str, &[u8])> = pages.iter().map(|(name, page)| (name.as_str(), page.as_slice())).collect();
    let written = folder.write(&files)?;
    terminal.line(&format!("{} pages are in {}", written.len(), paths::with_slashes(&arguments.folder)));
    Ok(Outcome::Done)
}

/// The page of a command and those of the commands in it, by file name.
fn collect(command: &clap::Command, pages: &mut Vec<(String, Vec<u8>)>) -> std::io::Result<()> {
    let mut page = Vec::new();
    Man::new(command.clone()).render(&mut page)?;
    pages.push((format!("{}.1", command.get_display_name().unwrap_or(command.get_name())), page));
    command.get_subcommands().filter(|inner| inner.get_name() != "help").try_for_each(|inner| collect(inner, pages))
}
