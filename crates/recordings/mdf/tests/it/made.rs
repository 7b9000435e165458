//! Files of MDF 4 put together block by block.

use mdf::{Address, Mdf, Values};
use work::Context;

/// A file under construction; the header comes last, since it refers to the data groups.
pub(crate) struct Made {
    pub(crate) bytes: Vec<u8>,
    /// Bytes that lie between what there is and the blocks to come, in a file that is not held in memory whole.
    pub(crate) hole: u64,
}

/// Fields of a channel block; the rest is zero.
#[derive(Clone, Copy, Default)]
pub(crate) struct Cn {
    pub(crate) kind: u8,
    pub(crate) sync: u8,
    pub(crate) data_type: u8,
    pub(crate) bit: u8,
    pub(crate) byte: u32,
    pub(crate) bits: u32,
    pub(crate) flags: u32,
    pub(crate) invalid_bit: u32,
    pub(crate) composition: u64,
    pub(crate) conversion: u64,
    pub(crate) link: u64,
}

pub(crate) fn cn(data_type: u8, byte: u32, bits: u32) -> Cn {
    Cn { data_type, byte, bits, ..Cn::default() }
}

/// A time master of eight bytes at the start of the record.
pub(crate) fn time() -> Cn {
    Cn { kind: 2, sync: 1, ..cn(4, 0, 64) }
}

impl Made {
    pub(crate) fn new(finished: bool, flags: u16) -> Self {
        let mut bytes = vec![0; 64 + 104];
        bytes[..24].copy_from_slice(if finished { b"MDF     4.20    test    " } else { b"UnFinMF 4.20    test    " });
        bytes[28..30].copy_from_slice(&420_u16.to_le_bytes());
        bytes[60..62].copy_from_slice(&flags.to_le_bytes());
        Self { bytes, hole: 0 }
    }

    pub(crate) fn block(&mut self, id: &[u8; 4], links: &[u64], data: &[u8]) -> u64 {
        self.bytes.resize(self.bytes.len().next_multiple_of(8), 0);
        let offset = self.hole + self.bytes.len() as u64;
        self.bytes.extend_from_slice(&head(id, links, data.len()));
        self.bytes.extend_from_slice(data);
        offset
    }

    pub(crate) fn text(&mut self, text: &str) -> u64 {
        self.block(b"##TX", &[], format!("{text}\0").as_bytes())
    }

    pub(crate) fn conversion(&mut self, kind: u8, references: &[u64], values: &[u64]) -> u64 {
        let mut data = vec![kind, 0, 0, 0];
        data.extend_from_slice(&(references.len() as u16).to_le_bytes());
        data.extend_from_slice(&(values.len() as u16).to_le_bytes());
        data.extend_from_slice(&[0; 16]);
        values.iter().for_each(|v| data.extend_from_slice(&v.to_le_bytes()));
        let links = [&[0, 0, 0, 0], references].concat();
        self.block(b"##CC", &links, &data)
    }

    pub(crate) fn channel(&mut self, name: &str, cn: Cn, next: u64) -> u64 {
        let name = self.text(name);
        let mut data = [0; 72];
        data[..4].copy_from_slice(&[cn.kind, cn.sync, cn.data_type, cn.bit]);
        data[4..8].copy_from_slice(&cn.byte.to_le_bytes());
        data[8..12].copy_from_slice(&cn.bits.to_le_bytes());
        data[12..16].copy_from_slice(&cn.flags.to_le_bytes());
        data[16..20].copy_from_slice(&cn.invalid_bit.to_le_bytes());
        self.block(b"##CN", &[next, cn.composition, name, 0, cn.conversion, cn.link, 0, 0], &data)
    }

    /// Channels named `c0`, `c1`, … in a chain; the place of the first.
    pub(crate) fn channels(&mut self, channels: &[Cn]) -> u64 {
        let all = channels.iter().enumerate().rev();
        all.fold(0, |next, (i, cn)| self.channel(&format!("c{i}"), *cn, next))
    }

    pub(crate) fn group(&mut self, next: u64, channels: u64, cg: Cg) -> u64 {
        let mut data = [0; 32];
        data[..8].copy_from_slice(&cg.id.to_le_bytes());
        data[8..16].copy_from_slice(&cg.cycles.to_le_bytes());
        data[16..18].copy_from_slice(&cg.flags.to_le_bytes());
        data[24..28].copy_from_slice(&cg.data_bytes.to_le_bytes());
        data[28..32].copy_from_slice(&cg.invalid_bytes.to_le_bytes());
        self.block(b"##CG", &[next, channels, 0, 0, 0, 0, cg.master], &data)
    }

    pub(crate) fn data_group(&mut self, groups: u64, data: u64, id_bytes: u8) -> u64 {
        self.data_group_before(0, groups, data, id_bytes)
    }

    pub(crate) fn data_group_before(&mut self, next: u64, groups: u64, data: u64, id_bytes: u8) -> u64 {
        self.block(b"##DG", &[next, groups, data, 0], &[id_bytes, 0, 0, 0, 0, 0, 0, 0])
    }

    pub(crate) fn finish(mut self, first: u64) -> Vec<u8> {
        let header = head(b"##HD", &[first, 0, 0, 0, 0, 0], 32);
        self.bytes[64..64 + header.len()].copy_from_slice(&header);
        self.bytes
    }
}

#[derive(Clone, Copy, Default)]
pub(crate) struct Cg {
    pub(crate) id: u64,
    pub(crate) cycles: u64,
    pub(crate) flags: u16,
    pub(crate) data_bytes: u32,
    pub(crate) invalid_bytes: u32,
    /// The group whose clock is used.
    pub(crate) master: u64,
}

fn head(id: &[u8; 4], links: &[u64], data: usize) -> Vec<u8> {
    let mut head = [&id[..], &[0; 4]].concat();
    head.extend_from_slice(&((24 + links.len() * 8 + data) as u64).to_le_bytes());
    head.extend_from_slice(&(links.len() as u64).to_le_bytes());
    links.iter().for_each(|link| head.extend_from_slice(&link.to_le_bytes()));
    head
}

/// A file with one group of these channels on these records.
pub(crate) fn one_group(channels: &[Cn], records: &[u8], data_bytes: u32, invalid_bytes: u32) -> Vec<u8> {
    let mut made = Made::new(true, 0);
    let first = made.channels(channels);
    let cycles = records.len() as u64 / u64::from(data_bytes + invalid_bytes);
    let group = made.group(0, first, Cg { cycles, data_bytes, invalid_bytes, ..Cg::default() });
    let data = made.block(b"##DT", &[], records);
    let first = made.data_group(group, data, 0);
    made.finish(first)
}

/// The samples of a channel.
pub(crate) fn read(bytes: &[u8], group: usize, channel: usize) -> Values {
    let file = Mdf::open(bytes).unwrap();
    file.read(&[Address { group, channel }], &Context::new()).unwrap().remove(0)
}

pub(crate) fn numbers(bytes: &[u8], group: usize, channel: usize) -> Vec<f64> {
    match read(bytes, group, channel) {
        Values::Numbers(numbers) => numbers,
        other => panic!("{other:?}"),
    }
}

pub(crate) fn texts(bytes: &[u8], group: usize, channel: usize) -> Vec<String> {
    match read(bytes, group, channel) {
        Values::Text(texts) => texts.iter().map(str::to_owned).collect(),
        other => panic!("{other:?}"),
    }
}
