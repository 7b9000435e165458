//! A study on the terminal, and where its report is.

use dynoid::{EarlierStudy, WrittenStudy};
use page::{Align, Block, Page, Table};
use study::verdict::Level;
use study::{Study, verdict};

use crate::error::Outcome;
use crate::path::shown;

/// How the command ends.
pub(crate) fn outcome(study: &Study) -> Outcome {
    match verdict(study).level {
        Level::Insufficient => Outcome::Insufficient,
        Level::Good | Level::Reservations => Outcome::Done,
    }
}

/// A study on a screen, and where its files are.
pub(crate) fn page(written: &WrittenStudy) -> Page {
    let since = |earlier: &EarlierStudy| report::comparison::since(&earlier.date, earlier.comparison.as_ref());
    let mut page = report::brief::summary(&written.study, written.earlier.as_ref().map(since));
    page.blocks.extend(places(written));
    page
}

/// Judgement of a study without its numbers, and the places of its files.
pub(crate) fn judgement(written: &WrittenStudy) -> Vec<Block> {
    let mut blocks = report::brief::judgement(&written.study).blocks;
    blocks.extend(places(written));
    blocks
}

fn places(written: &WrittenStudy) -> [Block; 2] {
    let mut table = Table::new(&[("", Align::Left), ("", Align::Left)]);
    table.row(["report".into(), shown(&written.report).into()]);
    if let Some(path) = &written.full_report {
        table.row(["all analyses".into(), shown(path).into()]);
    }
    for path in &written.paper {
        table.row(["for paper".into(), shown(path).into()]);
    }
    table.row(["data".into(), shown(&written.data).into()]);
    for path in &written.of_earlier {
        table.row(["earlier".into(), format!("{}, of an earlier study", shown(path)).into()]);
    }
    let optional = [("series", &written.series), ("model", &written.model)];
    for (what, path) in optional.into_iter().filter_map(|(what, path)| Some((what, path.as_ref()?))) {
        table.row([what.into(), shown(path).into()]);
    }
    [Block::heading("Written"), Block::Table(table)]
}
