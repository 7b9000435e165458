//! A document from its text.

use super::{BenchModelDocument, DocumentError, Header, JsonFault, VERSION, check, from_json};

impl BenchModelDocument {
    /// The document that a text holds.
    ///
    /// # Errors
    /// Text of another kind or of a later version; a model that no bench can have, or contradictions in it.
    pub fn from_json(text: &str) -> Result<Self, DocumentError> {
        let content = |fault: JsonFault| DocumentError::Content { fault };
        // First of all what it is: a later version may have another layout.
        let header: Header = from_json(text).map_err(content)?;
        if !Self::is_format(&header.format) {
            return Err(DocumentError::Format { found: header.format });
        }
        if header.version == 0 || header.version > VERSION {
            return Err(DocumentError::Version { found: header.version, known: VERSION });
        }
        let document: BenchModelDocument = from_json(text).map_err(content)?;
        check::all(&document)?;
        Ok(document)
    }
}
