//! Features of the format, each in a file put together for it.

use mdf::{Address, Finding, Kind, Master, Mdf, Quantity, Source, Values};
use work::Context;

use crate::made::{Cg, Cn, Made, cn, numbers, one_group, read, texts, time};

#[test]
fn exact_integers_of_any_bits() {
    let raw: [u8; 10] = [0xA5, 0x3C, 0xF0, 0x0F, 0x81, 0x7E, 0x12, 0x34, 0x56, 0x78];
    let little = u128::from_le_bytes([&raw[..], &[0; 6]].concat().try_into().unwrap());
    let mut reversed = [&raw[..], &[0; 6]].concat();
    for (byte, bit, bits) in [(0, 3, 12), (0, 0, 1), (1, 7, 1), (0, 4, 64), (2, 0, 24), (3, 5, 33), (0, 0, 40)] {
        let field = |data_type| Cn { bit, ..cn(data_type, byte, bits) };
        let bytes = one_group(&[field(0), field(2), field(1), field(3)], &raw, 10, 0);
        let width = (u32::from(bit) + bits).div_ceil(8) as usize;
        reversed.clear();
        reversed.extend(raw[byte as usize..byte as usize + width].iter().rev());
        reversed.resize(16, 0);
        let big = u128::from_le_bytes(reversed.clone().try_into().unwrap());
        for (channel, wide) in [(0, little >> (8 * byte)), (2, big)] {
            let unsigned = (wide >> bit) & ((1 << bits) - 1);
            let sign = unsigned >> (bits - 1) & 1;
            let signed = unsigned as i128 - ((sign as i128) << bits);
            assert_eq!(numbers(&bytes, 0, channel), [unsigned as u64 as f64], "{byte} {bit} {bits}");
            assert_eq!(numbers(&bytes, 0, channel + 1), [signed as i64 as f64], "{byte} {bit} {bits}");
        }
    }
}

#[test]
fn exact_half_floats_and_dates() {
    // 1.5, -2, the smallest, infinity; a date of 2024-02-29 12:34, 1.5 s into the minute; a time one day after 1984.
    let date = [0xDC, 0x05, 34, 12, 29, 2, 24];
    let time = [0x10, 0x27, 0, 0, 1, 0];
    let halves = [0x3E00_u16, 0xC000, 0x0001, 0x7C00].map(u16::to_le_bytes).concat();
    let record = [&halves[..], &date, &time].concat();
    let halves = [0, 2, 4, 6].map(|byte| cn(4, byte, 16));
    let channels = [&halves[..], &[cn(13, 8, 56), cn(14, 15, 48)]].concat();
    let bytes = one_group(&channels, &record, 21, 0);
    let read: Vec<f64> = (0..6).map(|c| numbers(&bytes, 0, c)[0]).collect();
    let day = 86_400.0;
    let expected = [1.5, -2.0, 2.0_f64.powi(-24), f64::INFINITY, 1_709_210_041.5, 5114.0 * day + 10.0];
    assert_eq!(read, expected);
}

#[test]
fn exact_invalid_samples_are_nan() {
    let records: Vec<u8> = (0..6_u8).flat_map(|i| [i, 10 + i, (i % 2) | ((i % 3 / 2) << 1)]).collect();
    let marked = |byte, invalid_bit| Cn { flags: 2, invalid_bit, ..cn(0, byte, 8) };
    let never = Cn { flags: 1, ..cn(0, 0, 8) };
    let bytes = one_group(&[marked(0, 0), marked(1, 1), cn(0, 1, 8), never], &records, 2, 1);
    let is_nan = |c| numbers(&bytes, 0, c).iter().map(|n| n.is_nan()).collect::<Vec<_>>();
    assert_eq!(is_nan(0), [false, true, false, true, false, true]);
    assert_eq!(is_nan(1), [false, false, true, false, false, true]);
    assert_eq!((is_nan(2), is_nan(3)), (vec![false; 6], vec![true; 6]));
}

