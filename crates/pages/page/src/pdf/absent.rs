//! Takes the place of [`super::pdf`] in a build without the feature `pdf`.

#[path = "options.rs"]
mod options;

use crate::model::Page;
pub use options::{Day, Paper, PdfError, PdfOptions};

/// Fails: this build makes no PDF.
///
/// # Errors
/// [`PdfError::LeftOut`].
pub fn pdf(_: &Page, _: &PdfOptions) -> Result<Vec<u8>, PdfError> {
    Err(PdfError::LeftOut)
}

/// Fails: this build has no fonts.
///
/// # Errors
/// [`PdfError::LeftOut`].
pub fn without_glyph(_: &Page) -> Result<String, PdfError> {
    Err(PdfError::LeftOut)
}
