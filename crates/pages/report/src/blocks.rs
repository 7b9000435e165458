//! Blocks that the analyses of all parts share.

use page::{Block, Blocks, Cell, Figure, Panel, Prose, Table};
use rig::ExperimentLabel;
use rig::results::Parameter;

use crate::estimates::parameter_table;
use crate::wording::capitalised;

/// Height of the panels of a figure that fits a printed page, and room between two, CSS pixels.
const PAGE: u32 = 780;
const BETWEEN_PANELS: u32 = 36;

/// Figures, one below the other; what is taller than a page is cut between panels.
pub(crate) fn figures(all: Vec<Figure>) -> Blocks {
    all.into_iter().flat_map(pages).collect()
}

/// A figure in pieces of alike height that fit a page, the caption below the last.
fn pages(whole: Figure) -> Vec<Figure> {
    let Figure { title, caption, x, mut panels, equal_axes, recording, symbols } = whole;
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
        recording: recording.clone(),
        symbols,
    };
    pieces.into_iter().enumerate().map(piece).collect()
}

/// A sentence that may begin in small letters and end without a stop.
pub(crate) fn sentence(text: &str) -> Blocks {
    let stop = if text.ends_with(['.', ':']) { "" } else { "." };
    Block::paragraph(capitalised(text) + stop).into()
}

/// A heading below that of the section.
pub(crate) fn heading(text: &str) -> Blocks {
    Block::heading(text).into()
}

/// A heading that names a recording.
pub(crate) fn of_recording(file: &str, label: &ExperimentLabel) -> Blocks {
    Block::heading(Prose::verbatim(label.to_string()).then(" ").then(Prose::code(file))).into()
}

/// The note in place of an analysis that a recording, or the whole campaign, does not allow.
pub(crate) fn no_result(what: &str, why: &str) -> Blocks {
    Block::note(format!("{what}: {}.", why.trim_end_matches('.'))).into()
}

/// A table of text.
pub(crate) fn plain_table(heads: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Blocks {
    let cells = |row: Vec<String>| row.iter().map(Cell::from).collect();
    Table::of_text(heads).with_rows(rows.into_iter().map(cells)).into()
}

/// A table of parameters.
pub(crate) fn parameters<'a>(all: impl IntoIterator<Item = &'a Parameter>) -> Blocks {
    parameter_table(all).into()
}
