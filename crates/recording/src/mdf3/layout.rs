//! What the blocks of an MDF 2 or 3 file announce, read from the bytes themselves.
//!
//! falcon_mdf decodes the texts of these versions as UTF-8, which loses the degree sign and umlauts, and reserves
//! memory for the announced number of records before it looks at the size of the file.

use std::collections::HashSet;

use crate::mdf::plan::some_text;
use crate::mdf::{latin1, slice, truncated};
use crate::{RecordingError, SkipReason, StartTime};

/// What the file announces.
pub(super) struct Layout {
    pub(super) comment: Option<String>,
    pub(super) start_time: Option<StartTime>,
    pub(super) groups: Vec<DataGroup>,
    big_endian: bool,
    /// Where the last of the blocks that describe the channels begins.
    last_block: u64,
}

/// A stream of records and the channel groups in it.
pub(super) struct DataGroup {
    pub(super) groups: Vec<ChannelGroup>,
    data: u64,
    id_bytes: u64,
}

/// A record layout.
pub(super) struct ChannelGroup {
    pub(super) comment: Option<String>,
    pub(super) channels: Vec<Texts>,
    /// Records as the file announces them.
    pub(super) announced: u64,
    /// Records that are there.
    pub(super) cycles: u64,
    offset: u64,
    record_bytes: u64,
}

/// The texts of a channel.
pub(super) struct Texts {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) comment: String,
    pub(super) is_time: bool,
    data_type: u16,
    to_text: bool,
}

impl Texts {
    pub(super) fn obstacle(&self) -> Option<SkipReason> {
        let kind = match self.data_type {
            _ if self.to_text => "text",
            7 => "text",
            8 => "bytes",
            _ => return None,
        };
        Some(SkipReason::NotNumeric { kind: kind.into() })
    }
}

impl ChannelGroup {
    fn size(&self, id_bytes: u64) -> u64 {
        self.cycles.saturating_mul(self.record_bytes + id_bytes)
    }
}

impl DataGroup {
    /// Bytes of all records.
    pub(super) fn size(&self) -> u64 {
        let sizes = self.groups.iter().map(|g| g.size(self.id_bytes));
        sizes.fold(0, u64::saturating_add)
    }
}

impl Layout {
    pub(super) fn read(file: &str, bytes: &[u8]) -> Result<Self, RecordingError> {
        let id = slice(file, bytes, 0, 64)?;
        let mut walk = Walk {
            file,
            bytes,
            big_endian: id[24] != 0 || id[25] != 0,
            seen: HashSet::new(),
        };
        let head = walk.block(64, b"HD", 164)?;
        let mut groups = Vec::new();
        let mut next = walk.link(head, 4);
        while next != 0 {
            let block = walk.block(next, b"DG", 24)?;
            groups.push(DataGroup {
                groups: walk.channel_groups(walk.link(block, 8))?,
                data: walk.link(block, 16),
                id_bytes: u64::from(walk.u16(block, 22)),
            });
            next = walk.link(block, 4);
        }
        Ok(Self {
            comment: some_text(&walk.text(walk.link(head, 8))),
            start_time: walk.start_time(head),
            groups,
            big_endian: walk.big_endian,
            last_block: walk.seen.iter().copied().max().unwrap_or(0),
        })
    }

    /// Lowers announced record counts to what the file can hold, here and in `bytes`, where a group's records are the
    /// last thing in a file that was cut off.
    pub(super) fn limit_counts(
        &mut self,
        file: &str,
        bytes: &mut [u8],
    ) -> Result<(), RecordingError> {
        let length = bytes.len() as u64;
        for group in &mut self.groups {
            let available = length.saturating_sub(group.data);
            if group.size() <= available
                && group
                    .groups
                    .iter()
                    .all(|g| g.record_bytes > 0 || g.cycles == 0)
            {
                continue;
            }
            let missing = truncated(file, group.data, group.size(), length);
            let [only] = group.groups.as_mut_slice() else {
                return Err(missing);
            };
            if self.last_block > group.data || only.record_bytes == 0 {
                return Err(missing);
            }
            let stride = only.record_bytes + group.id_bytes;
            only.cycles = available / stride;
            if only.cycles == 0 {
                return Err(missing);
            }
            write_count(bytes, only.offset + 22, only.cycles, self.big_endian);
        }
        Ok(())
    }
}

fn write_count(bytes: &mut [u8], offset: u64, count: u64, big_endian: bool) {
    // Only ever lowered from a count of 32 bits.
    let count = u32::try_from(count).unwrap_or(u32::MAX);
    let field = usize::try_from(offset)
        .ok()
        .and_then(|o| bytes.get_mut(o..o + 4));
    if let Some(field) = field {
        field.copy_from_slice(&if big_endian {
            count.to_be_bytes()
        } else {
            count.to_le_bytes()
        });
    }
}

struct Walk<'a> {
    file: &'a str,
    bytes: &'a [u8],
    big_endian: bool,
    seen: HashSet<u64>,
}

