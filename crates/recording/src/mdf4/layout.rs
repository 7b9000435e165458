//! What the blocks of an MDF 4 file announce, read from the bytes themselves.
//!
//! Walking the chains first also refuses files whose groups or channels share blocks: following every path through
//! them would take memory and time out of proportion to the file.

use std::collections::{HashMap, HashSet};

use crate::mdf::{slice, truncated};
use crate::{RecordingError, StartTime};

/// Size of a block's header: identifier, length, number of links.
const HEADER: u64 = 24;

/// What the file announces.
pub(super) struct Layout {
    pub(super) start_time: Option<StartTime>,
    groups: HashMap<u64, Declared>,
    data: Vec<u64>,
    /// Where the last of the blocks that describe the channels begins.
    last_block: u64,
}

/// What a channel group announces.
#[derive(Debug, Clone, Copy)]
pub(super) struct Declared {
    pub(super) cycles: u64,
    /// The group whose clock this one uses.
    pub(super) remote_master: Option<u64>,
}

impl Layout {
    pub(super) fn read(file: &str, bytes: &[u8]) -> Result<Self, RecordingError> {
        let mut walk = Walk {
            file,
            bytes,
            seen: HashSet::new(),
        };
        let head = walk.block(64, b"##HD")?;
        let mut layout = Self {
            start_time: start_time(&head),
            groups: HashMap::new(),
            data: Vec::new(),
            last_block: 0,
        };
        let mut next = head.link(0);
        while next != 0 {
            let group = walk.block(next, b"##DG")?;
            layout.data.push(group.link(2));
            walk.channel_groups(group.link(1), &mut layout.groups)?;
            next = group.link(0);
        }
        layout.last_block = walk.seen.iter().copied().max().unwrap_or(0);
        Ok(layout)
    }

    pub(super) fn group(&self, offset: u64) -> Option<Declared> {
        self.groups.get(&offset).copied()
    }

    /// Gives a data block that runs past the end of a file that was cut off the length that is there, so that the samples
    /// before the cut can be read. The counts announced by the groups tell that some are missing.
    pub(super) fn shorten_cut_blocks(&self, bytes: &mut [u8]) {
        let length = bytes.len() as u64;
        for &offset in self.data.iter().filter(|&&o| o > self.last_block) {
            let Some(rest) = usize::try_from(offset)
                .ok()
                .and_then(|o| bytes.get_mut(o..))
            else {
                continue;
            };
            let available = length - offset;
            let Some(field) = rest.get(8..16).filter(|_| rest.starts_with(b"##DT")) else {
                continue;
            };
            if u64_at(field, 0) > available && available >= HEADER {
                rest[8..16].copy_from_slice(&available.to_le_bytes());
            }
        }
    }
}

/// A block: its links and what follows them.
struct Block<'a> {
    links: &'a [u8],
    data: &'a [u8],
}

impl Block<'_> {
    /// A link; 0 where the block has none at this place.
    fn link(&self, index: usize) -> u64 {
        u64_at(self.links, index * 8)
    }
}

struct Walk<'a> {
    file: &'a str,
    bytes: &'a [u8],
    seen: HashSet<u64>,
}

impl<'a> Walk<'a> {
    fn block(&mut self, offset: u64, id: &[u8]) -> Result<Block<'a>, RecordingError> {
        let damaged = |detail: String| RecordingError::Damaged {
            file: self.file.into(),
            offset: Some(offset),
            detail,
        };
        let header = slice(self.file, self.bytes, offset, HEADER)?;
        if !header.starts_with(id) {
            return Err(damaged(format!(
                "a block \"{}\" should be there, found \"{}\"",
                id.escape_ascii(),
                header[..4].escape_ascii()
            )));
        }
        if !self.seen.insert(offset) {
            return Err(damaged("two links lead to the same block".into()));
        }
        let (length, links) = (u64_at(header, 8), u64_at(header, 16));
        let body = length.saturating_sub(HEADER);
        let body = slice(self.file, self.bytes, offset + HEADER, body)
            .map_err(|_| truncated(self.file, offset, length, self.bytes.len() as u64))?;
        let links = links.checked_mul(8).and_then(|n| usize::try_from(n).ok());
        let (links, data) = links
            .and_then(|n| body.split_at_checked(n))
            .ok_or_else(|| damaged("the block is shorter than its links".into()))?;
        Ok(Block { links, data })
    }

    fn channel_groups(
        &mut self,
        first: u64,
        groups: &mut HashMap<u64, Declared>,
    ) -> Result<(), RecordingError> {
        let mut next = first;
        while next != 0 {
            let group = self.block(next, b"##CG")?;
            let flags = u64_at(group.data, 16);
            let remote = group.link(6);
            let declared = Declared {
                cycles: u64_at(group.data, 8),
                remote_master: (flags & 0x8 != 0 && remote != 0).then_some(remote),
            };
            groups.insert(next, declared);
            self.channels(group.link(1))?;
            next = group.link(0);
        }
        Ok(())
    }

    fn channels(&mut self, first: u64) -> Result<(), RecordingError> {
        let mut next = first;
        while next != 0 {
            next = self.block(next, b"##CN")?.link(0);
        }
        Ok(())
    }
}

fn start_time(head: &Block<'_>) -> Option<StartTime> {
    let nanoseconds = i64::from_le_bytes(u64_at(head.data, 0).to_le_bytes());
    let offset = |at: usize| -> Option<i32> {
        let pair = head.data.get(at..at + 2)?;
        Some(i32::from(i16::from_le_bytes([pair[0], pair[1]])))
    };
    let flags = head.data.get(12).copied()?;
    let (zone, daylight) = (offset(8)?, offset(10)?);
    (nanoseconds != 0).then_some(StartTime {
        nanoseconds,
        is_local: flags & 1 != 0,
        utc_offset_min: (flags & 2 != 0).then_some(zone + daylight),
    })
}

/// The number at `at`, 0 where the bytes end before it.
fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let mut field = [0; 8];
    let Some(rest) = bytes.get(at..) else {
        return 0;
    };
    let n = rest.len().min(8);
    field[..n].copy_from_slice(&rest[..n]);
    u64::from_le_bytes(field)
}
