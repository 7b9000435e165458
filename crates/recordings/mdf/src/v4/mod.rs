//! MDF 4: from blocks to groups and channels.

mod array;
mod block;
mod channel;
mod conversion;
mod converted;
mod data;
mod extras;
mod group;

use crate::bytes::{array, u8_at, u16_at};
use crate::model::{Finding, StartTime};
use crate::pages::Pages;
use crate::parts::Parts;
use crate::{MdfError, Source};
use block::{Block, Walk};
pub(crate) use channel::samples;

/// Bits of the identification block that say what a program did not bring up to date.
mod unfinished {
    pub(super) const CYCLES: u16 = 1;
    pub(super) const LAST_DATA_LENGTH: u16 = 1 << 2;
}

pub(crate) fn open<S: Source + ?Sized>(pages: Pages<'_, S>, id: &[u8], is_open: bool) -> Result<Parts, MdfError> {
    let flags = if is_open { u16_at(id, 60) } else { 0 };
    let mut walk = Walk::new(pages);
    let head = walk.own_block(64, &[b"##HD"])?;
    let mut parts = Parts { is_open, start_time: start_time(&head), ..Parts::default() };
    let comment = walk.text(head.link(5))?;
    parts.comment = (!comment.is_empty()).then_some(comment);
    let mut raws = Vec::new();
    let mut next = head.link(0);
    while next != 0 {
        let block = walk.own_block(next, &[b"##DG"])?;
        walk.data_group(&block, &mut parts, &mut raws)?;
        next = block.link(0);
    }
    if flags & unfinished::LAST_DATA_LENGTH != 0 {
        let data = parts.data.iter_mut().map(|d| &mut d.stream);
        walk.stretch_last(data.chain(parts.signals.iter_mut()));
    }
    group::connect(&mut parts.groups, &raws);
    let announced_is_stale = flags & unfinished::CYCLES != 0;
    group::count(&mut parts, &raws, announced_is_stale)?;
    parts.attachments = walk.attachments(head.link(3))?;
    parts.events = walk.events(head.link(4))?;
    parts.findings = std::mem::take(&mut walk.findings);
    if is_open {
        parts.findings.insert(0, Finding::NotFinalised);
    }
    Ok(parts)
}

fn start_time(head: &Block) -> Option<StartTime> {
    let data = head.data();
    let nanoseconds = i64::from_le_bytes(array(data, 0));
    let minutes = |at: usize| i32::from(i16::from_le_bytes(array(data, at)));
    let flags = u8_at(data, 12);
    (nanoseconds != 0).then_some(StartTime {
        nanoseconds,
        is_local: flags & 1 != 0,
        utc_offset_min: (flags & 2 != 0).then_some(minutes(8) + minutes(10)),
    })
}
