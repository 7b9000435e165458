//! `dynoid experiment next`: what each further experiment would buy.

use std::path::Path;

use dynoid::{Error, paths};
use report::next::{best, command};
use study::{NextError, NextExperiments, NextOptions, Prepared, next_experiments};

use crate::cli::experiment::NextArguments;
use crate::commands::bench_model::MODEL;
use crate::commands::study::{no_study, read_bench, read_recordings};
use crate::error::{CliError, Outcome};
use crate::summary::shown;
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &NextArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let (file, _) = read_bench(&arguments.bench, &terminal.files())?;
    let step = terminal.work().step("looking for the next experiment", 3);
    let recordings = match read_recordings(&arguments.bench, &file, &step, &terminal.files()) {
        Err(CliError::Door { source: none @ (Error::NothingMatches { .. } | Error::NoRecordingsListed { .. }) }) => {
            terminal.note(&format!("{none}; what follows is for a bench without recordings"));
            Prepared::default()
        }
        read => read?,
    };
    let options = NextOptions {
        speed_rpm: arguments.speed,
        duration_s: arguments.duration,
        enough: arguments.enough / 100.0,
        seed: arguments.seed,
    };
    let found = next_experiments(&file, recordings, options, &step);
    drop(step);
    let found = found.map_err(|error| refused(&arguments.bench, error))?;
    if arguments.json {
        terminal.json(&found)?;
    } else if !terminal.is_quiet() {
        print(&found, arguments, terminal);
    }
    Ok(Outcome::Done)
}

fn refused(bench: &Path, error: NextError) -> CliError {
    match error {
        NextError::Study(error) => no_study(bench, error),
        NextError::VirtualBench(source) => CliError::VirtualBench { path: bench.to_owned(), source },
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
