//! Moving through a stream from front to back.

use crate::error::damaged;
use crate::stream::{Loader, Packing, Stream};
use crate::{MdfError, Source};

/// Bytes read at once where the fragment does not say.
const STEP: u64 = 1 << 20;

/// A window of a stream that moves forwards.
pub(crate) struct Cursor<'a, S: ?Sized> {
    stream: &'a Stream,
    loader: Loader<'a, S>,
    /// The place in the stream of the window's first byte.
    start: u64,
    /// Bytes of the window, with those already given up at the front until more is read.
    bytes: Vec<u8>,
    given_up: usize,
}

impl<'a, S: Source + ?Sized> Cursor<'a, S> {
    pub(crate) fn new(source: &'a S, stream: &'a Stream) -> Self {
        Self::from(source, stream, 0)
    }

    /// A window that begins at a place of the stream.
    pub(crate) fn from(source: &'a S, stream: &'a Stream, start: u64) -> Self {
        Self { stream, loader: Loader::new(source, stream), start, bytes: Vec::new(), given_up: 0 }
    }

    /// The place in the stream up to which the window reaches.
    fn end(&self) -> u64 {
        self.start + self.window().len() as u64
    }

    pub(crate) fn window(&self) -> &[u8] {
        &self.bytes[self.given_up..]
    }

    /// Where the window begins.
    pub(crate) fn start(&self) -> u64 {
        self.start
    }

    /// Gives up the first `count` bytes of the window.
    pub(crate) fn consume(&mut self, count: usize) {
        let count = count.min(self.window().len());
        self.given_up += count;
        self.start += count as u64;
    }

    /// Makes the window longer; false at the end of the stream.
    pub(crate) fn extend(&mut self) -> Result<bool, MdfError> {
        let end = self.end();
        let Some(index) = self.stream.at(end) else { return Ok(false) };
        self.bytes.drain(..self.given_up);
        self.given_up = 0;
        let fragment = &self.stream.fragments[index];
        let until = match fragment.packing {
            Packing::Plain => fragment.end().min(end + STEP),
            _ => fragment.end(),
        };
        self.loader.append(end..until, &mut self.bytes)?;
        Ok(true)
    }

    /// `count` bytes at `place`, which may not lie before what was given up.
    pub(crate) fn at(&mut self, place: u64, count: usize) -> Result<&[u8], MdfError> {
        if place > self.end() {
            self.bytes.clear();
            self.given_up = 0;
            self.start = place;
        } else {
            self.consume(usize::try_from(place.saturating_sub(self.start)).unwrap_or(usize::MAX));
        }
        let missing = || damaged(place, "a value of varying length reaches beyond its data");
        if place < self.start || count as u64 > self.stream.length.saturating_sub(place) {
            return Err(missing());
        }
        while self.window().len() < count {
            if !self.extend()? {
                return Err(missing());
            }
        }
        Ok(&self.window()[..count])
    }
}
