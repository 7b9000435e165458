//! Reading many small blocks through a bounded cache of pages.

use std::collections::HashMap;

use crate::{MdfError, Source};

/// Of the many blocks of data only the heads are read, so that larger pages would mostly bring what is not looked at.
const PAGE: u64 = 1 << 12;
/// Pages held at once: few, so that memory that has been written to before is written to again.
const MOST: usize = 1 << 7;
/// Bytes of blocks that may be read beyond four times the file: blocks are read about once.
const SPARE: u64 = 1 << 26;

/// A source with its length, and pages of it in memory.
pub(crate) struct Pages<'a, S: ?Sized> {
    source: &'a S,
    pub(crate) length: u64,
    pages: HashMap<u64, Box<[u8]>>,
}

impl<'a, S: Source + ?Sized> Pages<'a, S> {
    pub(crate) fn new(source: &'a S) -> Result<Self, MdfError> {
        let failed = |e: std::io::Error| MdfError::Io { offset: 0, length: 0, detail: e.to_string() };
        let length = source.size().map_err(failed)?;
        Ok(Self { source, length, pages: HashMap::new() })
    }

    /// Bytes of blocks that may be read of the file at most.
    pub(crate) fn most_read(&self) -> u64 {
        self.length.saturating_mul(4).saturating_add(SPARE)
    }

    /// `count` bytes at `offset`, all of which the file must have.
    pub(crate) fn bytes(&mut self, offset: u64, count: u64) -> Result<Vec<u8>, MdfError> {
        let available = self.length.saturating_sub(offset);
        let short = || MdfError::Truncated { offset, expected: count, available };
        if count > available {
            return Err(short());
        }
        let mut bytes = vec![0; usize::try_from(count).map_err(|_| short())?];
        if count > PAGE {
            read(self.source, offset, &mut bytes)?;
            return Ok(bytes);
        }
        let mut done = 0;
        while done < bytes.len() {
            let place = offset + done as u64;
            let within = (place % PAGE) as usize;
            let page = self.page(place / PAGE)?;
            let part = &page[within.min(page.len())..];
            let n = part.len().min(bytes.len() - done);
            if n == 0 {
                return Err(short());
            }
            bytes[done..done + n].copy_from_slice(&part[..n]);
            done += n;
        }
        Ok(bytes)
    }

    fn page(&mut self, index: u64) -> Result<&[u8], MdfError> {
        if self.pages.len() >= MOST && !self.pages.contains_key(&index) {
            self.pages.clear();
        }
        match self.pages.entry(index) {
            std::collections::hash_map::Entry::Occupied(entry) => Ok(entry.into_mut()),
            std::collections::hash_map::Entry::Vacant(entry) => {
                let size = PAGE.min(self.length.saturating_sub(index * PAGE));
                let mut page = vec![0; size as usize];
                read(self.source, index * PAGE, &mut page)?;
                Ok(entry.insert(page.into_boxed_slice()))
            }
        }
    }
}

/// Fills `buffer` from `offset` on.
pub(crate) fn read<S: Source + ?Sized>(source: &S, offset: u64, buffer: &mut [u8]) -> Result<(), MdfError> {
    let length = buffer.len() as u64;
    let failed = |e: std::io::Error| MdfError::Io { offset, length, detail: e.to_string() };
    source.read_at(offset, buffer).map_err(failed)
}
