//! Notes on data.

use crate::terminal::Terminal;

/// Something that should be known of data.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::commands::identify) enum Note {
    /// It was done to them.
    Done(String),
    /// It may be wrong with them.
    Warning(String),
}

impl Note {
    fn text(&self) -> &str {
        match self {
            Note::Done(text) | Note::Warning(text) => text,
        }
    }

    /// The same with something added to its text.
    pub(in crate::commands::identify) fn with(self, more: &str) -> Self {
        match self {
            Note::Done(text) => Note::Done(text + more),
            Note::Warning(text) => Note::Warning(text + more),
        }
    }

    pub(in crate::commands::identify) fn say(&self, terminal: &mut Terminal) {
        match self {
            Note::Done(text) => terminal.note(text),
            Note::Warning(text) => terminal.warning(text),
        }
    }
}

impl AsRef<str> for Note {
    fn as_ref(&self) -> &str {
        self.text()
    }
}

/// Says what was not said before.
pub(in crate::commands::identify) fn say(notes: &[Note], said: &mut Vec<Note>, terminal: &mut Terminal) {
    for note in notes {
        if !said.contains(note) {
            note.say(terminal);
            said.push(note.clone());
        }
    }
}
