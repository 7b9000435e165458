//! The logo of a page: a small picture from outside.

mod file;
#[cfg(feature = "pdf")]
mod picture;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
pub use file::LogoError;
use file::{Kind, MOST_BYTES};
#[cfg(feature = "pdf")]
pub(crate) use picture::{Picture, Pixels};
use serde::{Serialize, Serializer};

/// A picture at the top of a page: PNG, JPEG or SVG.
#[derive(Debug, Clone)]
pub struct Logo {
    kind: Kind,
    bytes: Vec<u8>,
    #[cfg(feature = "pdf")]
    picture: Picture,
}

impl Logo {
    /// Most bytes of a logo: it is a part of each report.
    pub const MOST_BYTES: usize = MOST_BYTES;

    /// Reads a file. Without the feature `pdf` its kind is looked at, and not its content.
    ///
    /// # Errors
    /// [`LogoError`] where the file is too large, of another kind, or damaged.
    pub fn read(bytes: Vec<u8>) -> Result<Self, LogoError> {
        if bytes.len() > Self::MOST_BYTES {
            return Err(LogoError::Large);
        }
        let kind = match bytes.as_slice() {
            [0x89, b'P', b'N', b'G', ..] => Kind::Png,
            [0xff, 0xd8, ..] => Kind::Jpeg,
            _ if std::str::from_utf8(&bytes).is_ok_and(|text| text.contains("<svg")) => Kind::Svg,
            _ => return Err(LogoError::Kind),
        };
        Ok(Logo {
            kind,
            #[cfg(feature = "pdf")]
            picture: Picture::of(kind, &bytes)?,
            bytes,
        })
    }

    /// The file as an address that has all of it.
    pub(crate) fn data_uri(&self) -> String {
        let kind = match self.kind {
            Kind::Png => "png",
            Kind::Jpeg => "jpeg",
            Kind::Svg => "svg+xml",
        };
        format!("data:image/{kind};base64,{}", STANDARD.encode(&self.bytes))
    }

    #[cfg(feature = "pdf")]
    pub(crate) fn picture(&self) -> &Picture {
        &self.picture
    }
}

impl Serialize for Logo {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.data_uri())
    }
}
