//! A figure as pixels.

#[cfg(feature = "pdf")]
use resvg::{tiny_skia, usvg};

use crate::figure::Figure;

/// Why a figure cannot be drawn to pixels.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// The drawing is no valid SVG, or empty.
    #[error("the figure cannot be drawn")]
    Drawing,
    /// The pixels cannot be encoded.
    #[error("the picture cannot be encoded: {0}")]
    Encoding(String),
    /// The feature `pdf` is off.
    #[error("this build of dynoid draws no pixels; build it with the feature `pdf`, or write .svg")]
    LeftOut,
}

/// Pixels per CSS pixel: sharp in a document.
#[cfg(feature = "pdf")]
const SCALE: f32 = 2.0;

/// The figures below each other as a PNG.
///
/// # Errors
/// [`PngError`] where the picture is too large for memory, or the feature `pdf` is off.
#[cfg(feature = "pdf")]
pub fn png<'a>(figures: impl IntoIterator<Item = &'a Figure>) -> Result<Vec<u8>, PngError> {
    let tree = usvg::Tree::from_str(&crate::svg(figures), &crate::drawing::options()).map_err(|_| PngError::Drawing)?;
    let size = tree.size().to_int_size().scale_by(SCALE).ok_or(PngError::Drawing)?;
    let mut pixels = tiny_skia::Pixmap::new(size.width(), size.height()).ok_or(PngError::Drawing)?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| PngError::Encoding(error.to_string()))
}

/// Fails: this build draws no pixels.
///
/// # Errors
/// [`PngError::LeftOut`].
#[cfg(not(feature = "pdf"))]
pub fn png<'a>(_: impl IntoIterator<Item = &'a Figure>) -> Result<Vec<u8>, PngError> {
    Err(PngError::LeftOut)
}
