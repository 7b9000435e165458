//! Meaning of the colour of a text.

use serde::Serialize;

/// Meaning of a piece of text by its colour, beside its words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Tone {
    /// Nothing.
    #[default]
    Plain,
    /// To be seen first.
    Strong,
    /// To be read last.
    Faint,
    /// In order.
    Good,
    /// To be checked.
    Caution,
    /// Wrong, or to be avoided.
    Bad,
}
