//! The formats, by their first bytes.

use crate::{RecordingError, Source, arrow, csv, mat, mdf, source};

/// Bytes at the beginning of a file that show its format.
const HEAD: u64 = 1 << 12;

/// The reader that content calls for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Mdf,
    Csv,
    Mat,
    Table(arrow::Kind),
}

impl Kind {
    pub(crate) fn detect(name: &str, source: &dyn Source) -> Result<Self, RecordingError> {
        let bytes = source::bytes(name, source, 0, HEAD)?;
        let bytes = bytes.as_slice();
        if bytes.is_empty() {
            return Err(RecordingError::Empty { file: name.into() });
        }
        if mdf::is_mdf(bytes) {
            return Ok(Self::Mdf);
        }
        if mat::is_mat(bytes) {
            return Ok(Self::Mat);
        }
        if let Some(kind) = arrow::Kind::detect(bytes) {
            return Ok(Self::Table(kind));
        }
        if csv::is_text(bytes) {
            return Ok(Self::Csv);
        }
        Err(RecordingError::UnknownFormat {
            file: name.into(),
            start: bytes[..bytes.len().min(8)].escape_ascii().to_string(),
        })
    }
}
