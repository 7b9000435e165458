//! Data groups and channel groups.

use std::collections::HashMap;

use super::block::{Block, Walk};
use super::channel::Context;
use super::data::Found;
use crate::bytes::{u8_at, u16_at, u32_at, u64_at};
use crate::error::damaged;
use crate::model::{Address, Group, Master, Records};
use crate::parts::{Data, Parts};
use crate::{MdfError, Source};

/// Fields of the block of a group beyond [`Group`].
#[derive(Debug)]
pub(super) struct Raw {
    offset: u64,
    /// The group whose clock it uses.
    remote_master: u64,
    /// Bytes of its values, where it holds values of varying length.
    varying_bytes: u64,
}

const IS_VARYING: u16 = 1;
const HAS_REMOTE_MASTER: u16 = 1 << 3;
/// Records that no data stand for: a group of nothing but indices.
const MOST_WITHOUT_DATA: u64 = 1 << 24;

impl<S: Source + ?Sized> Walk<'_, S> {
    /// A data group with its channel groups, appended to `parts` and `raws`.
    pub(super) fn data_group(&mut self, block: &Block, parts: &mut Parts, raws: &mut Vec<Raw>) -> Result<(), MdfError> {
        let id_bytes = usize::from(u8_at(block.data(), 0));
        if id_bytes > 8 {
            return Err(damaged(block.offset, format!("identifiers of records are {id_bytes} bytes long")));
        }
        let Found { stream, invalid } = self.data(block.link(2), parts.is_open)?;
        let mut blocks = Vec::new();
        let mut next = block.link(1);
        while next != 0 {
            let group = self.own_block(next, &[b"##CG"])?;
            next = group.link(0);
            blocks.push(group);
        }
        let ids: HashMap<u64, u64> = blocks.iter().map(|b| (b.offset, u64_at(b.data(), 0))).collect();
        let data = parts.data.len();
        let first = parts.groups.len();
        for group in &blocks {
            let mut records = records(group, data);
            records.is_invalid_apart = invalid.is_some();
            let index = parts.groups.len();
            let group = self.group(group, records, &ids, parts, raws, index)?;
            parts.groups.push(group);
        }
        parts.data.push(Data {
            stream,
            invalid,
            id_bytes,
            is_mixed: blocks.len() > 1 || parts.groups[first..].iter().any(|g| g.records.is_varying),
            groups: (first..parts.groups.len()).collect(),
            ..Data::default()
        });
        Ok(())
    }

    fn group(
        &mut self,
        block: &Block,
        records: Records,
        ids: &HashMap<u64, u64>,
        parts: &mut Parts,
        raws: &mut Vec<Raw>,
        index: usize,
    ) -> Result<Group, MdfError> {
        let flags = u16_at(block.data(), 16);
        let data = block.data();
        raws.push(Raw {
            offset: block.offset,
            remote_master: if flags & HAS_REMOTE_MASTER != 0 { block.link(6) } else { 0 },
            // Of a group of values, the fields of a record's size hold the size of all values.
            varying_bytes: u64_at(data, 24),
        });
        let name = self.text(block.link(2))?;
        let comment = self.text(block.link(5))?;
        let mut context = Context { records: &records, ids, signals: &mut parts.signals, open: parts.is_open };
        let (channels, master) = self.channels(block.link(1), &mut context)?;
        let master = master.map(|(channel, quantity)| Master { address: Address { group: index, channel }, quantity });
        Ok(Group {
            name,
            comment,
            announced: u64_at(data, 8),
            found: None,
            at_most: 0,
            stream_bytes: 0,
            master,
            channels,
            records,
        })
    }
}

fn records(block: &Block, data: usize) -> Records {
    let bytes = block.data();
    let is_varying = u16_at(bytes, 16) & IS_VARYING != 0;
    Records {
        data,
        id: u64_at(bytes, 0),
        data_bytes: if is_varying { 0 } else { u32_at(bytes, 24) as usize },
        invalid_bytes: if is_varying { 0 } else { u32_at(bytes, 28) as usize },
        is_invalid_apart: false,
        is_varying,
    }
}

/// Gives groups that use the clock of another group that clock.
pub(super) fn connect(groups: &mut [Group], raws: &[Raw]) {
    let places: HashMap<u64, usize> = raws.iter().enumerate().map(|(i, r)| (r.offset, i)).collect();
    for (index, raw) in raws.iter().enumerate().filter(|(_, r)| r.remote_master != 0) {
        let of = |i: usize| groups.get(i).and_then(|g| g.master);
        groups[index].master = places.get(&raw.remote_master).copied().and_then(of);
    }
}

/// Finds out how many records the data of each group can hold.
pub(super) fn count(parts: &mut Parts, raws: &[Raw], announced_is_stale: bool) -> Result<(), MdfError> {
    for data in &parts.data {
        let length = data.stream.length;
        let mut announced_bytes = 0_u64;
        for &index in &data.groups {
            let group = &parts.groups[index];
            let framed = (group.records.record_bytes() + data.id_bytes) as u64;
            let records = match group.records.is_varying {
                true => group.announced.saturating_mul(framed + 4).saturating_add(raws[index].varying_bytes),
                false => group.announced.saturating_mul(framed),
            };
            announced_bytes = announced_bytes.saturating_add(records);
        }
        for &index in &data.groups {
            let group = &mut parts.groups[index];
            group.stream_bytes = length;
            group.found = match data.is_mixed {
                true => (announced_bytes == length && !announced_is_stale).then_some(group.announced),
                false => Some(alone(group, data, raws[index].offset)?),
            };
            group.at_most =
                group.found.unwrap_or(length / (group.records.record_bytes() + data.id_bytes).max(1) as u64);
        }
    }
    Ok(())
}

/// The records of a group that has its data for itself.
fn alone(group: &Group, data: &Data, offset: u64) -> Result<u64, MdfError> {
    let stride = (group.records.record_bytes() + data.id_bytes) as u64;
    if stride == 0 {
        return match group.announced {
            few @ 0..=MOST_WITHOUT_DATA => Ok(few),
            many => Err(damaged(offset, format!("{many} records without data"))),
        };
    }
    let whole = data.stream.length / stride;
    let invalid = data.invalid.as_ref().map(|stream| stream.length);
    let of_invalid = |bytes: u64| bytes.checked_div(group.records.invalid_bytes as u64);
    Ok(invalid.and_then(of_invalid).map_or(whole, |marked| whole.min(marked)))
}
