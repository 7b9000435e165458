//! Data of MDF 4: from data blocks, lists of them, and compressed ones to a [`Stream`].

use super::block::{HEADER, Walk};
use crate::bytes::{u8_at, u32_at, u64_at};
use crate::error::damaged;
use crate::model::Finding;
use crate::stream::{Codec, Packing, Stream, zstandard_size};
use crate::{MdfError, Source};

/// Size of a DZ block before its data.
const PACKED_HEADER: u64 = 48;

/// The longest header of a frame of Zstandard.
const ZSTANDARD_HEADER: u64 = 18;

/// Data that a link leads to.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub(super) stream: Stream,
    /// Invalidation bytes, where they are apart.
    pub(super) invalid: Option<Stream>,
}

/// Blocks that hold plain data.
const PLAIN: [&[u8; 4]; 7] = [b"##DT", b"##SD", b"##DV", b"##DI", b"##RD", b"##RV", b"##RI"];

impl<S: Source + ?Sized> Walk<'_, S> {
    /// The data that a link leads to; none at 0. In a file that was `open`, a list may end before it should.
    pub(super) fn data(&mut self, link: u64, open: bool) -> Result<Found, MdfError> {
        let mut found = Found::default();
        if link == 0 {
            return Ok(found);
        }
        let (id, ..) = self.header_within(link)?;
        let first = match &id {
            b"##HL" => self.own_block(link, &[b"##HL"])?.link(0),
            b"##DL" | b"##LD" => link,
            _ => {
                self.fragment(link, &mut found.stream)?;
                return Ok(found);
            }
        };
        self.list(first, open, &mut found)?;
        Ok(found)
    }

    fn header_within(&mut self, link: u64) -> Result<([u8; 4], u64, u64), MdfError> {
        match self.header(link) {
            // A data block at the very end of a file that was cut off.
            Err(MdfError::Truncated { .. }) => {
                self.findings.push(Finding::CutOff { offset: link });
                Ok((*b"##DT", 0, 0))
            }
            other => other,
        }
    }

    fn list(&mut self, first: u64, open: bool, found: &mut Found) -> Result<(), MdfError> {
        let mut next = first;
        while next != 0 {
            let block = match self.own_block(next, &[b"##DL", b"##LD"]) {
                Err(_) if open => {
                    self.findings.push(Finding::ListEndsEarly { offset: next });
                    return Ok(());
                }
                other => other?,
            };
            let is_columns = block.id == *b"##LD";
            let flags = u32_at(block.data(), 0);
            let has_invalid = is_columns && flags & 0x8000_0000 != 0;
            let links = block.links().saturating_sub(1);
            let announced = u32_at(block.data(), 4) as usize;
            let count = announced.min(if has_invalid { links / 2 } else { links });
            for i in 0..count {
                if !self.listed(block.link(1 + i), open, &mut found.stream)? {
                    return Ok(());
                }
                if has_invalid {
                    let invalid = found.invalid.get_or_insert_default();
                    self.listed(block.link(1 + count + i), open, invalid)?;
                }
            }
            next = block.link(0);
        }
        Ok(())
    }

    /// A block of a list; false where there is none, nor any after it.
    fn listed(&mut self, link: u64, open: bool, stream: &mut Stream) -> Result<bool, MdfError> {
        if link == 0 {
            return Ok(false);
        }
        match self.fragment(link, stream) {
            Err(MdfError::Damaged { .. } | MdfError::Truncated { .. }) if open => {
                self.findings.push(Finding::ListEndsEarly { offset: link });
                Ok(false)
            }
            other => other,
        }
    }

    /// A data block; false where the file ends within it.
    fn fragment(&mut self, link: u64, stream: &mut Stream) -> Result<bool, MdfError> {
        if !self.seen.insert(link) {
            return Err(damaged(link, "links to data name the same block repeatedly"));
        }
        let (id, length, _) = self.header_within(link)?;
        if id == *b"##DZ" {
            return self.packed(link, stream);
        }
        if !PLAIN.contains(&&id) {
            return Err(damaged(link, format!("a block of data should be there, found \"{}\"", id.escape_ascii())));
        }
        let begin = link.saturating_add(HEADER);
        let available = self.pages.length.saturating_sub(begin);
        let announced = length.saturating_sub(HEADER);
        stream.push(begin, announced.min(available), announced.min(available), Packing::Plain);
        if announced > available {
            self.findings.push(Finding::CutOff { offset: self.pages.length });
        }
        Ok(announced <= available)
    }

    fn packed(&mut self, link: u64, stream: &mut Stream) -> Result<bool, MdfError> {
        let available = self.pages.length.saturating_sub(link);
        let header = match self.pages.bytes(link, PACKED_HEADER) {
            Err(MdfError::Truncated { .. }) => {
                self.findings.push(Finding::CutOff { offset: link });
                return Ok(false);
            }
            other => other?,
        };
        let (columns, length, stored) = (u32_at(&header, 28), u64_at(&header, 32), u64_at(&header, 40));
        let code = u8_at(&header, 26);
        let codec = match code {
            0 | 1 => Codec::Deflate,
            2 | 3 => Codec::Zstandard,
            4 | 5 => Codec::Lz4,
            _ => Codec::Unknown(code),
        };
        if code % 2 == 1 && columns == 0 {
            return Err(damaged(link, "packed data are transposed for records of no bytes"));
        }
        // Records of one byte are the same either way round.
        let columns = if code % 2 == 1 && columns > 1 { columns } else { 0 };
        if stored > available - PACKED_HEADER {
            self.findings.push(Finding::CutOff { offset: link });
            return Ok(false);
        }
        let most = codec.most_expansion();
        let stated = match codec {
            Codec::Zstandard => {
                let head = self.pages.bytes(link + PACKED_HEADER, stored.min(ZSTANDARD_HEADER))?;
                zstandard_size(&head)
            }
            _ => None,
        };
        if length > stored.saturating_mul(most).saturating_add(most) || stated.is_some_and(|stated| length > stated) {
            return Err(damaged(link, format!("{stored} packed bytes cannot hold {length}")));
        }
        stream.push(link + PACKED_HEADER, stored, length, Packing::Packed { codec, columns });
        Ok(true)
    }

    /// Lets the data block that comes last in a file that was not closed reach to the next block after it, or to the
    /// end of the file, since its length may never have been written.
    pub(super) fn stretch_last<'s>(&self, streams: impl Iterator<Item = &'s mut Stream>) {
        let Some(stream) = streams.max_by_key(|s| s.fragments.last().map(|f| f.offset)) else { return };
        let Some(fragment) = stream.fragments.last_mut().filter(|f| f.packing == Packing::Plain) else { return };
        let after = self.known_blocks().filter(|&o| o > fragment.offset).min();
        let end = after.unwrap_or(self.pages.length);
        let length = end.saturating_sub(fragment.offset).max(fragment.length);
        stream.length = stream.length - fragment.length + length;
        (fragment.stored, fragment.length) = (length, length);
    }
}
