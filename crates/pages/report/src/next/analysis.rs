//! Experiments to record next.

use page::{Block, Blocks, Cell, Prose, Table, Tone};
use rig::results::Outcome;
use study::{Candidate, NextExperiments};

use super::words::{self, Choice};
use crate::blocks::{no_result, sentence};
use crate::wording::{self, number};

/// The section on the next experiment.
pub(crate) fn analysis(found: &Outcome<NextExperiments>) -> Blocks {
    let found = match found.as_ref() {
        Ok(found) => found,
        Err(why) => return no_result("What to record next cannot be said", &wording::reasons(why)),
    };
    analysis_of(found)
}

/// Gain from each further experiment, the best first.
pub(crate) fn analysis_of(found: &NextExperiments) -> Blocks {
    let mut all = sentence(&words::recommendation(found));
    all.push(sentence(
        "Each experiment was simulated on a virtual bench like this one, and studied together with the present \
         recordings. The table shows half a 95 % interval, as a part of the value, now and after the experiment",
    ));
    all.push(widths(found));
    let choices = words::choices(found);
    let (worth_while, useless): (Vec<&Choice<'_>>, Vec<&Choice<'_>>) =
        choices.iter().partition(|choice| choice.candidate.is_worth_while());
    all.push(Block::List { items: worth_while.into_iter().map(|choice| in_words(choice).into()).collect() });
    if !useless.is_empty() {
        all.push(sentence("As long and at the same speed, these gain nothing:"));
        all.push(Block::List { items: useless.into_iter().map(|choice| in_words(choice).into()).collect() });
    }
    for assumption in &found.assumptions {
        all.push(sentence(&format!("Assumed: {}", wording::assumption(assumption))));
    }
    all
}

/// How wide the intervals are, now and after the best.
fn widths(found: &NextExperiments) -> Blocks {
    let best = words::best(found);
    let after: Vec<String> = best.iter().map(|choice| format!("After {}", words::what(choice.candidate))).collect();
    let headings: Vec<&str> =
        ["", "Parameter", "Value", "Now"].into_iter().chain(after.iter().map(String::as_str)).collect();
    let then =
        |(words, is_better): &(String, bool)| Cell::toned(words, if *is_better { Tone::Good } else { Tone::Faint });
    let row = |row: words::Row| -> Vec<Cell> {
        let own = [
            Prose::symbol(row.quantity.symbol()).into(),
            Cell::from(row.quantity.name()),
            Cell::from(&row.value),
            Cell::from(&row.now),
        ];
        own.into_iter().chain(row.then.iter().map(then)).collect()
    };
    let table = Table::of_text(&headings).with_rows(words::rows(found).into_iter().map(row));
    if table.is_empty() { Blocks::default() } else { table.into() }
}

fn in_words(choice: &Choice<'_>) -> String {
    let candidate = choice.candidate;
    let peak = |candidate: &Candidate| number::measure(candidate.peak_shaft_torque_nm, "Nm");
    let gains = if candidate.is_worth_while() { "" } else { "; gains nothing" };
    let other = choice.other.map(|other| format!("; {}, T_shaft up to {}", words::instead(other), peak(other)));
    format!("{}, T_shaft up to {}{gains}{}", words::what(candidate), peak(candidate), other.unwrap_or_default())
}
