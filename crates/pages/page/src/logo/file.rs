//! Files of logos: their kinds, and why one is none.

/// Most bytes of a file.
pub(super) const MOST_BYTES: usize = 1 << 20;
/// Most pixels of a side.
pub(super) const MOST_PIXELS: u32 = 3000;

/// Kind of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    Png,
    Jpeg,
    Svg,
}

/// Why a file is no logo.
#[derive(Debug, thiserror::Error)]
pub enum LogoError {
    /// The file is larger than a logo may be.
    #[error("the file has more than {} kB; save it smaller", MOST_BYTES / 1024)]
    Large,
    /// The picture has more pixels than a logo may have.
    #[error("the picture has {width} × {height} pixels and a logo may have {MOST_PIXELS} each way; scale it down")]
    ManyPixels {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The file is of another kind.
    #[error("the file is no PNG, JPEG or SVG; save the logo as one of these")]
    Kind,
    /// The file is damaged.
    #[error("the picture cannot be read: {0}; save it anew")]
    Broken(String),
    /// The colours are those of a printing press.
    #[error("the JPEG has {0} colour channels; save it in RGB or grey")]
    Channels(u8),
}
