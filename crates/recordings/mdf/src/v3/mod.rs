//! MDF 2 and 3: from blocks to groups and channels.

mod block;
mod channel;
mod conversion;

use std::sync::Arc;

use jiff::civil::Date;

use crate::error::damaged;
use crate::model::{Address, Event, Finding, Group, Master, Quantity, Records, StartTime};
use crate::pages::Pages;
use crate::parts::{Data, Parts};
use crate::stream::{Packing, Stream};
use crate::{MdfError, Source};
use block::{Block, Walk};
use channel::Defaults;

/// Where the data of a data group are, and how its records are set apart.
struct DataGroup {
    offset: u64,
    identifiers: u16,
    first: usize,
}

pub(crate) fn open<S: Source + ?Sized>(
    pages: Pages<'_, S>,
    id: &[u8],
    version: u16,
    is_open: bool,
) -> Result<Parts, MdfError> {
    let big_endian = id[24] != 0 || id[25] != 0;
    let defaults = Defaults { big_endian, float_format: id[26].max(id[27]) };
    let mut walk = Walk::new(pages, big_endian);
    let head = walk.own_block(64, b"HD", 164)?;
    let mut parts = Parts { is_open, start_time: start_time(&head, version), ..Parts::default() };
    let comment = walk.text(head.link(8))?;
    parts.comment = (!comment.is_empty()).then_some(comment);
    let mut data_groups = Vec::new();
    let mut next = head.link(4);
    while next != 0 {
        let block = walk.own_block(next, b"DG", 24)?;
        let first = parts.groups.len();
        walk.channel_groups(block.link(8), data_groups.len(), defaults, &mut parts)?;
        walk.triggers(block.link(12), &mut parts.events)?;
        data_groups.push(DataGroup { offset: block.link(16), identifiers: block.u16(22), first });
        next = block.link(4);
    }
    for (index, group) in data_groups.iter().enumerate() {
        let end = data_groups.get(index + 1).map_or(parts.groups.len(), |next| next.first);
        walk.data(group, group.first..end, &mut parts)?;
    }
    if is_open {
        parts.findings.insert(0, Finding::NotFinalised);
    }
    Ok(parts)
}

impl<S: Source + ?Sized> Walk<'_, S> {
    fn channel_groups(
        &mut self,
        first: u64,
        data: usize,
        defaults: Defaults,
        parts: &mut Parts,
    ) -> Result<(), MdfError> {
        let mut next = first;
        while next != 0 {
            let block = self.own_block(next, b"CG", 26)?;
            let records = Records {
                data,
                id: u64::from(block.u16(16)),
                data_bytes: usize::from(block.u16(20)),
                ..Records::default()
            };
            let (channels, master) = self.channels(block.link(8), &records, defaults)?;
            let group = parts.groups.len();
            let address = |channel| Address { group, channel };
            parts.groups.push(Group {
                name: Arc::from(""),
                comment: self.text(block.link(12))?,
                announced: u64::from(block.u32(22)),
                found: None,
                at_most: 0,
                stream_bytes: 0,
                master: master.map(|m| Master { address: address(m), quantity: Quantity::Time }),
                channels,
                records,
            });
            next = block.link(4);
        }
        Ok(())
    }

    fn triggers(&mut self, link: u64, events: &mut Vec<Event>) -> Result<(), MdfError> {
        if link == 0 {
            return Ok(());
        }
        let block = self.own_block(link, b"TR", 10)?;
        let comment = self.text(block.link(4))?;
        let count = usize::from(block.u16(8)).min(block.len().saturating_sub(10) / 24);
        events.extend((0..count).map(|i| Event {
            name: Arc::from(""),
            comment: comment.clone(),
            kind: 5,
            quantity: Some(Quantity::Time),
            at: block.f64(10 + 24 * i),
        }));
        Ok(())
    }

    /// Finds out where the records of a data group end, and how many there are.
    fn data(&self, from: &DataGroup, range: std::ops::Range<usize>, parts: &mut Parts) -> Result<(), MdfError> {
        let (id_bytes, trailing) = match from.identifiers {
            0 => (0, 0),
            1 => (1, 0),
            2 => (1, 1),
            other => return Err(damaged(from.offset, format!("{other} identifiers in each record"))),
        };
        let groups = &mut parts.groups[range.clone()];
        let stride = |group: &Group| (group.records.data_bytes + id_bytes + trailing) as u64;
        let announced: u64 = groups.iter().map(|g| g.announced.saturating_mul(stride(g))).fold(0, u64::saturating_add);
        let available = self.end_of_data(from.offset).saturating_sub(from.offset);
        let is_unknown = parts.is_open && announced == 0;
        let length = if is_unknown { available } else { announced.min(available) };
        if announced > available {
            parts.findings.push(Finding::CutOff { offset: from.offset.saturating_add(available) });
        }
        let is_mixed = groups.len() > 1;
        for group in groups {
            group.stream_bytes = length;
            group.found = match (is_mixed, stride(group)) {
                (true, _) => (length == announced && !is_unknown).then_some(group.announced),
                (false, 0) if group.announced == 0 => Some(0),
                (false, 0) => return Err(damaged(from.offset, "records without data")),
                (false, stride) => Some(length / stride),
            };
            group.at_most = group.found.unwrap_or(length / stride(group).max(1));
        }
        let mut stream = Stream::default();
        stream.push(from.offset, length, length, Packing::Plain);
        parts.data.push(Data { stream, id_bytes, trailing, is_mixed, groups: range.collect(), ..Data::default() });
        Ok(())
    }
}

fn start_time(head: &Block, version: u16) -> Option<StartTime> {
    if version >= 320 && head.len() >= 208 {
        let nanoseconds = i64::try_from(head.u64(164)).ok().filter(|&n| n != 0);
        let hours = i32::from(head.u16(172).cast_signed());
        if let Some(nanoseconds) = nanoseconds {
            let utc_offset_min = (-14..=14).contains(&hours).then_some(hours * 60);
            return Some(StartTime { nanoseconds, is_local: true, utc_offset_min });
        }
    }
    local_time(&head.text(18, 10), &head.text(28, 8))
}

/// From `DD:MM:YYYY` and `HH:MM:SS`.
fn local_time(date: &str, time: &str) -> Option<StartTime> {
    let numbers = |text: &str| -> Option<[i64; 3]> {
        let parts: Result<Vec<i64>, _> = text.trim().split(':').map(str::parse).collect();
        parts.ok()?.try_into().ok()
    };
    let ([day, month, year], [hour, minute, second]) = (numbers(date)?, numbers(time)?);
    let date = Date::new(year.try_into().ok()?, month.try_into().ok()?, day.try_into().ok()?).ok()?;
    let is_date = (1900..2200).contains(&year);
    let is_time = (0..24).contains(&hour) && (0..60).contains(&minute) && (0..=60).contains(&second);
    let midnight = date.duration_since(Date::constant(1970, 1, 1)).as_secs();
    let nanoseconds = || (midnight + hour * 3600 + minute * 60 + second) * 1_000_000_000;
    (is_date && is_time).then(|| StartTime { nanoseconds: nanoseconds(), is_local: true, utc_offset_min: None })
}
