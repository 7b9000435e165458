//! What the colour of a text says.

use serde::Serialize;

/// What a piece of text says by its colour, beside its words.
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
