//! Blocks of MDF 2 and 3, and texts.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use crate::bytes::array;
use crate::error::damaged;
use crate::pages::Pages;
use crate::text::latin1;
use crate::{MdfError, Source};

/// A block from its identifier to its end, numbers in the byte order of the file.
#[derive(Debug)]
pub(super) struct Block {
    bytes: Vec<u8>,
    big_endian: bool,
}

impl Block {
    fn field<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut field = array(&self.bytes, at);
        if self.big_endian && self.bytes.len() >= at + N {
            field.reverse();
        }
        field
    }

    pub(super) fn u16(&self, at: usize) -> u16 {
        u16::from_le_bytes(self.field(at))
    }

    pub(super) fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes(self.field(at))
    }

    pub(super) fn u64(&self, at: usize) -> u64 {
        u64::from_le_bytes(self.field(at))
    }

    pub(super) fn f64(&self, at: usize) -> f64 {
        f64::from_le_bytes(self.field(at))
    }

    pub(super) fn link(&self, at: usize) -> u64 {
        u64::from(self.u32(at))
    }

    /// Text of fixed size.
    pub(super) fn text(&self, at: usize, size: usize) -> String {
        let rest = self.bytes.get(at..).unwrap_or_default();
        latin1(&rest[..rest.len().min(size)]).trim().to_owned()
    }

    pub(super) fn len(&self) -> usize {
        self.bytes.len()
    }
}

/// The way through the blocks of a file.
pub(super) struct Walk<'a, S: ?Sized> {
    pub(super) pages: Pages<'a, S>,
    big_endian: bool,
    seen: HashSet<u64>,
    texts: HashMap<u64, Arc<str>>,
    budget: u64,
}

impl<'a, S: Source + ?Sized> Walk<'a, S> {
    pub(super) fn new(pages: Pages<'a, S>, big_endian: bool) -> Self {
        let budget = pages.most_read();
        Self { pages, big_endian, seen: HashSet::new(), texts: HashMap::new(), budget }
    }

    /// The block at `offset`, at least `least` bytes of it.
    pub(super) fn block(&mut self, offset: u64, id: &[u8; 2], least: u64) -> Result<Block, MdfError> {
        let header = self.pages.bytes(offset, 4)?;
        if !header.starts_with(id) {
            return Err(damaged(
                offset,
                format!("a block \"{}\" should be there, found \"{}\"", id.escape_ascii(), header[..2].escape_ascii()),
            ));
        }
        let header = Block { bytes: header, big_endian: self.big_endian };
        let length = u64::from(header.u16(2)).max(least);
        let left = self.budget.checked_sub(length);
        self.budget = left.ok_or_else(|| damaged(offset, "the blocks lie upon each other"))?;
        Ok(Block { bytes: self.pages.bytes(offset, length)?, ..header })
    }

    /// A block that nothing else may lead to.
    pub(super) fn own_block(&mut self, offset: u64, id: &[u8; 2], least: u64) -> Result<Block, MdfError> {
        if !self.seen.insert(offset) {
            return Err(damaged(offset, "two links lead to the same block"));
        }
        self.block(offset, id, least)
    }

    /// The text of a TX block; empty where there is none.
    pub(super) fn text(&mut self, offset: u64) -> Result<Arc<str>, MdfError> {
        if let Some(text) = self.texts.get(&offset) {
            return Ok(text.clone());
        }
        let text: Arc<str> = match offset {
            0 => Arc::from(""),
            _ => {
                let block = self.block(offset, b"TX", 4)?;
                block.text(4, block.len()).into()
            }
        };
        self.texts.insert(offset, text.clone());
        Ok(text)
    }

    /// Where the first block after `offset` begins that was met, or the file ends.
    pub(super) fn end_of_data(&self, offset: u64) -> u64 {
        let known = self.seen.iter().chain(self.texts.keys()).copied();
        known.filter(|&o| o > offset).min().unwrap_or(self.pages.length)
    }
}
