//! Blocks of MDF 4, and texts.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use crate::bytes::u64_at;
use crate::error::damaged;
use crate::model::Finding;
use crate::pages::Pages;
use crate::text::{comment, utf8};
use crate::{MdfError, Source};

/// Size of a block's header: identifier, length, number of links.
pub(super) const HEADER: u64 = 24;

/// A block: its links and what follows them.
#[derive(Debug)]
pub(super) struct Block {
    pub(super) offset: u64,
    pub(super) id: [u8; 4],
    links: usize,
    body: Vec<u8>,
}

impl Block {
    /// A link; 0 where the block has none at this place.
    pub(super) fn link(&self, index: usize) -> u64 {
        if index < self.links { u64_at(&self.body, index * 8) } else { 0 }
    }

    pub(super) fn links(&self) -> usize {
        self.links
    }

    pub(super) fn data(&self) -> &[u8] {
        self.body.get(self.links * 8..).unwrap_or_default()
    }
}

/// The way through the blocks of a file.
pub(super) struct Walk<'a, S: ?Sized> {
    pub(super) pages: Pages<'a, S>,
    /// Blocks that only one link may lead to.
    pub(super) seen: HashSet<u64>,
    pub(super) findings: Vec<Finding>,
    pub(super) conversions: super::converted::Known,
    texts: HashMap<u64, Arc<str>>,
    budget: u64,
    nothing: Arc<str>,
}

impl<'a, S: Source + ?Sized> Walk<'a, S> {
    pub(super) fn new(pages: Pages<'a, S>) -> Self {
        let budget = pages.most_read();
        Self {
            pages,
            seen: HashSet::new(),
            findings: Vec::new(),
            conversions: HashMap::new(),
            texts: HashMap::new(),
            budget,
            nothing: Arc::from(""),
        }
    }

    /// Where blocks are that were met.
    pub(super) fn known_blocks(&self) -> impl Iterator<Item = u64> {
        self.seen.iter().chain(self.texts.keys()).copied()
    }

    /// Fails where so much was made of the file that its blocks must lie upon each other.
    pub(super) fn spend(&mut self, bytes: u64, offset: u64) -> Result<(), MdfError> {
        let left = self.budget.checked_sub(bytes);
        self.budget = left.ok_or_else(|| damaged(offset, "the blocks lie upon each other"))?;
        Ok(())
    }

    /// Identifier, length and number of links of the block at `offset`.
    pub(super) fn header(&mut self, offset: u64) -> Result<([u8; 4], u64, u64), MdfError> {
        let header = self.pages.bytes(offset, HEADER)?;
        let mut id = [0; 4];
        id.copy_from_slice(&header[..4]);
        Ok((id, u64_at(&header, 8), u64_at(&header, 16)))
    }

    /// The block at `offset`, which must be one of `ids`.
    pub(super) fn block(&mut self, offset: u64, ids: &[&[u8; 4]]) -> Result<Block, MdfError> {
        let (id, length, links) = self.header(offset)?;
        if !ids.contains(&&id) {
            return Err(damaged(
                offset,
                format!("a block \"{}\" should be there, found \"{}\"", ids[0].escape_ascii(), id.escape_ascii()),
            ));
        }
        let available = self.pages.length - offset;
        if length > available {
            return Err(MdfError::Truncated { offset, expected: length, available });
        }
        let size = length.saturating_sub(HEADER);
        let links = links.checked_mul(8).filter(|&n| n <= size).map(|n| (n / 8) as usize);
        let links = links.ok_or_else(|| damaged(offset, "the block is shorter than its links"))?;
        self.spend(length, offset)?;
        let body = self.pages.bytes(offset + HEADER, size)?;
        Ok(Block { offset, id, links, body })
    }

    /// A block that nothing else may lead to.
    pub(super) fn own_block(&mut self, offset: u64, ids: &[&[u8; 4]]) -> Result<Block, MdfError> {
        if !self.seen.insert(offset) {
            return Err(damaged(offset, "two links lead to the same block"));
        }
        self.block(offset, ids)
    }

    /// The text of a TX or MD block; empty where there is none.
    pub(super) fn text(&mut self, offset: u64) -> Result<Arc<str>, MdfError> {
        if offset == 0 {
            return Ok(self.nothing.clone());
        }
        if let Some(text) = self.texts.get(&offset) {
            return Ok(text.clone());
        }
        let block = self.block(offset, &[b"##TX", b"##MD"])?;
        let text = utf8(block.data());
        let text = if block.id == *b"##MD" { comment(&text) } else { text.trim().to_owned() };
        let text: Arc<str> = text.into();
        self.texts.insert(offset, text.clone());
        Ok(text)
    }
}
