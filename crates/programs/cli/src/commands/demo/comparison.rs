//! The estimates of the demo beside the truth, as a table and as JSON.

use std::path::Path;

use demo::comparison::Row;
use dynoid::WrittenStudy;
use dynoid::facts::WrittenFacts;
use page::{Align, Cell, Table, Tone};
use report::wording::number;
use serde::Serialize;

/// The rows as a table.
pub(super) fn table(rows: &[Row]) -> Table {
    let headings = ["", "", "estimated", "95 % interval", "true value", "inside"];
    let mut table = Table::new(&headings.map(|heading| (heading, Align::Left)));
    for row in rows {
        let (estimated, interval) = match row.estimate {
            Some(parameter) => (number::parameter(parameter), number::interval(parameter)),
            None => ("not estimated".to_owned(), String::new()),
        };
        table.row([
            row.quantity.into(),
            row.symbol.into(),
            estimated.into(),
            interval.into(),
            number::significant_with_unit(row.truth, 5, row.unit).into(),
            match row.contains_truth {
                Some(true) => Cell::toned("yes", Tone::Good),
                Some(false) => Cell::toned("NO", Tone::Bad),
                None => Cell::from("–"),
            },
        ]);
    }
    table
}

/// Remark on the table.
pub(super) fn remark(rows: &[Row]) -> String {
    let judged = rows.iter().filter(|row| row.contains_truth.is_some()).count();
    let inside = rows.iter().filter(|row| row.contains_truth == Some(true)).count();
    format!(
        "{inside} of {judged} intervals contain the true value. Of 95 % intervals, one in twenty may miss it; try other \
         seeds with --seed."
    )
}

/// The demo as JSON.
#[derive(Serialize)]
pub(super) struct Document<'a> {
    seed: u64,
    bench_file: &'a Path,
    comparison: &'a [Row],
    study: WrittenFacts<'a>,
}

impl<'a> Document<'a> {
    pub(super) fn new(seed: u64, written: &'a WrittenStudy, bench_file: &'a Path, rows: &'a [Row]) -> Self {
        Document { seed, bench_file, comparison: rows, study: WrittenFacts::of(written) }
    }
}
