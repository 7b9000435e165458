//! Files that are damaged, or made to do harm.

use mdf::{Address, Mdf, MdfError};
use proptest::collection::vec;
use proptest::prelude::*;
use work::Context;

use crate::features::{LZ4, ZSTANDARD, deflated, one_packed, stored};
use crate::made::{Cg, Cn, Made, cn, one_group, time};

const OTHERS: [&[u8]; 4] = [
    include_bytes!("../../../recording/tests/it/data/small.mdf"),
    include_bytes!("../../../recording/tests/it/data/small.mf4"),
    include_bytes!("../../../recording/tests/it/data/mixed.mdf"),
    include_bytes!("../../../recording/tests/it/data/duplicates.mdf"),
];

/// Opens, counts and reads everything; what comes out has to be in proportion to the file.
fn exercise(bytes: &[u8]) {
    let Ok(file) = Mdf::open(bytes) else { return };
    for (group, info) in file.groups().iter().enumerate() {
        let _ = file.count(group);
        for (channel, about) in info.channels.iter().enumerate() {
            if info.at_most.saturating_mul(16) > 1 << 22 {
                continue;
            }
            let values = file.read(&[Address { group, channel }], &Context::new());
            assert!(values.is_err() || about.obstacle.is_none());
            if let (Ok(values), Some(found)) = (values, info.found) {
                assert_eq!(values[0].len() as u64, found);
            }
        }
    }
}

/// Small files with many features.
fn made() -> Vec<Vec<u8>> {
    let mut made = Made::new(true, 0);
    let text = made.text("on");
    let nested = made.conversion(7, &[text, 0], &[0]);
    let ranges =
        made.conversion(8, &[nested, text, nested], &[0, 1.0_f64.to_bits(), 2.0_f64.to_bits(), 3.0_f64.to_bits()]);
    let mut array = vec![0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0];
    array.extend_from_slice(&4_u64.to_le_bytes());
    let array = made.block(b"##CA", &[0], &array);
    let values = made.block(b"##SD", &[], b"\x03\0\0\0one\x01\0\0\0x");
    let channels = made.channels(&[
        time(),
        Cn { conversion: ranges, flags: 2, ..cn(0, 8, 8) },
        Cn { composition: array, ..cn(0, 8, 8) },
        Cn { kind: 1, link: values, ..cn(7, 12, 64) },
    ]);
    let group = made.group(0, channels, Cg { cycles: 2, data_bytes: 20, invalid_bytes: 1, ..Cg::default() });
    let record = |time: f64, place: u64| [&time.to_le_bytes()[..], &[1, 2, 3, 4], &place.to_le_bytes(), &[0]].concat();
    let data = made.block(b"##DT", &[], &[record(0.0, 0), record(1.0, 7)].concat());
    let list = [&[0; 4][..], &1_u32.to_le_bytes(), &[0; 8]].concat();
    let list = made.block(b"##DL", &[0, data], &list);
    let first = made.data_group(group, list, 0);
    let deflated = deflated(&stored());
    let packed = [(0, &deflated[..]), (1, &deflated), (3, ZSTANDARD), (4, LZ4)];
    let packed = packed.map(|(code, bytes)| one_packed(code, bytes));
    let plain = one_group(&[time(), cn(0, 8, 8)], &[7; 90], 9, 0);
    [vec![made.finish(first), plain], packed.to_vec()].concat()
}

