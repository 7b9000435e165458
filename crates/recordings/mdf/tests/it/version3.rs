//! Features of MDF 3, in files put together for it.

use mdf::{Address, Mdf, Values};
use work::Context;

/// A file under construction, in either byte order.
struct Made3 {
    bytes: Vec<u8>,
    big_endian: bool,
}

#[derive(Clone, Copy)]
struct Cn3 {
    is_time: bool,
    data_type: u16,
    start: u16,
    bits: u16,
    conversion: u32,
}

fn cn3(data_type: u16, start: u16, bits: u16) -> Cn3 {
    Cn3 { is_time: false, data_type, start, bits, conversion: 0 }
}

impl Made3 {
    fn new(big_endian: bool) -> Self {
        let mut bytes = vec![0; 64 + 164];
        bytes[..24].copy_from_slice(b"MDF     3.10    test    ");
        bytes[24] = u8::from(big_endian);
        bytes[64..66].copy_from_slice(b"HD");
        let mut made = Self { bytes, big_endian };
        made.put(66, 164_u16.to_le_bytes());
        made
    }

    fn put<const N: usize>(&mut self, at: usize, mut little: [u8; N]) {
        if self.big_endian {
            little.reverse();
        }
        self.bytes[at..at + N].copy_from_slice(&little);
    }

    fn block(&mut self, id: &[u8; 2], size: usize, links: &[(usize, u32)], words: &[(usize, u16)]) -> u32 {
        let offset = self.bytes.len();
        self.bytes.resize(offset + size, 0);
        self.bytes[offset..offset + 2].copy_from_slice(id);
        self.put(offset + 2, (size as u16).to_le_bytes());
        links.iter().for_each(|(at, link)| self.put(offset + at, link.to_le_bytes()));
        words.iter().for_each(|(at, word)| self.put(offset + at, word.to_le_bytes()));
        offset as u32
    }

    fn conversion(&mut self, code: u16, parameters: &[f64]) -> u32 {
        let count = parameters.len();
        let offset = self.block(b"CC", 46 + 8 * count, &[], &[(42, code), (44, count as u16)]);
        for (i, p) in parameters.iter().enumerate() {
            self.put(offset as usize + 46 + 8 * i, p.to_le_bytes());
        }
        offset
    }

    fn formula(&mut self, text: &str) -> u32 {
        let offset = self.block(b"CC", 46 + 256, &[], &[(42, 10)]);
        self.bytes[offset as usize + 46..][..text.len()].copy_from_slice(text.as_bytes());
        offset
    }

    fn group(&mut self, next: u32, id: u16, record: u16, cycles: u32, channels: &[Cn3]) -> u32 {
        let first = channels.iter().rev().fold(0, |next, cn| {
            let words = [(24, u16::from(cn.is_time)), (186, cn.start), (188, cn.bits), (190, cn.data_type)];
            self.block(b"CN", 228, &[(4, next), (8, cn.conversion)], &words)
        });
        let words = [(16, id), (18, channels.len() as u16), (20, record)];
        self.block(b"CG", 26, &[(4, next), (8, first), (22, cycles)], &words)
    }

    fn finish(mut self, groups: u32, identifiers: u16, records: &[u8]) -> Vec<u8> {
        let first = self.block(b"DG", 28, &[(8, groups)], &[(20, 1), (22, identifiers)]);
        let data = self.bytes.len() as u32;
        self.put(first as usize + 16, data.to_le_bytes());
        self.put(64 + 4, first.to_le_bytes());
        self.bytes.extend_from_slice(records);
        self.bytes
    }
}

fn numbers(bytes: &[u8], group: usize, channel: usize) -> Vec<f64> {
    let file = Mdf::open(bytes).unwrap();
    match file.read(&[Address { group, channel }], &Context::new()).unwrap().remove(0) {
        Values::Numbers(numbers) => numbers,
        other => panic!("{other:?}"),
    }
}

#[test]
fn exact_byte_orders_and_floats_of_vax() {
    for big_endian in [false, true] {
        let mut made = Made3::new(big_endian);
        // In the order of the file, in either order, and 1.0, −2.5 and 1.0 as VAX F, D and G.
        let channels = [cn3(0, 0, 16), cn3(9, 0, 16), cn3(13, 0, 16), cn3(4, 16, 32), cn3(6, 48, 64), cn3(5, 112, 64)];
        let group = made.group(0, 0, 22, 1, &channels);
        let vax = [&[0x80, 0x40, 0, 0][..], &[0x20, 0xC1, 0, 0, 0, 0, 0, 0], &[0x10, 0x40, 0, 0, 0, 0, 0, 0]].concat();
        let bytes = made.finish(group, 0, &[&[1, 2][..], &vax].concat());
        let read: Vec<f64> = (0..6).map(|c| numbers(&bytes, 0, c)[0]).collect();
        let own = if big_endian { 258.0 } else { 513.0 };
        assert_eq!(read, [own, 258.0, 513.0, 1.0, -2.5, 1.0]);
    }
}

