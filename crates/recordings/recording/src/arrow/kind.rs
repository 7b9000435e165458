//! The formats, by their first bytes.

/// A format of tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Parquet,
    /// A file of Arrow, which is Feather version 2.
    File,
    /// A stream of Arrow.
    Stream,
}

impl Kind {
    pub(crate) fn detect(bytes: &[u8]) -> Option<Self> {
        match bytes {
            _ if bytes.starts_with(b"PAR1") => Some(Self::Parquet),
            _ if bytes.starts_with(b"ARROW1") => Some(Self::File),
            // The mark of a message and the length of the schema.
            [0xFF, 0xFF, 0xFF, 0xFF, _, _, _, 0, ..] => Some(Self::Stream),
            _ => None,
        }
    }
}