#[test]
fn exact_columns_with_invalid_bits_apart() {
    let mut made = Made::new(true, 0);
    let marked = Cn { flags: 2, invalid_bit: 3, ..cn(4, 0, 64) };
    let first = made.channels(&[marked]);
    let group = made.group(0, first, Cg { cycles: 5, data_bytes: 8, invalid_bytes: 1, ..Cg::default() });
    let values: Vec<u8> = (0..5).flat_map(|i| f64::from(i).to_le_bytes()).collect();
    let data = [made.block(b"##DV", &[], &values[..24]), made.block(b"##DV", &[], &values[24..])];
    let invalid = [made.block(b"##DI", &[], &[0, 8, 0]), made.block(b"##DI", &[], &[0, 8])];
    let list = [&0x8000_0000_u32.to_le_bytes()[..], &2_u32.to_le_bytes(), &[0; 16]].concat();
    let list = made.block(b"##LD", &[0, data[0], data[1], invalid[0], invalid[1]], &list);
    let first = made.data_group(group, list, 0);
    let read = numbers(&made.finish(first), 0, 0);
    assert!(read[1].is_nan() && read[4].is_nan());
    assert_eq!([read[0], read[2], read[3]], [0.0, 2.0, 3.0]);
}

/// Two groups and values of varying length in one stream: a record of each, in turn.
pub(crate) fn mixed(finished: bool, flags: u16, cycles: u64, places: [u64; 4]) -> Vec<u8> {
    let mut made = Made::new(finished, flags);
    let words = ["a", "", "longer", "ß"];
    let size = words.iter().map(|w| w.len() as u32).sum();
    let values = made.group(0, 0, Cg { id: 3, flags: 1, cycles, data_bytes: size, ..Cg::default() });
    let channels = made.channels(&[time(), Cn { kind: 1, link: values, ..cn(7, 8, 64) }]);
    let texts = made.group(values, channels, Cg { id: 1, cycles, data_bytes: 16, ..Cg::default() });
    let channels = made.channels(&[time(), cn(0, 8, 16)]);
    let counts = made.group(texts, channels, Cg { id: 2, cycles: 2 * cycles, data_bytes: 10, ..Cg::default() });
    let mut records = vec![];
    for (i, word) in words.iter().enumerate() {
        records.extend([&[3][..], &(word.len() as u32).to_le_bytes(), word.as_bytes()].concat());
        records.extend([&[1][..], &(i as f64).to_le_bytes(), &places[i].to_le_bytes()].concat());
        for half in [0.0, 0.5] {
            records.extend([&[2][..], &(i as f64 + half).to_le_bytes(), &(7 * i as u16).to_le_bytes()].concat());
        }
    }
    let group = made.data_group(counts, 0, 1);
    let data = made.block(b"##DT", &[], &records);
    let link = group as usize + 24 + 16;
    made.bytes[link..link + 8].copy_from_slice(&data.to_le_bytes());
    if !finished {
        // The length of the data was never written.
        let length = data as usize + 8;
        made.bytes[length..length + 8].copy_from_slice(&24_u64.to_le_bytes());
    }
    made.finish(group)
}

#[test]
fn exact_mixed_groups_and_values_between_them() {
    let places = [0, 5, 9, 19];
    let closed = mixed(true, 0, 4, places);
    let open = mixed(false, 0x25, 0, places);
    let stale = mixed(false, 0x65, 0, [0; 4]);
    for bytes in [&closed, &open, &stale] {
        assert_eq!(texts(bytes, 1, 1), ["a", "", "longer", "ß"]);
        assert_eq!(numbers(bytes, 0, 0), [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5]);
        assert_eq!(numbers(bytes, 0, 1), [0.0, 0.0, 7.0, 7.0, 14.0, 14.0, 21.0, 21.0]);
    }
    let file = Mdf::open(&closed[..]).unwrap();
    assert_eq!((file.groups()[0].found, file.groups()[1].found), (Some(8), Some(4)));
    let file = Mdf::open(&open[..]).unwrap();
    assert_eq!((file.groups()[0].found, file.count(0), file.count(1)), (None, Ok(8), Ok(4)));
    assert_eq!(file.findings(), [Finding::NotFinalised]);
}