impl<'a> Walk<'a> {
    /// The bytes from a block's start to the end of the file, at least `size` of them.
    fn block(&mut self, offset: u64, id: &[u8], size: u64) -> Result<&'a [u8], RecordingError> {
        let damaged = |detail: String| RecordingError::Damaged {
            file: self.file.into(),
            offset: Some(offset),
            detail,
        };
        slice(self.file, self.bytes, offset, size)?;
        let length = self.bytes.len() as u64;
        let block = slice(self.file, self.bytes, offset, length - offset)?;
        if !block.starts_with(id) {
            return Err(damaged(format!(
                "a block \"{}\" should be there, found \"{}\"",
                id.escape_ascii(),
                block[..2].escape_ascii()
            )));
        }
        if !self.seen.insert(offset) {
            return Err(damaged("two links lead to the same block".into()));
        }
        Ok(block)
    }

    fn channel_groups(&mut self, first: u64) -> Result<Vec<ChannelGroup>, RecordingError> {
        let mut groups = Vec::new();
        let mut next = first;
        while next != 0 {
            let block = self.block(next, b"CG", 26)?;
            let cycles = u64::from(self.u32(block, 22));
            groups.push(ChannelGroup {
                comment: some_text(&self.text(self.link(block, 12))),
                channels: self.channels(self.link(block, 8))?,
                announced: cycles,
                cycles,
                offset: next,
                record_bytes: u64::from(self.u16(block, 20)),
            });
            next = self.link(block, 4);
        }
        Ok(groups)
    }

    fn channels(&mut self, first: u64) -> Result<Vec<Texts>, RecordingError> {
        let mut channels = Vec::new();
        let mut next = first;
        while next != 0 {
            let block = self.block(next, b"CN", 218)?;
            channels.push(self.texts(block));
            next = self.link(block, 4);
        }
        Ok(channels)
    }

    fn texts(&self, block: &[u8]) -> Texts {
        let long_name = match self.u16(block, 2) {
            222.. => self.text(self.link(block, 218)),
            _ => String::new(),
        };
        let short_name = latin1(&block[26..58]).trim().to_owned();
        let comment = some_text(&self.text(self.link(block, 20)));
        let (unit, conversion) = self.conversion(self.link(block, 8));
        Texts {
            name: some_text(&long_name).unwrap_or(short_name),
            unit,
            comment: comment.unwrap_or_else(|| latin1(&block[58..186]).trim().to_owned()),
            is_time: self.u16(block, 24) == 1,
            data_type: self.u16(block, 190),
            to_text: matches!(conversion, 11 | 12),
        }
    }

    /// Unit and type of a conversion.
    fn conversion(&self, offset: u64) -> (String, u16) {
        let block = slice(self.file, self.bytes, offset, 46).unwrap_or_default();
        if offset == 0 || !block.starts_with(b"CC") {
            return (String::new(), u16::MAX);
        }
        (
            latin1(&block[22..42]).trim().to_owned(),
            self.u16(block, 42),
        )
    }

    /// The text of a TX block; empty where there is none.
    fn text(&self, offset: u64) -> String {
        let head = slice(self.file, self.bytes, offset, 4).unwrap_or_default();
        if offset == 0 || !head.starts_with(b"TX") {
            return String::new();
        }
        let length = u64::from(self.u16(head, 2)).max(4);
        let body = slice(self.file, self.bytes, offset + 4, length - 4);
        latin1(body.unwrap_or_default()).trim().to_owned()
    }

    fn start_time(&self, head: &[u8]) -> Option<StartTime> {
        let stamp = head.get(164..174).filter(|_| self.u16(head, 2) >= 208);
        if let Some(stamp) = stamp {
            let nanoseconds = i64::try_from(self.u64(stamp, 0)).ok().filter(|&n| n != 0);
            let hours = self.u16(stamp, 8).cast_signed();
            if let Some(nanoseconds) = nanoseconds {
                return Some(StartTime {
                    nanoseconds,
                    is_local: true,
                    utc_offset_min: (-14..=14).contains(&hours).then_some(i32::from(hours) * 60),
                });
            }
        }
        local_time(&latin1(&head[18..28]), &latin1(&head[28..36]))
    }

    fn field<const N: usize>(&self, block: &[u8], at: usize) -> [u8; N] {
        let mut field = [0; N];
        if let Some(bytes) = block.get(at..at + N) {
            field.copy_from_slice(bytes);
        }
        if self.big_endian {
            field.reverse();
        }
        field
    }

    fn u16(&self, block: &[u8], at: usize) -> u16 {
        u16::from_le_bytes(self.field(block, at))
    }

    fn u32(&self, block: &[u8], at: usize) -> u32 {
        u32::from_le_bytes(self.field(block, at))
    }

    fn u64(&self, block: &[u8], at: usize) -> u64 {
        u64::from_le_bytes(self.field(block, at))
    }

    fn link(&self, block: &[u8], at: usize) -> u64 {
        u64::from(self.u32(block, at))
    }
}

/// From `DD:MM:YYYY` and `HH:MM:SS`.
fn local_time(date: &str, time: &str) -> Option<StartTime> {
    let numbers = |text: &str| -> Option<[i64; 3]> {
        let parts: Result<Vec<i64>, _> = text.trim().split(':').map(str::parse).collect();
        parts.ok()?.try_into().ok()
    };
    let ([day, month, year], [hour, minute, second]) = (numbers(date)?, numbers(time)?);
    let in_range =
        (1..=31).contains(&day) && (1..=12).contains(&month) && (1900..2200).contains(&year);
    let seconds = days_since_1970(year, month, day) * 86_400 + hour * 3600 + minute * 60 + second;
    in_range.then_some(StartTime {
        nanoseconds: seconds * 1_000_000_000,
        is_local: true,
        utc_offset_min: None,
    })
}

/// Days since 1970-01-01 in the Gregorian calendar.
fn days_since_1970(year: i64, month: i64, day: i64) -> i64 {
    let shifted = if month <= 2 { year - 1 } else { year };
    let (era, of_era) = (shifted.div_euclid(400), shifted.rem_euclid(400));
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + day_of_year - 719_468
}
