//! Sources of bytes as readers, and as libraries take them.

use std::io::{self, Read, Seek, SeekFrom};
use std::sync::Arc;

use crate::error::of_content;
use crate::{RecordingError, Source};

/// A source that several readers share.
pub(crate) type Shared = Arc<dyn Source>;

/// A reader of the bytes from one place of a source up to another.
pub(crate) struct Stretch {
    source: Shared,
    at: u64,
    end: u64,
}

impl Stretch {
    pub(crate) fn new(source: &Shared, at: u64, end: u64) -> Self {
        Self { source: source.clone(), at, end }
    }
}

impl Read for Stretch {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let left = usize::try_from(self.end.saturating_sub(self.at)).unwrap_or(usize::MAX);
        let count = left.min(buffer.len());
        self.source.read_at(self.at, &mut buffer[..count])?;
        self.at += count as u64;
        Ok(count)
    }
}

impl Seek for Stretch {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let place = match to {
            SeekFrom::Start(place) => Some(place),
            SeekFrom::End(offset) => self.end.checked_add_signed(offset),
            SeekFrom::Current(offset) => self.at.checked_add_signed(offset),
        };
        self.at = place.ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.at)
    }
}

/// How many bytes a source has.
pub(crate) fn size(file: &str, source: &dyn Source) -> Result<u64, RecordingError> {
    source.size().map_err(|error| unreadable(file, 0, &error))
}

/// So many bytes from a place on, or as many as there are.
pub(crate) fn bytes(file: &str, source: &dyn Source, at: u64, length: u64) -> Result<Vec<u8>, RecordingError> {
    let left = size(file, source)?.saturating_sub(at).min(length);
    let length = usize::try_from(left).map_err(|error| unreadable(file, at, &error))?;
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(length).map_err(|error| of_content(file, Some(at), error.to_string()))?;
    bytes.resize(length, 0);
    source.read_at(at, &mut bytes).map_err(|error| unreadable(file, at, &error))?;
    Ok(bytes)
}

pub(crate) fn unwritable(error: &io::Error) -> RecordingError {
    RecordingError::Unwritable { kind: error.kind(), detail: error.to_string() }
}

pub(crate) fn unreadable(file: &str, offset: u64, error: &dyn std::fmt::Display) -> RecordingError {
    RecordingError::Unreadable { file: file.into(), offset, detail: error.to_string() }
}
