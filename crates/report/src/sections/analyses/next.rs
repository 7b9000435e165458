//! What to record next.

use bench::study::{NextError, NextExperiments};
use page::{Blocks, Cell, Prose, Table};

use super::{sentence, untold};
use crate::next as words;
use crate::wording;

/// The section on the next experiment.
pub(crate) fn next(found: &Result<NextExperiments, NextError>) -> Blocks {
    let found = match found {
        Ok(found) => found,
        Err(why) => return untold("What to record next cannot be said", &why.to_string()),
    };
    let mut all = sentence(&words::recommendation(found));
    all.push(sentence(
        "Each experiment was run on a virtual bench as this one is known to be, and studied beside the recordings there are: \
         half a 95 % interval, as a part of the value, now and after it",
    ));
    let best = words::best(found);
    let after: Vec<String> = best.iter().map(|choice| format!("After {}", words::what(choice.candidate))).collect();
    let headings: Vec<&str> =
        ["", "Parameter", "Value", "Now"].into_iter().chain(after.iter().map(String::as_str)).collect();
    let row = |row: words::Row| -> Vec<Cell> {
        let own =
            [Prose::symbol(&row.symbol).into(), Cell::from(&row.name), Cell::from(&row.value), Cell::from(&row.now)];
        own.into_iter().chain(row.then.iter().map(|(words, _)| Cell::from(words))).collect()
    };
    all.push(Table::of_text(&headings).with_rows(words::rows(found).into_iter().map(row)));
    let choices = words::choices(found);
    let useless: Vec<&str> =
        choices.iter().map(|c| c.candidate).filter(|c| !c.is_worth_while()).map(|c| c.label.as_str()).collect();
    if !useless.is_empty() {
        all.push(sentence(&format!("As long and at the same speed, nothing is bought by {}", useless.join(", "))));
    }
    for assumption in &found.assumptions {
        all.push(sentence(&format!("Assumed: {}", wording::assumption(assumption))));
    }
    all
}
