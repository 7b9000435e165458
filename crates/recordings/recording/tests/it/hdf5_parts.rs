//! Ranges of HDF5.

use hdf5_pure::FileBuilder;
use proptest::prelude::*;
use recording::{Selection, Span, decode, open};
use work::Context;

use crate::handle::{Counted, assert_parts, assert_same, part};

/// Arrays of many shapes, types and layouts, on one clock, 2 ms apart.
fn file(rows: usize, chunk: u64, is_packed: bool) -> Vec<u8> {
    let mut builder = FileBuilder::new();
    let numbers = |count: usize| (0..count).map(|i| (i * 7 % 1013) as f64 / 4.0).collect::<Vec<f64>>();
    let (n, chunk) = (rows as u64, chunk.min(rows as u64));
    let time_s: Vec<f64> = (0..rows).map(|row| row as f64 * 2e-3).collect();
    builder.create_dataset("time").with_f64_data(&time_s).with_shape(&[n]);
    builder.create_dataset("plain").with_f64_data(&numbers(rows)).with_shape(&[n]);
    builder.create_dataset("column").with_f64_data(&numbers(rows)).with_shape(&[n, 1]);
    builder.create_dataset("row").with_f64_data(&numbers(rows)).with_shape(&[1, n]);
    builder.create_dataset("down").with_f64_data(&numbers(3 * rows)).with_shape(&[3, n]);
    let single: Vec<f32> = numbers(rows).into_iter().map(|number| number as f32).collect();
    builder.create_dataset("single").with_f32_data(&single).with_shape(&[n]).with_chunks(&[chunk]);
    let wide: Vec<i64> = (0..rows as i64).map(|row| if row % 1000 == 999 { 1 << 54 } else { row }).collect();
    builder.create_dataset("wide").with_i64_data(&wide).with_shape(&[n]);
    let across = builder.create_dataset("across");
    across.with_f64_data(&numbers(4 * rows)).with_shape(&[n, 4]).with_chunks(&[chunk, 3]);
    if is_packed {
        across.with_deflate(4);
    }
    builder.finish().unwrap()
}

fn span() -> impl Strategy<Value = Span> {
    let rows = (0_u64..12_000, 0_u64..5000).prop_map(|(first, count)| Span::Rows(first..first + count));
    let time = (-1.0..21.0, 0.0..5.0).prop_map(|(from_s, length_s)| Span::Time { from_s, to_s: from_s + length_s });
    prop_oneof![rows, time]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn prop_ranges_of_hdf5_are_parts_of_the_whole(
        // Below 4096 numbers, arrays are read whole.
        rows in 3900_usize..10_000, chunk in 100_u64..5000, is_packed in any::<bool>(),
        spans in prop::collection::vec(span(), 1..5),
    ) {
        assert_parts("a.h5", &file(rows, chunk, is_packed), None, &spans);
    }
}

/// Without a clock, the rows are counted from the beginning.
#[test]
fn exact_ranges_of_hdf5_without_a_clock() {
    let mut builder = FileBuilder::new();
    let numbers: Vec<f64> = (0..9000).map(f64::from).collect();
    builder.create_dataset("a").with_f64_data(&numbers).with_shape(&[9000]);
    let spans = [Span::Rows(5000..5003), Span::Time { from_s: 600.05, to_s: 601.0 }, Span::Rows(8990..9100)];
    assert_parts("a.h5", &builder.finish().unwrap(), Some(0.1), &spans);
}

/// After the clock, which is read once, a range takes its rows, or the chunks with them.
#[test]
fn exact_of_hdf5_a_range_reads_what_it_must() {
    let bytes = file(200_000, 5000, true);
    let selection = Selection::names(["plain", "column", "single", "across(2,:)"]);
    let span = Span::Rows(100_000..101_000);
    let whole = decode("a.h5", &bytes, &selection).unwrap();
    let source = Counted::new(bytes);
    let handle = open("a.h5", source.clone(), None, &Context::new()).unwrap();
    handle.read(&selection, &Span::Rows(0..1), &Context::new()).unwrap();
    source.taken();
    let read = handle.read(&selection, &span, &Context::new()).unwrap();
    assert_same(&read, &part(&whole, &span), "a.h5");
    let taken = source.taken();
    assert!(taken < 300_000, "{taken} bytes were read for a thousand rows");
}