#[test]
fn exact_open_files_are_read_to_their_end() {
    for cut in [0, 3, 8] {
        let bytes = mixed(false, 0x25, 0, [0, 5, 9, 19]);
        let cut = &bytes[..bytes.len() - cut];
        let expected = if bytes.len() == cut.len() { 8 } else { 7 };
        assert_eq!(numbers(cut, 0, 1).len(), expected);
    }
}

#[test]
fn exact_texts_of_varying_length_in_any_order() {
    let mut made = Made::new(true, 0);
    let words: [&[u8]; 3] = [b"one", b"\xC3\xA4", b""];
    let stream: Vec<u8> = words.iter().flat_map(|w| [&(w.len() as u32).to_le_bytes(), *w].concat()).collect();
    let values = made.block(b"##SD", &[], &stream);
    let first = made.channels(&[Cn { kind: 1, link: values, ..cn(7, 0, 64) }]);
    let group = made.group(0, first, Cg { cycles: 5, data_bytes: 8, ..Cg::default() });
    let places: Vec<u8> = [7_u64, 0, 13, 7, 0].iter().flat_map(|p| p.to_le_bytes()).collect();
    let data = made.block(b"##DT", &[], &places);
    let first = made.data_group(group, data, 0);
    assert_eq!(texts(&made.finish(first), 0, 0), ["ä", "one", "", "ä", "one"]);
}

#[test]
fn exact_texts_with_a_size_beside_them() {
    let mut made = Made::new(true, 0);
    let size = made.channel("size", cn(0, 0, 8), 0);
    let first = made.channel("text", Cn { kind: 5, link: size, ..cn(6, 1, 32) }, size);
    let group = made.group(0, first, Cg { cycles: 2, data_bytes: 5, ..Cg::default() });
    let data = made.block(b"##DT", &[], b"\x02abcd\x04\xE4fgh");
    let first = made.data_group(group, data, 0);
    assert_eq!(texts(&made.finish(first), 0, 0), ["ab", "äfgh"]);
}

#[test]
fn exact_conversions_of_texts_and_bits() {
    let mut made = Made::new(true, 0);
    let [on, off, other] = ["on", "off", "other"].map(|t| made.text(t));
    let bits = |x: f64| x.to_bits();
    let to_number = made.conversion(9, &[on, off], &[bits(1.0), bits(0.0), bits(-1.0)]);
    let to_text = made.conversion(10, &[on, off, off, on, other], &[]);
    let low = made.conversion(7, &[off, on, other], &[bits(0.0), bits(1.0)]);
    let high = made.conversion(7, &[off, on, other], &[bits(0.0), bits(2.0)]);
    let masks = made.conversion(11, &[low, high], &[1, 2]);
    let scale = made.conversion(1, &[], &[bits(5.0), bits(2.0)]);
    let partly = made.conversion(8, &[other, scale], &[bits(3.0), bits(3.0)]);
    let text = |conversion| Cn { conversion, ..cn(6, 0, 24) };
    let number = |conversion| Cn { conversion, ..cn(0, 3, 8) };
    let shift = made.conversion(1, &[], &[bits(100.0), bits(1.0)]);
    let pieces = made.conversion(8, &[shift, scale], &[bits(2.0), bits(3.0)]);
    let unscaled = made.conversion(7, &[other, 0], &[bits(1.0)]);
    let rest = made.conversion(0, &[], &[]);
    let mostly = made.conversion(7, &[other, rest], &[bits(1.0)]);
    let channels = [to_number, to_text].map(text);
    let channels = [&channels[..], &[masks, partly, pieces, unscaled, mostly].map(number)].concat();
    let first = made.channels(&channels);
    let group = made.group(0, first, Cg { cycles: 4, data_bytes: 4, ..Cg::default() });
    let data = made.block(b"##DT", &[], b"on\0\x00off\x01xyz\x02on\0\x03");
    let first = made.data_group(group, data, 0);
    let bytes = made.finish(first);
    assert_eq!(numbers(&bytes, 0, 0), [1.0, 0.0, -1.0, 1.0]);
    assert_eq!(texts(&bytes, 0, 1), ["off", "on", "other", "off"]);
    assert_eq!(texts(&bytes, 0, 2), ["off|off", "on|off", "off|on", "on|on"]);
    // Among scaled numbers, a text is a number that is missing.
    let partly = numbers(&bytes, 0, 3);
    assert!(partly[..3] == [5.0, 7.0, 9.0] && partly[3].is_nan(), "{partly:?}");
    assert_eq!(numbers(&bytes, 0, 4), [5.0, 7.0, 102.0, 103.0]);
    assert_eq!(texts(&bytes, 0, 5), ["", "other", "", ""]);
    assert_eq!(texts(&bytes, 0, 6), ["0", "other", "2", "3"]);
}

