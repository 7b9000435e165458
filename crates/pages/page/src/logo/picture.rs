//! Logos as a PDF takes them.

use resvg::{tiny_skia, usvg};

use super::file::{Kind, LogoError, MOST_PIXELS};

/// Pixels that an SVG becomes on paper, at most: sharp at the size of a logo.
const DRAWN_WIDTH: f32 = 960.0;
const DRAWN_HEIGHT: f32 = 440.0;

/// A picture as a PDF takes it.
#[derive(Debug, Clone)]
pub(crate) struct Picture {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) content: Pixels,
}

/// The pixels of a picture.
#[derive(Debug, Clone)]
pub(crate) enum Pixels {
    /// Red, green and blue of each, and how opaque it is.
    Plain { colours: Vec<u8>, opacities: Vec<u8> },
    /// A JPEG file, grey or in colour.
    Jpeg { file: Vec<u8>, is_grey: bool },
}

impl Picture {
    /// Reads a file of this kind.
    pub(super) fn of(kind: Kind, bytes: &[u8]) -> Result<Self, LogoError> {
        match kind {
            Kind::Png => png(bytes),
            Kind::Jpeg => jpeg(bytes),
            Kind::Svg => svg(bytes),
        }
    }
}

fn check_size(width: u32, height: u32) -> Result<(), LogoError> {
    match width.max(height) > MOST_PIXELS {
        true => Err(LogoError::ManyPixels { width, height }),
        false => Ok(()),
    }
}

/// The pixels of a PNG. Its size is checked before any memory is taken for it.
fn png(bytes: &[u8]) -> Result<Picture, LogoError> {
    let side = |at: usize| bytes.get(at..at + 4).and_then(|four| four.try_into().ok()).map(u32::from_be_bytes);
    let (Some(width), Some(height)) = (side(16), side(20)) else {
        return Err(LogoError::Broken("the file ends early".to_owned()));
    };
    check_size(width, height)?;
    let pixels = tiny_skia::Pixmap::decode_png(bytes).map_err(|error| LogoError::Broken(error.to_string()))?;
    Ok(plain(&pixels))
}

fn plain(pixels: &tiny_skia::Pixmap) -> Picture {
    let colours: Vec<_> = pixels.pixels().iter().map(|pixel| pixel.demultiply()).collect();
    Picture {
        width: pixels.width(),
        height: pixels.height(),
        content: Pixels::Plain {
            colours: colours.iter().flat_map(|colour| [colour.red(), colour.green(), colour.blue()]).collect(),
            opacities: colours.iter().map(|colour| colour.alpha()).collect(),
        },
    }
}

/// A JPEG stays as it is; its size and channels are in the head of its frame.
fn jpeg(bytes: &[u8]) -> Result<Picture, LogoError> {
    let broken = || LogoError::Broken("the file has no frame".to_owned());
    let mut at = 2;
    loop {
        let [0xff, marker, high, low] = *bytes.get(at..at + 4).ok_or_else(broken)? else { return Err(broken()) };
        let length = usize::from(u16::from_be_bytes([high, low]));
        // The heads of frames, without tables of codes and the like that are between them.
        if matches!(marker, 0xc0..=0xc2) {
            let head = bytes.get(at + 4..at + 10).ok_or_else(broken)?;
            let side = |at: usize| u32::from(u16::from_be_bytes([head[at], head[at + 1]]));
            let (height, width, channels) = (side(1), side(3), head[5]);
            check_size(width, height)?;
            if width == 0 || height == 0 {
                return Err(broken());
            }
            if channels != 1 && channels != 3 {
                return Err(LogoError::Channels(channels));
            }
            let content = Pixels::Jpeg { file: bytes.to_vec(), is_grey: channels == 1 };
            return Ok(Picture { width, height, content });
        }
        at += 2 + length;
    }
}

/// An SVG as pixels. It may not read other files.
fn svg(bytes: &[u8]) -> Result<Picture, LogoError> {
    let text = std::str::from_utf8(bytes).map_err(|_| LogoError::Kind)?;
    let options = crate::drawing::options();
    let tree = usvg::Tree::from_str(text, &options).map_err(|error| LogoError::Broken(error.to_string()))?;
    let broken = || LogoError::Broken("it has no size".to_owned());
    let (width, height) = (tree.size().width(), tree.size().height());
    let scale = (DRAWN_WIDTH / width).min(DRAWN_HEIGHT / height);
    let size = tree.size().to_int_size().scale_by(scale).ok_or_else(broken)?;
    let mut pixels = tiny_skia::Pixmap::new(size.width(), size.height()).ok_or_else(broken)?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    Ok(plain(&pixels))
}
