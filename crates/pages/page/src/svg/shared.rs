//! Elements that all pieces of a drawing share: where a panel is, colours, texts and lines.

use std::fmt::Write as _;

use super::scale::Mapping;
use crate::figure::{Axis, Scale};
use crate::markup::escape;
use crate::prose::{Inline, Prose};

/// DejaVu Sans is about 0.6 em wide.
pub(super) const WIDE: f64 = 7.3;

pub(super) const INK: &str = "#1d232a";
pub(super) const SOFT: &str = "#56616d";
pub(super) const LINE: &str = "#dce1e6";
pub(super) const REGION: &str = "#0b5fa5";

/// Where a panel is drawn.
pub(super) struct Frame {
    pub(super) x: Mapping,
    pub(super) y: Mapping,
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
    /// True if the drawing is in a page, whose style sheet keeps strokes as wide as they are where a path is scaled.
    pub(super) in_page: bool,
}

/// Text with indices: `T_d` is set with its d below.
pub(super) fn text(out: &mut String, (x, y): (f64, f64), anchor: &str, attributes: &str, content: &str) {
    let space = if attributes.is_empty() { "" } else { " " };
    let _ = write!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\"{space}{attributes}>");
    let pieces = symbol_pieces(content);
    if let [(piece, false)] = pieces.as_slice() {
        let _ = writeln!(out, "{}</text>", escape(piece));
        return;
    }
    let mut below = false;
    for (piece, is_index) in pieces {
        let shift = match (below, is_index) {
            (false, true) => " dy=\"3\"",
            (true, false) => " dy=\"-3\"",
            _ => "",
        };
        let size = if is_index { " font-size=\"9\"" } else { "" };
        let _ = write!(out, "<tspan{shift}{size}>{}</tspan>", escape(&piece));
        below = is_index;
    }
    out.push_str("</text>\n");
}

/// Splits text into pieces, each with whether it is an index.
fn symbol_pieces(text: &str) -> Vec<(String, bool)> {
    let mut pieces: Vec<(String, bool)> = Vec::new();
    for inline in Prose::from(text).0 {
        let more = match &inline {
            Inline::Symbol(symbol) => {
                symbol.pieces().into_iter().map(|(piece, below)| (piece.to_owned(), below)).collect()
            }
            other => vec![(Prose(vec![other.clone()]).plain(), false)],
        };
        for (piece, below) in more {
            match pieces.last_mut() {
                Some((last, false)) if !below => last.push_str(&piece),
                _ => pieces.push((piece, below)),
            }
        }
    }
    pieces
}

pub(super) fn line(out: &mut String, from: (f64, f64), to: (f64, f64), colour: &str, attributes: &str) {
    let _ = writeln!(
        out,
        "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"{colour}\" {attributes}/>",
        from.0, from.1, to.0, to.1
    );
}

/// Returns true if values of an axis have to be positive.
pub(super) fn is_log(axis: &Axis) -> bool {
    matches!(axis.scale, Scale::Log)
}
