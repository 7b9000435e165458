#![doc = include_str!("../README.md")]
//!
//! Measurement files in ASAM MDF, versions 2.x, 3.x and 4.x.
//!
//! [`Mdf::open`] reads the structure of a file, not its samples; [`Mdf::read`] reads the samples of the channels that
//! are asked for, in bounded pieces, so that memory is taken by the answer and not by the file. The bytes come from a
//! [`Source`]: a file, or memory.
//!
//! No length, count or link of a file is believed before it is compared with the size of the file; what is damaged is
//! an [`MdfError`] that says where, and what is cut off or was never closed is read as far as it goes, with a
//! [`Finding`].

mod bytes;
mod conversion;
mod error;
mod field;
mod model;
mod pages;
mod parts;
mod read;
mod source;
mod stream;
mod text;
mod v3;
mod v4;
mod values;

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

pub use error::MdfError;
pub use model::{Address, Attachment, Channel, Event, Finding, Group, Kind, Master, Obstacle, Quantity, StartTime};
pub use source::Source;
pub use values::{Blobs, Numbers, Texts, Values};

use pages::Pages;
use parts::Parts;

/// An opened file.
#[derive(Debug)]
pub struct Mdf<S> {
    source: S,
    version: u16,
    parts: Parts,
    /// Channels whose integers were rounded.
    rounded: Mutex<BTreeSet<Address>>,
}

impl<S: Source> Mdf<S> {
    /// Reads the structure of a file: groups, channels, conversions, and where the samples are.
    ///
    /// # Errors
    ///
    /// [`MdfError`] where the source fails, is no MDF file, or its structure is damaged.
    pub fn open(source: S) -> Result<Self, MdfError> {
        let mut pages = Pages::new(&source)?;
        let id = pages.bytes(0, 64.min(pages.length))?;
        let version = version(&id, pages.length)?;
        let is_open = id.starts_with(b"UnFinMF ");
        let parts = match version {
            400.. => v4::open(pages, &id, is_open)?,
            _ => v3::open(pages, &id, version, is_open)?,
        };
        Ok(Self { source, version, parts, rounded: Mutex::default() })
    }

    /// Version times one hundred: 410 is 4.10.
    #[must_use]
    pub fn version(&self) -> u16 {
        self.version
    }

    /// When the measurement started.
    #[must_use]
    pub fn start_time(&self) -> Option<StartTime> {
        self.parts.start_time
    }

    /// The file's own comment.
    #[must_use]
    pub fn comment(&self) -> Option<&str> {
        self.parts.comment.as_deref()
    }

    /// The channel groups in the order of the file.
    #[must_use]
    pub fn groups(&self) -> &[Group] {
        &self.parts.groups
    }

    /// Files carried with the measurement.
    #[must_use]
    pub fn attachments(&self) -> &[Attachment] {
        &self.parts.attachments
    }

    /// Events during the measurement.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.parts.events
    }

    /// The channels read so far in which integers of 2^53 and more were met: as `f64` they are rounded.
    #[must_use]
    pub fn rounded(&self) -> Vec<Address> {
        self.rounded.lock().unwrap_or_else(PoisonError::into_inner).iter().copied().collect()
    }

    /// Findings that users of the file should know.
    #[must_use]
    pub fn findings(&self) -> &[Finding] {
        &self.parts.findings
    }
}

/// Version times one hundred from the identification block.
fn version(id: &[u8], length: u64) -> Result<u16, MdfError> {
    let start = || id[..id.len().min(8)].escape_ascii().to_string();
    if !id.starts_with(b"MDF     ") && !id.starts_with(b"UnFinMF ") {
        return Err(MdfError::NotMdf { start: start() });
    }
    if id.len() < 64 {
        return Err(MdfError::Truncated { offset: 0, expected: 64, available: length });
    }
    let text = text::latin1(&id[8..16]);
    let unsupported = || MdfError::UnsupportedVersion { version: text.trim().to_owned() };
    let (major, minor) = text.trim().split_once('.').ok_or_else(unsupported)?;
    let major: u16 = major.parse().map_err(|_| unsupported())?;
    let digits: String = minor.chars().take_while(char::is_ascii_digit).collect();
    let minor: u16 = digits.parse().map_err(|_| unsupported())?;
    if !(2..=4).contains(&major) || minor > 99 {
        return Err(unsupported());
    }
    Ok(major * 100 + minor)
}
