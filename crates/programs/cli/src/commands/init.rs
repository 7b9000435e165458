//! `dynoid init`: from recordings to a proposed bench file.

use std::path::Path;

use dynoid::{Error, Files, Mark, Proposal, check_replaceable};

use crate::cli::bench::InitArguments;
use crate::error::{CliError, Outcome};
use crate::path::shown;
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &InitArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let (out, files) = (&arguments.out, terminal.files());
    if out.is_dir() {
        return Err(Error::InTheWay { path: out.clone(), what: "a folder" }.into());
    }
    let replaced = check_place(out, arguments.force || arguments.update, &files)?;
    let found = Proposal::of(&arguments.recordings, out, arguments.update, &files, terminal.work());
    let unreadable = match &found {
        Ok(proposal) => proposal.unreadable(),
        Err(Error::NoneReadable { reasons }) => reasons,
        Err(_) => &[],
    };
    unreadable.iter().for_each(|reason| terminal.warning(reason));
    let proposal = found?;
    proposal.write(replaced.as_ref(), &files)?;
    if arguments.json {
        terminal.json(&proposal.facts())?;
    } else if !terminal.is_quiet() {
        terminal.page(&proposal.page(&shown(out)));
    }
    Ok(if proposal.unreadable().is_empty() { Outcome::Done } else { Outcome::SomeUnreadable })
}

/// The mark of the bench file that is replaced, if there is one; any other file is refused, and without --force a bench
/// file too.
fn check_place(out: &Path, force: bool, files: &Files) -> Result<Option<Mark>, CliError> {
    if !out.is_file() {
        return Ok(None);
    }
    match dynoid::is_bench_file(out) {
        true if force => Ok(Mark::of_file(out)),
        true => Err(CliError::BenchFileExists { path: out.to_owned() }),
        false if files.overwrites() => Ok(check_replaceable(out, None, files).map(|()| None)?),
        false => Err(CliError::NotABenchFile { path: out.to_owned() }),
    }
}