#[test]
fn prop_any_byte_may_be_wrong() {
    for bytes in made().iter().map(Vec::as_slice).chain(OTHERS) {
        let mut bytes = bytes.to_vec();
        for at in 0..bytes.len() {
            let original = bytes[at];
            for value in [0x00, 0x01, 0x7F, 0xFF, original ^ 0x01, original.wrapping_add(8)] {
                bytes[at] = value;
                exercise(&bytes);
            }
            bytes[at] = original;
        }
        (0..bytes.len()).for_each(|end| exercise(&bytes[..end]));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn prop_many_bytes_may_be_wrong(which in 0_usize..10, hits in vec((any::<usize>(), any::<u8>()), 1..12)) {
        let files = made();
        let mut bytes = files.get(which).cloned().unwrap_or_else(|| OTHERS[which - files.len()].to_vec());
        for (at, value) in hits {
            let at = at % bytes.len();
            bytes[at] = value;
        }
        exercise(&bytes);
    }
}

#[test]
fn regress_blocks_that_lead_back_are_refused() {
    let mut bytes = one_group(&[time(), cn(0, 8, 8)], &[7; 90], 9, 0);
    for (id, link) in [(b"##CG", 0), (b"##CN", 0), (b"##DG", 0), (b"##CN", 1)] {
        let at = bytes.windows(4).position(|w| w == id).unwrap();
        let field = at + 24 + 8 * link..at + 32 + 8 * link;
        let before = bytes[field.clone()].to_vec();
        bytes[field.clone()].copy_from_slice(&(at as u64).to_le_bytes());
        let error = Mdf::open(&bytes[..]).unwrap_err();
        assert!(matches!(&error, MdfError::Damaged { detail, .. } if detail.contains("same block")), "{error}");
        bytes[field].copy_from_slice(&before);
    }
}

#[test]
fn regress_conversions_that_refer_to_themselves_are_refused() {
    let mut made = Made::new(true, 0);
    let next = (made.bytes.len() as u64).next_multiple_of(8);
    let conversion = made.conversion(7, &[next, next], &[0]);
    assert_eq!(conversion, next);
    let channels = made.channels(&[Cn { conversion, ..cn(0, 0, 8) }]);
    let group = made.group(0, channels, Cg { cycles: 1, data_bytes: 1, ..Cg::default() });
    let data = made.block(b"##DT", &[], &[0]);
    let first = made.data_group(group, data, 0);
    exercise(&made.finish(first));
}

#[test]
fn regress_announced_sizes_are_not_believed() {
    let bomb = |length: u64, stored: u64| {
        let mut made = Made::new(true, 0);
        let channels = made.channels(&[time()]);
        let group = made.group(0, channels, Cg { cycles: u64::MAX, data_bytes: 8, ..Cg::default() });
        let mut data = b"DT\0\0\0\0\0\0".to_vec();
        data.extend_from_slice(&[length.to_le_bytes(), stored.to_le_bytes()].concat());
        data.extend_from_slice(&[0; 64]);
        let data = made.block(b"##DZ", &[], &data);
        let first = made.data_group(group, data, 0);
        made.finish(first)
    };
    assert!(matches!(Mdf::open(&bomb(u64::MAX, 64)[..]), Err(MdfError::Damaged { .. })));
    let cut = bomb(64, u64::MAX);
    let file = Mdf::open(&cut[..]).unwrap();
    assert_eq!((file.groups()[0].found, file.findings().len()), (Some(0), 1));
    // The data hold less than they announce.
    let file = bomb(64_000, 64);
    let file = Mdf::open(&file[..]).unwrap();
    let error = file.read(&[Address { group: 0, channel: 0 }], &Context::new()).unwrap_err();
    assert!(matches!(error, MdfError::Damaged { .. }), "{error}");
}

#[test]
fn regress_values_that_lie_upon_each_other_are_refused() {
    let mut made = Made::new(true, 0);
    let values = made.block(b"##SD", &[], &[9, 0, 0, 0].repeat(4));
    let channels = made.channels(&[Cn { kind: 1, link: values, ..cn(7, 0, 64) }]);
    let group = made.group(0, channels, Cg { cycles: 3, data_bytes: 8, ..Cg::default() });
    let places: Vec<u8> = [0_u64, 1, 4].iter().flat_map(|p| p.to_le_bytes()).collect();
    let data = made.block(b"##DT", &[], &places);
    let first = made.data_group(group, data, 0);
    let bytes = made.finish(first);
    let file = Mdf::open(&bytes[..]).unwrap();
    assert!(file.read(&[Address { group: 0, channel: 0 }], &Context::new()).is_err());
}
