//! What the analyses of the parts add to the report: the figures of their own pages, and the words that the command line has.

mod controller;
mod engine;
mod friction;
mod inverter;
mod lines;
mod next;
mod recorded;
mod shaft;
mod torque;

pub(crate) use controller::{controller, feed_forward};
pub(crate) use engine::engine;
pub(crate) use friction::friction;
pub(crate) use inverter::inverter;
pub(crate) use lines::lines;
pub(crate) use next::next;
pub(crate) use recorded::{courses, step};
pub(crate) use shaft::shaft;
pub(crate) use torque::torque;

use bench::study::Parameter;
use page::markup;
use page::markup::Markup;
use page::{Figure, Panel};

use super::parts::{parameter_rows, table};
use super::plots::figure;
use super::typeset::prose;
use crate::wording::capitalised;

/// Characters of a cell that stays on one line.
const UNBROKEN: usize = 22;
/// Height of the panels of a figure that fits a printed page, and room between two, CSS pixels.
const PAGE: u32 = 780;
const BETWEEN_PANELS: u32 = 36;

/// Figures, one below the other; what is taller than a page is cut between panels.
fn figures(all: Vec<Figure>) -> Markup {
    all.into_iter().flat_map(pages).map(|one| figure(&one)).collect()
}

/// A figure in pieces of alike height that fit a page, the caption below the last.
fn pages(whole: Figure) -> Vec<Figure> {
    let Figure { title, caption, x, mut panels, equal_axes, symbols } = whole;
    let height: u32 = panels.iter().map(|panel| panel.height + BETWEEN_PANELS).sum();
    let count = panels.len().div_ceil(height.div_ceil(PAGE).max(1) as usize).max(1);
    let mut pieces: Vec<Vec<Panel>> = Vec::new();
    while !panels.is_empty() {
        let rest = panels.split_off(count.min(panels.len()));
        pieces.push(std::mem::replace(&mut panels, rest));
    }
    let last = pieces.len();
    let piece = |(n, panels): (usize, Vec<Panel>)| Figure {
        title: if n == 0 { title.clone() } else { format!("{title}, continued") },
        caption: if n + 1 == last { caption.clone() } else { String::new() },
        x: x.clone(),
        panels,
        equal_axes,
        symbols,
    };
    pieces.into_iter().enumerate().map(piece).collect()
}

/// A sentence that may begin in small letters and end without a stop, as the command line has them.
fn sentence(text: &str) -> Markup {
    let stop = if text.ends_with(['.', ':']) { "" } else { "." };
    // A file's name begins as it does.
    let names_file = text.split(' ').next().is_some_and(|word| word.contains(['/', '.']));
    let text = if names_file { text.to_owned() } else { capitalised(text) };
    markup!("<p>{}</p>\n", prose(&(text + stop)))
}

/// A heading below that of the section.
fn heading(text: &str) -> Markup {
    markup!("<h3>{}</h3>\n", prose(text))
}

/// A heading that names a recording.
fn of_recording(file: &str, label: &str) -> Markup {
    markup!("<h3>{} <span class=\"file\">{}</span></h3>\n", label, file)
}

/// What stands in place of an analysis that a recording, or the whole campaign, does not allow.
fn untold(what: &str, why: &str) -> Markup {
    markup!("<p class=\"note\">{}</p>\n", prose(&format!("{what}: {}.", why.trim_end_matches('.'))))
}

/// A table of plain text; what is short does not break across lines.
fn plain_table(heads: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Markup {
    let cell = |text: &String| match text.chars().count() <= UNBROKEN {
        true => markup!("<span class=\"n\">{}</span>", prose(text)),
        false => prose(text),
    };
    table("numbers", heads, rows.into_iter().map(|cells| cells.iter().map(cell).collect()))
}

fn parameters<'a>(all: impl IntoIterator<Item = &'a Parameter>) -> Markup {
    parameter_rows(&all.into_iter().collect::<Vec<_>>())
}
