//! Pieces of pages. Names of channels, models and files are no symbols, and are shown as they are.

use page::{Block, Cell, Finding, Prose, Tone};

/// A line of its own.
pub(crate) fn line(text: impl Into<String>) -> Block {
    Block::paragraph(Prose::verbatim(text))
}

/// A heading.
pub(crate) fn heading(text: impl Into<String>) -> Block {
    Block::heading(Prose::verbatim(text))
}

/// Something found, after a word of how grave it is.
pub(crate) fn finding(tone: Tone, severity: &str, text: &str) -> Block {
    Block::Finding(Finding::new(tone, severity, Prose::verbatim(text)))
}

/// A cell with a name.
pub(crate) fn name(text: &str) -> Cell {
    Prose::verbatim(text).into()
}
