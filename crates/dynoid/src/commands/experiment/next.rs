//! `dynoid experiment next`: what each further experiment would buy.

use std::path::Path;

use bench::study::{NextError, NextExperiments, NextOptions, next_experiments};
use page::{Align, Cell, Table, Tone};
use report::next::{Choice, best, choices, command, instead, recommendation, rows, what};
use report::wording::{self, number};

use crate::cli::experiment::NextArguments;
use crate::commands::study::{no_study, read_bench, read_sources, show};
use crate::error::{CliError, Outcome};
use crate::input;
use crate::summary::shown;
use crate::terminal::Terminal;

/// Parts that are estimated: steps of the progress display.
const PARTS: u64 = 5;

pub(crate) fn run(arguments: &NextArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let (file, _) = read_bench(&arguments.bench)?;
    let sources = match read_sources(&arguments.bench, &file, terminal) {
        Err(none @ (CliError::NothingMatches { .. } | CliError::NoRecordingsListed { .. })) => {
            terminal.note(&format!("{none}; what follows is for a bench without recordings"));
            Vec::new()
        }
        read => read?,
    };
    let progress = terminal.progress(sources.len() as u64 + PARTS);
    let trying = terminal.long("trying experiments on a bench like this one");
    let options = NextOptions {
        speed_rpm: arguments.speed,
        duration_s: arguments.duration,
        enough: arguments.enough / 100.0,
        seed: arguments.seed,
    };
    let found = {
        let (mut show, told) = (|step| show(&progress, &step), |done, all| trying.told(done, all));
        next_experiments(&file, sources, options, &mut show, &told)
    };
    drop((progress, trying));
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
    terminal.heading("What to record next", Tone::Strong);
    terminal.paragraph(&recommendation(found));
    terminal.gap();
    let widths = widths(found);
    if !widths.is_empty() {
        terminal.table(&widths);
        terminal.gap();
    }
    let compared = best(found).len();
    for (place, choice) in choices(found).iter().enumerate() {
        let mark = if place < compared { format!("{}", place + 1) } else { "–".to_owned() };
        let style = if choice.candidate.is_worth_while() { Tone::Good } else { Tone::Faint };
        terminal.item((&mark, style), &in_words(choice));
    }
    terminal.gap();
    for assumption in &found.assumptions {
        terminal.item(("assumed:", Tone::Caution), &wording::assumption(assumption));
    }
    if let Some(first) = best(found).first() {
        let study = input::folder_of(&arguments.bench).join("study").join("study.json");
        let study = study.is_file().then(|| shown(&study).to_string());
        let command = command(first.candidate, &shown(&arguments.bench).to_string(), study.as_deref());
        terminal.line(&format!("its demands: {command}"));
    }
}

/// How wide the intervals are, now and after the best.
fn widths(found: &NextExperiments) -> Table {
    let headings = [
        ("", Align::Left),
        ("95 % interval of", Align::Left),
        ("value", Align::Right),
        ("now", Align::Right),
        ("after 1", Align::Right),
        ("after 2", Align::Right),
        ("after 3", Align::Right),
    ];
    let mut table = Table::new(&headings[..4 + best(found).len()]);
    for row in rows(found) {
        let then = row
            .then
            .into_iter()
            .map(|(words, is_better)| Cell::toned(words, if is_better { Tone::Good } else { Tone::Faint }));
        let cells = [row.symbol.into(), row.name.into(), row.value.into(), row.now.into()];
        table.row(cells.into_iter().chain(then).collect::<Vec<Cell>>());
    }
    table
}

fn in_words(choice: &Choice<'_>) -> String {
    let candidate = choice.candidate;
    let peak = number::measure(candidate.peak_shaft_torque_nm, "Nm");
    let buys = match candidate.is_worth_while() {
        true => "",
        false => "; buys nothing",
    };
    let other = match choice.other {
        Some(other) => {
            let peak = number::measure(other.peak_shaft_torque_nm, "Nm");
            format!("; {}, T_shaft up to {peak}", instead(other))
        }
        None => String::new(),
    };
    format!("{}, T_shaft up to {peak}{buys}{other}", what(candidate))
}
