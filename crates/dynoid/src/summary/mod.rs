//! A study on the terminal, and where its report is.

mod short;
mod written;

use std::path::Path;

use page::{Align, Table, Tone};
use report::verdict::{Level, verdict};
use study::Study;

use crate::error::Outcome;
use crate::terminal::Terminal;

pub(crate) use short::{Short, short};
pub(crate) use written::Written;

/// How the command ends.
pub(crate) fn outcome(study: &Study) -> Outcome {
    match verdict(study).level {
        Level::Insufficient => Outcome::Insufficient,
        Level::Good | Level::Reservations => Outcome::Done,
    }
}

/// Prints a study.
pub(crate) fn print(written: &Written, terminal: &mut Terminal) {
    let study = &written.study;
    let used = study.recordings.iter().filter(|recording| !recording.used_for.is_empty()).count();
    terminal.line(&format!("{}: {} recordings, {used} used for estimates", study.bench.name, study.recordings.len()));
    terminal.gap();
    terminal.page(&report::brief::summary(study));
    print_places(written, terminal);
}

/// Prints what a study says about itself, without its numbers.
pub(crate) fn print_judgement(written: &Written, terminal: &mut Terminal) {
    terminal.page(&report::brief::judgement(&written.study));
    print_places(written, terminal);
}

fn print_places(written: &Written, terminal: &mut Terminal) {
    terminal.gap();
    let mut table = Table::new(&[("", Align::Left), ("", Align::Left)]);
    table.row(["report".into(), shown(&written.report).into()]);
    table.row(["data".into(), shown(&written.data).into()]);
    let optional = [("series", &written.series), ("model", &written.model)];
    for (what, path) in optional.into_iter().filter_map(|(what, path)| Some((what, path.as_ref()?))) {
        table.row([what.into(), shown(path).into()]);
    }
    terminal.heading("Written", Tone::Strong);
    terminal.table(&table);
}

/// A path from where the user is, if it lies below.
pub(crate) fn shown(path: &Path) -> String {
    let here = std::env::current_dir().ok();
    let short = here.and_then(|here| path.strip_prefix(here).ok().map(Path::to_owned));
    short.unwrap_or_else(|| path.to_owned()).display().to_string()
}