#[test]
fn exact_elements_of_arrays() {
    let mut made = Made::new(true, 0);
    let array = |made: &mut Made, flags: u32| {
        let mut data = vec![0, 0, 2, 0];
        data.extend_from_slice(&flags.to_le_bytes());
        data.extend_from_slice(&[2_i32.to_le_bytes(), 0_i32.to_le_bytes()].concat());
        data.extend_from_slice(&[2_u64.to_le_bytes(), 3_u64.to_le_bytes()].concat());
        made.block(b"##CA", &[0], &data)
    };
    let (rows, columns) = (array(&mut made, 0), array(&mut made, 1 << 6));
    let map = |composition| Cn { composition, ..cn(0, 0, 16) };
    let first = made.channels(&[map(rows), map(columns)]);
    let group = made.group(0, first, Cg { cycles: 1, data_bytes: 12, ..Cg::default() });
    let record: Vec<u8> = (0..6_u16).flat_map(u16::to_le_bytes).collect();
    let data = made.block(b"##DT", &[], &record);
    let first = made.data_group(group, data, 0);
    let bytes = made.finish(first);
    let file = Mdf::open(&bytes[..]).unwrap();
    let channels = &file.groups()[0].channels;
    let names: Vec<&str> = channels.iter().map(|c| &*c.name).take(6).collect();
    assert_eq!(names, ["c0[0][0]", "c0[0][1]", "c0[0][2]", "c0[1][0]", "c0[1][1]", "c0[1][2]"]);
    let values: Vec<f64> = (0..12).map(|c| numbers(&bytes, 0, c)[0]).collect();
    assert_eq!(values, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 0.0, 2.0, 4.0, 1.0, 3.0, 5.0]);
}

#[test]
fn exact_virtual_channels_and_bytes() {
    let master = Cn { kind: 3, sync: 1, ..Cn::default() };
    let bytes = one_group(&[master, cn(10, 0, 16)], &[1, 2, 3, 4], 2, 0);
    assert_eq!(numbers(&bytes, 0, 0), [0.0, 1.0]);
    assert_eq!(Mdf::open(&bytes[..]).unwrap().groups()[0].channels[1].kind, Kind::Bytes);
    assert!(matches!(read(&bytes, 0, 1), Values::Bytes(b) if b.get(1) == [3, 4]));
}

