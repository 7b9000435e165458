//! Abilities of a terminal: its width, its colours, and text without codes of its own.

use unicode_width::UnicodeWidthChar;

use crate::tone::Tone;

/// How wide lines are, and whether colour is welcome.
#[derive(Debug, Clone, Copy)]
pub struct Screen {
    /// Columns of a line.
    pub width: usize,
    /// True if escape codes for colour may be used.
    pub colour: bool,
    /// True if tables must fit. Where nobody looks, as in a pipe, only their last column is broken into lines.
    pub is_narrow: bool,
}

impl Tone {
    /// The text with the terminal's codes around it.
    pub fn paint(self, text: &str) -> String {
        let code = match self {
            _ if text.is_empty() => return String::new(),
            Tone::Plain => return text.to_owned(),
            Tone::Strong => "1",
            Tone::Faint => "2",
            Tone::Good => "32",
            Tone::Caution => "33",
            Tone::Bad => "31",
        };
        format!("\u{1b}[{code}m{text}\u{1b}[0m")
    }
}

impl Screen {
    pub(super) fn painted(self, tone: Tone, text: &str) -> String {
        if self.colour { tone.paint(text) } else { text.to_owned() }
    }
}

/// A text from outside made safe for a terminal: no control characters, and so no escape codes.
pub fn safe(text: &str) -> String {
    text.chars().map(|c| if c.is_control() || (c.width() == Some(0) && is_direction(c)) { ' ' } else { c }).collect()
}

/// Characters that turn the direction of what follows.
fn is_direction(c: char) -> bool {
    matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}
