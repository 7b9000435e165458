//! What the analyses of the parts add to the report: the figures of their own pages, and the words that the command line has.

mod controller;
mod engine;
mod friction;
mod inverter;
mod lines;
mod recorded;
mod shaft;
mod torque;

pub(crate) use controller::{controller, feed_forward};
pub(crate) use engine::engine;
pub(crate) use friction::friction;
pub(crate) use inverter::inverter;
pub(crate) use lines::lines;
pub(crate) use recorded::{courses, step};
pub(crate) use shaft::shaft;
pub(crate) use torque::torque;

use bench::study::Parameter;
use plot::Figure;
use plot::markup;
use plot::markup::Markup;

use super::parts::{parameter_rows, table};
use super::plots::figure;
use super::typeset::prose;
use crate::wording::capitalised;

/// Figures, one below the other.
fn figures(all: &[Figure]) -> Markup {
    all.iter().map(figure).collect()
}

/// A sentence that may begin in small letters and end without a full stop, as the command line has them.
fn sentence(text: &str) -> Markup {
    let stop = if text.ends_with(['.', '!', '?']) { "" } else { "." };
    markup!("<p>{}</p>\n", prose(&(capitalised(text) + stop)))
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

/// A table of plain text.
fn plain_table(heads: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Markup {
    table("numbers", heads, rows.into_iter().map(|cells| cells.iter().map(|cell| prose(cell)).collect()))
}

fn parameters<'a>(all: impl IntoIterator<Item = &'a Parameter>) -> Markup {
    parameter_rows(&all.into_iter().collect::<Vec<_>>())
}
