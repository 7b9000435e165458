//! `dynoid experiment next`: what each further experiment would buy.

use std::path::Path;

use dynoid::{Bench, Error, MODEL, Session, paths};
use report::next::{best, command};
use study::{NextError, NextExperiments, NextOptions};

use crate::cli::experiment::NextArguments;
use crate::error::{CliError, Outcome};
use crate::path::shown;
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &NextArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let files = terminal.files();
    let bench = Bench::load(&arguments.bench, &files)?;
    let step = terminal.work().step("looking for the next experiment", 3);
    let session = match Session::open(bench.clone(), &files, &step) {
        Err(none @ (Error::NothingMatches { .. } | Error::NoRecordingsListed { .. })) => {
            terminal.note(&format!("{none}; what follows is for a bench without recordings"));
            Session::without_recordings(bench)
        }
        read => read?,
    };
    let options = NextOptions {
        speed_rpm: arguments.speed,
        duration_s: arguments.duration,
        enough: arguments.enough / 100.0,
        seed: arguments.seed,
    };
    let found = session.next(options, &step);
    drop(step);
    let found = found.map_err(|error| match error {
        Error::Next { path, source } => refused(&path, source),
        other => other.into(),
    })?;
    if arguments.json {
        terminal.json(&found)?;
    } else if !terminal.is_quiet() {
        print(&found, arguments, terminal);
    }
    Ok(Outcome::Done)
}

fn refused(bench: &Path, error: NextError) -> CliError {
    match error {
        NextError::Study(error) => Error::of_study(bench, error).into(),
        NextError::VirtualBench(source) => Error::VirtualBench { path: bench.to_owned(), source }.into(),
        NextError::TooShort { .. } => CliError::Usage { what: format!("--duration: {error}") },
        NextError::UnknownShaft => CliError::Usage {
            what: format!(
                "{}: {error}; record BS_T_NT first, or add [shaft] with resonance = \"18 Hz\" to the bench file",
                bench.display()
            ),
        },
    }
}

fn print(found: &NextExperiments, arguments: &NextArguments, terminal: &mut Terminal) {
    terminal.page(&report::pages::next(found));
    if let Some(first) = best(found).first() {
        let study = paths::folder_of(&arguments.bench).join("study").join(MODEL);
        let study = study.is_file().then(|| shown(&study).to_string());
        let command = command(first.candidate, &shown(&arguments.bench).to_string(), study.as_deref());
        terminal.line(&format!("its demands: {command}"));
    }
}
