//! Ranges of Parquet and Arrow.

use std::sync::Arc;

use arrow_array::types::Int32Type;
use arrow_array::{
    ArrayRef, BooleanArray, DictionaryArray, Float32Array, Float64Array, Int64Array, RecordBatch, StringArray,
    Time64MicrosecondArray, TimestampNanosecondArray,
};
use arrow_ipc::CompressionType;
use arrow_ipc::writer::{FileWriter, IpcWriteOptions, StreamWriter};
use parquet::arrow::ArrowWriter;
use parquet::file::properties::WriterProperties;
use proptest::prelude::*;
use recording::{Selection, Span, decode, encode_arrow, encode_parquet, open};
use work::Context;

use crate::handle::{Counted, assert_parts, assert_same, middle, noisy, part, span};
use crate::tables::batch;

/// Kinds of clocks: in order, with rows that lack one, backwards, of no unit, since 1970, as dates, past midnight.
const CLOCKS: usize = 7;

fn clock(kind: usize, rows: usize) -> (&'static str, Option<&'static str>, ArrayRef) {
    let whole = |number: &dyn Fn(i64) -> i64| Int64Array::from_iter_values((0..rows as i64).map(number));
    match kind {
        0 => ("time", Some("ms"), Arc::new(whole(&|row| 2 * row))),
        1 => {
            let stamps = (0..rows as i64).map(|row| is_there(kind, row as usize).then_some(2 * row));
            ("time", Some("ms"), Arc::new(stamps.collect::<Int64Array>()))
        }
        2 => ("time", Some("ms"), Arc::new(whole(&|row| 2 * (row ^ 5)))),
        3 => ("time", None, Arc::new(whole(&|row| 10 * row))),
        4 => ("time", Some("ms"), Arc::new(whole(&|row| 1_700_000_000_000 + 2 * row))),
        5 => {
            let stamps = (0..rows as i64).map(|row| 1_700_000_000_000_000_000 + 2_000_000 * row);
            ("stamp", None, Arc::new(TimestampNanosecondArray::from_iter_values(stamps)))
        }
        _ => {
            let stamps = (0..rows as i64).map(|row| (86_399_500_000 + 2_000 * row) % 86_400_000_000);
            ("clock", None, Arc::new(Time64MicrosecondArray::from_iter_values(stamps)))
        }
    }
}

fn is_there(kind: usize, row: usize) -> bool {
    kind != 1 || row % 5 != 3
}

/// Columns of many types with missing values.
fn many(kind: usize, rows: usize) -> RecordBatch {
    let value = |row: usize, gap: usize| (is_there(kind, row) && row % gap != 2).then_some(row);
    let wide = |row: usize| if row % 301 == 300 { 1 << 54 } else { row as i64 };
    let texts = ["one", "two"];
    let codes: DictionaryArray<Int32Type> = DictionaryArray::new(
        (0..rows).map(|row| value(row, 7).map(|row| row as i32 % 3)).collect(),
        Arc::new(Float32Array::from(vec![0.5, 1.5, 2.5])),
    );
    batch(vec![
        clock(kind, rows),
        ("a", Some("Nm"), Arc::new((0..rows).map(|row| value(row, 11).map(|r| r as f64)).collect::<Float64Array>())),
        ("on", None, Arc::new((0..rows).map(|row| value(row, 13).map(|r| r % 3 == 1)).collect::<BooleanArray>())),
        ("wide", None, Arc::new((0..rows).map(|row| value(row, 17).map(wide)).collect::<Int64Array>())),
        ("code", None, Arc::new(codes)),
        ("text", None, Arc::new((0..rows).map(|row| value(row, 19).map(|r| texts[r % 2])).collect::<StringArray>())),
    ])
}

fn files(batch: &RecordBatch, size: usize) -> Vec<(&'static str, Vec<u8>)> {
    let properties = WriterProperties::builder().set_max_row_group_row_count(Some(2 * size));
    let properties = properties.set_data_page_row_count_limit(size).set_write_batch_size(16).build();
    let mut parquet = ArrowWriter::try_new(Vec::new(), batch.schema(), Some(properties)).unwrap();
    parquet.write(batch).unwrap();
    let options = |packed| IpcWriteOptions::default().try_with_compression(packed).unwrap();
    let file = |packed| FileWriter::try_new_with_options(Vec::new(), &batch.schema(), options(packed)).unwrap();
    let (mut plain, mut packed) = (file(None), file(Some(CompressionType::LZ4_FRAME)));
    let mut stream = StreamWriter::try_new(Vec::new(), &batch.schema()).unwrap();
    for first in (0..batch.num_rows()).step_by(size) {
        let part = batch.slice(first, size.min(batch.num_rows() - first));
        plain.write(&part).unwrap();
        packed.write(&part).unwrap();
        stream.write(&part).unwrap();
    }
    vec![
        ("a.parquet", parquet.into_inner().unwrap()),
        ("plain.arrow", plain.into_inner().unwrap()),
        ("packed.arrow", packed.into_inner().unwrap()),
        ("stream.arrow", stream.into_inner().unwrap()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn prop_ranges_of_tables_are_parts_of_the_whole(
        kind in 0..CLOCKS, rows in 1_usize..700, size in 1_usize..300, spans in prop::collection::vec(span(), 1..5),
    ) {
        for (name, bytes) in files(&many(kind, rows), size) {
            assert_parts(name, &bytes, None, &spans);
        }
    }
}

/// Without a clock, the rows are counted from the beginning of the table.
#[test]
fn exact_ranges_of_tables_without_a_clock() {
    let values: ArrayRef = Arc::new(Float64Array::from_iter_values((0..500).map(f64::from)));
    let spans = [Span::Rows(100..130), Span::Time { from_s: 3.0, to_s: 4.05 }, Span::Rows(490..600)];
    for (name, bytes) in files(&batch(vec![("a", None, values)]), 64) {
        assert_parts(name, &bytes, Some(0.1), &spans);
    }
}

/// After the clocks, which are read once, a range takes the pages or bytes with its rows.
#[test]
fn exact_of_tables_a_range_reads_what_it_must() {
    let recording = noisy(400_000);
    let (span, own) = middle(&recording);
    let files = [
        ("a.parquet", encode_parquet(&recording).unwrap(), 2 << 20),
        ("a.arrow", encode_arrow(&recording).unwrap(), 1 << 17),
    ];
    for (name, bytes, most) in files {
        let whole = decode(name, &bytes, &Selection::All).unwrap();
        let source = Counted::new(bytes);
        let handle = open(name, source.clone(), None, &Context::new()).unwrap();
        handle.read(&Selection::All, &Span::Rows(0..1), &Context::new()).unwrap();
        source.taken();
        let read = handle.read(&Selection::All, &span, &Context::new()).unwrap();
        let taken = source.taken();
        assert_same(&read, &part(&whole, &span), name);
        assert!(taken < own + most, "{name}: {taken} bytes were read for {own}");
    }
}
