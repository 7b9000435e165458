//! Notes on data.

/// Something that should be known of data.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Note {
    /// It was done to them.
    Done(String),
    /// It may be wrong with them.
    Warning(String),
    /// A model is not stable, so that its simulation on them shows nothing; its predictions can be compared.
    RunsAway(String),
}

impl Note {
    /// Its text.
    pub fn text(&self) -> &str {
        match self {
            Note::Done(text) | Note::Warning(text) | Note::RunsAway(text) => text,
        }
    }

    /// The same with something added to its text.
    #[must_use]
    pub fn with(self, more: &str) -> Self {
        match self {
            Note::Done(text) => Note::Done(text + more),
            Note::Warning(text) => Note::Warning(text + more),
            Note::RunsAway(text) => Note::RunsAway(text + more),
        }
    }
}

impl AsRef<str> for Note {
    fn as_ref(&self) -> &str {
        self.text()
    }
}