#[test]
fn exact_records_of_two_groups_with_identifiers_around() {
    for identifiers in [1, 2] {
        let mut made = Made3::new(false);
        let slow = made.group(0, 7, 3, 2, &[Cn3 { is_time: true, ..cn3(0, 0, 8) }, cn3(1, 8, 16)]);
        let fast = made.group(slow, 9, 1, 3, &[cn3(0, 0, 8)]);
        let record = |id: u8, data: &[u8]| [&[id][..], data, &[id][..usize::from(identifiers == 2)]].concat();
        let records =
            [record(9, &[1]), record(7, &[10, 0xFF, 0xFF]), record(9, &[2]), record(9, &[3]), record(7, &[20, 5, 0])];
        let bytes = made.finish(fast, identifiers, &records.concat());
        assert_eq!(numbers(&bytes, 0, 0), [1.0, 2.0, 3.0]);
        assert_eq!((numbers(&bytes, 1, 0), numbers(&bytes, 1, 1)), (vec![10.0, 20.0], vec![-1.0, 5.0]));
        assert_eq!(Mdf::open(&bytes[..]).unwrap().groups()[1].found, Some(2));
        // Cut within the last record.
        let cut = &bytes[..bytes.len() - 1];
        assert_eq!((numbers(cut, 1, 1), Mdf::open(cut).unwrap().count(0)), (vec![-1.0], Ok(3)));
    }
}

/// The variable as the format writes it, and as asammdf 8.8.28 rewrites it; what else there is, is shown.
#[test]
fn exact_formulas_of_version_3() {
    let mut made = Made3::new(false);
    let formulas = ["X1*X1+3*X1", "X11*X11+3*X11", "X11+X1", "X2*3"];
    let channels = formulas.map(|text| Cn3 { conversion: made.formula(text), ..cn3(0, 0, 8) });
    let group = made.group(0, 0, 1, 1, &channels);
    let bytes = made.finish(group, 0, &[5]);
    assert_eq!([numbers(&bytes, 0, 0), numbers(&bytes, 0, 1)], [[40.0], [40.0]]);
    let file = Mdf::open(&bytes[..]).unwrap();
    for (channel, formula) in file.groups()[0].channels.iter().zip(formulas).skip(2) {
        let obstacle = channel.obstacle.as_ref().unwrap().to_string();
        assert_eq!(obstacle, format!("its conversion is not understood: the formula \"{formula}\""));
    }
}

#[test]
fn exact_conversions_of_version_3() {
    let mut made = Made3::new(false);
    let x = 3.0;
    let p = [2.0, 5.0, 0.5, 0.25, 1.0, 0.5, 0.0];
    let shifted: f64 = x - p[4] - p[5];
    let polynomial = (p[1] - p[3] * shifted) / (p[2] * shifted - p[0]);
    // exp and ln with P4 = 0, then with P1 = 0.
    let first = [2.0, 3.0, 1.0, 0.0, 0.0, 4.0, 0.5];
    let second = [0.0, 0.0, 9.0, 2.0, 3.0, 1.0, 0.5];
    let of_first: f64 = ((x - 0.5) * 4.0 - 1.0) / 2.0;
    let of_second: f64 = (9.0 / (x - 0.5) - 1.0) / 2.0;
    let conversions = [
        (made.conversion(6, &p[..6]), polynomial),
        (made.conversion(7, &first), of_first.ln() / 3.0),
        (made.conversion(8, &first), of_first.exp() / 3.0),
        (made.conversion(7, &second), of_second.ln() / 3.0),
        (made.conversion(8, &second), of_second.exp() / 3.0),
        (made.conversion(0, &[1.0, 4.0]), 13.0),
        (made.conversion(u16::MAX, &[]), x),
    ];
    let channels = conversions.map(|(conversion, _)| Cn3 { conversion, ..cn3(0, 0, 8) });
    let group = made.group(0, 0, 1, 1, &channels);
    let bytes = made.finish(group, 0, &[3]);
    for (channel, (_, expected)) in conversions.iter().enumerate() {
        assert_eq!(numbers(&bytes, 0, channel), [*expected], "{channel}");
    }
}