pub(crate) fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(vec![], flate2::Compression::fast());
    std::io::Write::write_all(&mut encoder, bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn exact_transposed_blocks_of_any_size_and_place() {
    let rows = 3_000_000_usize;
    let record = |row: usize| [&(row as f64).to_le_bytes()[..], &(row as u32).to_be_bytes()].concat();
    let records: Vec<u8> = (0..rows).flat_map(record).collect();
    // The second block begins within a record; the first is larger than what is inflated at once.
    let cut = 2_000_001 * 12 + 5;
    let packed = |part: &[u8], transposed: bool| {
        let whole = part.len() / 12;
        let mut bytes = part.to_vec();
        if transposed {
            (0..whole * 12).for_each(|i| bytes[i % 12 * whole + i / 12] = part[i]);
        }
        let deflated = deflated(&bytes);
        let mut data = vec![b'D', b'T', u8::from(transposed), 0, 12, 0, 0, 0];
        data.extend_from_slice(&(part.len() as u64).to_le_bytes());
        data.extend_from_slice(&(deflated.len() as u64).to_le_bytes());
        [data, deflated].concat()
    };
    for (first, second) in [(true, true), (false, true), (true, false)] {
        let mut made = Made::new(true, 0);
        let channels = made.channels(&[time(), cn(1, 8, 32)]);
        let group = made.group(0, channels, Cg { cycles: rows as u64, data_bytes: 12, ..Cg::default() });
        let parts = [packed(&records[..cut], first), packed(&records[cut..], second)];
        let blocks = parts.map(|data| made.block(b"##DZ", &[], &data));
        let list = [&[0; 4][..], &2_u32.to_le_bytes(), &[0; 16]].concat();
        let list = made.block(b"##DL", &[0, blocks[0], blocks[1]], &list);
        let list = made.block(b"##HL", &[list], &[0; 8]);
        let first = made.data_group(group, list, 0);
        let bytes = made.finish(first);
        for channel in [0, 1] {
            let read = numbers(&bytes, 0, channel);
            assert!(read.len() == rows && read.iter().enumerate().all(|(i, &n)| n == i as f64));
        }
    }
}

/// 0, 3, …, 117, forty times 0, forty times 7.
pub(crate) fn stored() -> Vec<u8> {
    (0..120).map(|i| if i < 40 { 3 * i } else { 7 * u8::from(i >= 80) }).collect()
}

/// [`stored`] as compressed by zstd 1.5.7 and lz4 1.10 (frames).
pub(crate) const ZSTANDARD: &[u8] = b"\x28\xb5\x2f\xfd\x20\x78\x9d\x01\x00\xa4\x02\x00\x03\x06\x09\x0c\x0f\x12\x15\x18\x1b\
    \x1e\x21\x24\x27\x2a\x2d\x30\x33\x36\x39\x3c\x3f\x42\x45\x48\x4b\x4e\x51\x54\x57\x5a\x5d\x60\x63\x66\x69\x6c\x6f\x72\x75\x00\
    \x07\x02\x00\x40\x29\xa2\x04\x65";
pub(crate) const LZ4: &[u8] = b"\x04\x22\x4d\x18\x6c\x40\x78\x00\x00\x00\x00\x00\x00\x00\x01\x39\x00\x00\x00\xff\x1a\x00\
    \x03\x06\x09\x0c\x0f\x12\x15\x18\x1b\x1e\x21\x24\x27\x2a\x2d\x30\x33\x36\x39\x3c\x3f\x42\x45\x48\x4b\x4e\x51\x54\x57\x5a\x5d\
    \x60\x63\x66\x69\x6c\x6f\x72\x75\x00\x01\x00\x14\x1f\x07\x01\x00\x0f\x50\x07\x07\x07\x07\x07\x00\x00\x00\x00\x8d\x08\xa1\x09";

/// A file of one block of 120 packed bytes, transposed for records of three where the code of the compression is odd.
pub(crate) fn one_packed(code: u8, packed: &[u8]) -> Vec<u8> {
    let mut made = Made::new(true, 0);
    let channels = made.channels(&[cn(0, 0, 16), cn(0, 2, 8)]);
    let group = made.group(0, channels, Cg { cycles: 40, data_bytes: 3, ..Cg::default() });
    let head = [b'D', b'T', code, 0, 3, 0, 0, 0];
    let data = [&head[..], &120_u64.to_le_bytes(), &(packed.len() as u64).to_le_bytes(), packed].concat();
    let data = made.block(b"##DZ", &[], &data);
    let first = made.data_group(group, data, 0);
    made.finish(first)
}

/// Deflated data end with the sum of what they become (RFC 1950).
#[test]
fn exact_sums_of_deflated_data_are_compared() {
    let mut packed = deflated(&[7; 120]);
    assert_eq!(numbers(&one_packed(0, &packed), 0, 1), [7.0; 40]);
    let last = packed.len() - 1;
    packed[last] ^= 1;
    // Of transposed records the first channel alone comes before what is damaged.
    for (code, channel) in [(0, 1), (1, 1), (1, 0)] {
        let made = one_packed(code, &packed);
        let read = Mdf::open(&made[..]).unwrap().read(&[Address { group: 0, channel }], &Context::new());
        assert!(matches!(read, Err(mdf::MdfError::Damaged { .. })), "{read:?}");
    }
}

#[test]
fn regress_records_of_no_bytes_are_not_transposed() {
    let mut made = one_packed(1, &deflated(&[7; 120]));
    let block = made.windows(4).position(|bytes| bytes == b"##DZ").unwrap();
    made[block + 28..block + 32].fill(0);
    let error = Mdf::open(&made[..]).unwrap_err().to_string();
    assert!(error.contains("transposed for records of no bytes"), "{error}");
}

#[test]
fn exact_sizes_of_deflated_data_are_compared() {
    for (size, says) in [(119, "120 bytes are announced, the packed data hold 119"), (121, "more than the 120 bytes")] {
        let made = one_packed(0, &deflated(&vec![7; size]));
        let file = Mdf::open(&made[..]).unwrap();
        let error = file.read(&[Address { group: 0, channel: 1 }], &Context::new()).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
}

/// The sum of what [`ZSTANDARD`] becomes: the low half of its XXH64.
const SUM: [u8; 4] = [0xDD, 0x47, 0xAE, 0xBD];

/// A frame of Zstandard may end with the sum of its content, and may say how long that is.
#[test]
fn exact_sums_and_sizes_of_zstandard_are_compared() {
    let mut packed = ZSTANDARD.to_vec();
    packed[4] |= 4;
    packed.extend(SUM);
    let read = |packed: &[u8]| {
        let made = one_packed(2, packed);
        let file = Mdf::open(&made[..])?;
        file.read(&[Address { group: 0, channel: 0 }, Address { group: 0, channel: 1 }], &Context::new())
    };
    assert_eq!(read(&packed).unwrap(), read(ZSTANDARD).unwrap());
    let last = packed.len() - 1;
    packed[last] ^= 1;
    assert!(read(&packed).unwrap_err().to_string().contains("checksum"));
    // One byte says 119 where the block says 120.
    let mut short = ZSTANDARD.to_vec();
    short[5] -= 1;
    assert!(matches!(read(&short), Err(mdf::MdfError::Damaged { .. })));
}

#[test]
fn exact_blocks_of_every_compression() {
    let stored = stored();
    let deflated = deflated(&stored);
    for (code, bytes) in [(0, &deflated[..]), (1, &deflated), (2, ZSTANDARD), (3, ZSTANDARD), (4, LZ4), (5, LZ4)] {
        let at = |row: usize, byte: usize| stored[if code % 2 == 1 { byte * 40 + row } else { 3 * row + byte }];
        let whole = one_packed(code, bytes);
        let low: Vec<f64> = (0..40).map(|r| f64::from(u16::from_le_bytes([at(r, 0), at(r, 1)]))).collect();
        let high: Vec<f64> = (0..40).map(|r| f64::from(at(r, 2))).collect();
        assert_eq!((numbers(&whole, 0, 0), numbers(&whole, 0, 1)), (low, high), "{code}");
        // Cut short before the marks at its end.
        for length in 0..bytes.len() - 8 {
            let cut = one_packed(code, &bytes[..length]);
            if let Ok(cut) = Mdf::open(&cut[..]) {
                assert!(cut.read(&[Address { group: 0, channel: 1 }], &Context::new()).is_err(), "{code} {length}");
            }
        }
    }
}

#[test]
fn exact_clock_of_another_group_from_a_file_on_disk() {
    let mut made = Made::new(true, 0);
    let clock = made.channels(&[time()]);
    let clock = made.group(0, clock, Cg { cycles: 3, data_bytes: 8, ..Cg::default() });
    let stamps: Vec<u8> = [0.5_f64, 1.5, 2.5].iter().flat_map(|t| t.to_le_bytes()).collect();
    let stamps = made.block(b"##DV", &[], &stamps);
    let values = made.channels(&[cn(2, 0, 8)]);
    let values = made.group(0, values, Cg { cycles: 3, flags: 8, data_bytes: 1, master: clock, ..Cg::default() });
    let bytes = made.block(b"##DV", &[], &[1, 0xFF, 3]);
    let second = made.data_group(values, bytes, 0);
    let first = made.data_group_before(second, clock, stamps, 0);
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("clock.mf4");
    std::fs::write(&path, made.finish(first)).unwrap();
    let file = Mdf::open(std::fs::File::open(&path).unwrap()).unwrap();
    let master = Master { address: Address { group: 0, channel: 0 }, quantity: Quantity::Time };
    assert_eq!(file.groups()[1].master, Some(master));
    let read = file.read(&[Address { group: 1, channel: 0 }, master.address], &Context::new()).unwrap();
    assert_eq!(read, [Values::Numbers(vec![1.0, -1.0, 3.0]), Values::Numbers(vec![0.5, 1.5, 2.5])]);
}

/// A file with a hole of zeros at a place.
struct Sparse {
    bytes: Vec<u8>,
    at: u64,
    hole: u64,
}

impl Source for Sparse {
    fn size(&self) -> std::io::Result<u64> {
        Ok(self.bytes.len() as u64 + self.hole)
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> std::io::Result<()> {
        buffer.fill(0);
        let (before, after) = self.bytes.split_at(self.at as usize);
        for (place, part) in [(0, before), (self.at + self.hole, after)] {
            let (start, end) = (offset.max(place), (offset + buffer.len() as u64).min(place + part.len() as u64));
            if start < end {
                let to = &mut buffer[(start - offset) as usize..(end - offset) as usize];
                to.copy_from_slice(&part[(start - place) as usize..(end - place) as usize]);
            }
        }
        Ok(())
    }
}

/// Offsets and data of more than 2^32 bytes: 4200 records of zeros between two, and all else behind them.
#[test]
fn exact_files_of_more_than_four_gigabytes() {
    let record = 1 << 20;
    let (data_bytes, hole) = (record as u32, 4200 * record as u64);
    let mut made = Made::new(true, 0);
    let mut records = vec![0; 2 * record];
    records[..2].copy_from_slice(&513_u16.to_le_bytes());
    records[2 * record - 1] = 7;
    let data = made.block(b"##DT", &[], &records);
    // After the head of the block, where its length is, and the first record.
    let at = data as usize + 24 + record;
    made.bytes[data as usize + 8..][..8].copy_from_slice(&(24 + 2 * record as u64 + hole).to_le_bytes());
    made.hole = hole;
    let channels = made.channels(&[cn(0, 0, 16), cn(0, data_bytes - 1, 8)]);
    let group = made.group(0, channels, Cg { cycles: 4202, data_bytes, ..Cg::default() });
    let packed = deflated(&[5; 40]);
    let head = [&[b'D', b'T', 0, 0, 0, 0, 0, 0][..], &40_u64.to_le_bytes(), &(packed.len() as u64).to_le_bytes()];
    let packed = made.block(b"##DZ", &[], &[&head.concat(), &packed[..]].concat());
    let channels = made.channels(&[cn(0, 0, 8)]);
    let after = made.group(0, channels, Cg { cycles: 40, data_bytes: 1, ..Cg::default() });
    let after = made.data_group(after, packed, 0);
    let first = made.data_group_before(after, group, data, 0);
    let file = Mdf::open(Sparse { bytes: made.finish(first), at: at as u64, hole }).unwrap();
    let addresses = [(0, 0), (0, 1), (1, 0)].map(|(group, channel)| Address { group, channel });
    let read = file.read(&addresses, &Context::new()).unwrap();
    let zeros = vec![0.0; 4201];
    let ends = [[&[513.0], &zeros[..]].concat(), [&zeros[..], &[7.0]].concat(), vec![5.0; 40]];
    assert_eq!(read, ends.map(Values::Numbers));
}

/// Which integers are too large for a double is told, before they are converted.
#[test]
fn exact_rounded_integers_are_told() {
    let channels = [cn(0, 0, 64), cn(0, 8, 64), cn(0, 0, 53)];
    let records: Vec<u8> = [(1_u64 << 53) + 1, 5, 7, (1 << 53) - 1].into_iter().flat_map(u64::to_le_bytes).collect();
    let made = one_group(&channels, &records, 16, 0);
    let file = Mdf::open(&made[..]).unwrap();
    let all = [0, 1, 2].map(|channel| Address { group: 0, channel });
    assert!(file.rounded().is_empty());
    file.read(&all, &Context::new()).unwrap();
    assert_eq!(file.rounded(), [all[0]]);
}
