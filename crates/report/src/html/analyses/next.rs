//! What to record next.

use bench::study::{NextError, NextExperiments};
use plot::markup::Markup;

use super::{plain_table, sentence, untold};
use crate::next as words;
use crate::wording;

/// The section on the next experiment.
pub(crate) fn next(found: &Result<NextExperiments, NextError>) -> Markup {
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
    let after: Vec<String> = best.iter().map(|candidate| format!("after {}", words::what(candidate))).collect();
    let headings: Vec<&str> = ["", "", "value", "now"].into_iter().chain(after.iter().map(String::as_str)).collect();
    let row = |row: words::Row| {
        let then = row.then.into_iter().map(|(words, _)| words);
        [row.symbol, row.name, row.value, row.now].into_iter().chain(then).collect::<Vec<String>>()
    };
    all.push(plain_table(&headings, words::rows(found).into_iter().map(row)));
    let useless: Vec<String> = found.candidates.iter().filter(|c| !c.is_worth_while()).map(words::what).collect();
    if !useless.is_empty() {
        all.push(sentence(&format!("Nothing is bought by {}", useless.join("; "))));
    }
    for assumption in &found.assumptions {
        all.push(sentence(&format!("Assumed: {}", wording::assumption(assumption))));
    }
    all
}
