//! A file for another program.

/// A file by its name, without a folder, and its content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExportedFile {
    /// Name with ending.
    pub name: String,
    /// Content.
    pub content: Vec<u8>,
}

impl ExportedFile {
    /// A file of text.
    #[must_use]
    pub fn text(name: impl Into<String>, text: String) -> Self {
        ExportedFile { name: name.into(), content: text.into_bytes() }
    }
}
