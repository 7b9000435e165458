//! Notes on data.

/// Something that should be known of data.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Note {
    /// It was done to them.
    Done(String),
    /// It may be wrong with them.
    Warning(String),
}

impl Note {
    /// Its text.
    pub fn text(&self) -> &str {
        match self {
            Note::Done(text) | Note::Warning(text) => text,
        }
    }

    /// The same with something added to its text.
    #[must_use]
    pub fn with(self, more: &str) -> Self {
        match self {
            Note::Done(text) => Note::Done(text + more),
            Note::Warning(text) => Note::Warning(text + more),
        }
    }
}

impl AsRef<str> for Note {
    fn as_ref(&self) -> &str {
        self.text()
    }
}
