//! Parquet and Arrow: what becomes a clock and what a channel.

use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::types::Int32Type;
use arrow_array::{
    ArrayRef, BooleanArray, Decimal128Array, DictionaryArray, DurationMillisecondArray, Float32Array, Float64Array,
    Int64Array, RecordBatch, StringArray, TimestampMicrosecondArray, TimestampNanosecondArray,
};
use arrow_ipc::CompressionType;
use arrow_ipc::writer::{FileWriter, IpcWriteOptions, StreamWriter};
use arrow_schema::{Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use recording::{
    CsvProblem, Finding, Recording, RecordingError, Selection, SkipReason, StartTime, catalogue, decode,
    decode_untimed, encode_csv, encode_parquet,
};

/// A column: name, unit in its metadata, values.
type Column = (&'static str, Option<&'static str>, ArrayRef);

pub(crate) fn batch(columns: Vec<Column>) -> RecordBatch {
    let field = |(name, unit, array): &Column| {
        let metadata = unit.map(|unit| ("unit".to_owned(), unit.to_owned()));
        Field::new(*name, array.data_type().clone(), true)
            .with_metadata(metadata.into_iter().collect::<HashMap<_, _>>())
    };
    let schema = Schema::new(columns.iter().map(field).collect::<Vec<_>>());
    RecordBatch::try_new(Arc::new(schema), columns.into_iter().map(|(_, _, array)| array).collect()).unwrap()
}

fn parquet(batch: &RecordBatch) -> Vec<u8> {
    let mut writer = ArrowWriter::try_new(Vec::new(), batch.schema(), None).unwrap();
    writer.write(batch).unwrap();
    writer.into_inner().unwrap()
}

fn arrow(batch: &RecordBatch) -> Vec<u8> {
    let mut writer = FileWriter::try_new(Vec::new(), &batch.schema()).unwrap();
    writer.write(batch).unwrap();
    writer.into_inner().unwrap()
}

/// A stream of two batches.
pub(crate) fn small_stream() -> Vec<u8> {
    let batches = [0, 1].map(|n| batch(vec![("time", None, floats(&[f64::from(n)])), ("a", None, floats(&[1.0]))]));
    stream(&batches)
}

fn stream(batches: &[RecordBatch]) -> Vec<u8> {
    let mut writer = StreamWriter::try_new(Vec::new(), &batches[0].schema()).unwrap();
    batches.iter().for_each(|batch| writer.write(batch).unwrap());
    writer.into_inner().unwrap()
}

/// The same recording from every format.
fn read(columns: Vec<Column>) -> Recording {
    let batch = batch(columns);
    let mut of_parquet = decode("a.parquet", &parquet(&batch), &Selection::All).unwrap();
    assert_eq!(of_parquet.format.to_string(), "Parquet");
    let of_arrow = decode("a.arrow", &arrow(&batch), &Selection::All).unwrap();
    let of_stream = decode("a.arrow", &stream(std::slice::from_ref(&batch)), &Selection::All).unwrap();
    for (bytes, read) in [(parquet(&batch), &of_parquet), (arrow(&batch), &of_arrow)] {
        let mut expected = read.catalogue();
        // Of numbers that are not read, nothing is known.
        expected.findings.retain(|finding| !matches!(finding, Finding::RoundedIntegers { .. }));
        assert_eq!(catalogue("a", &bytes).unwrap(), expected);
    }
    assert_eq!(of_arrow.format.to_string(), "Arrow");
    of_parquet.format = of_arrow.format;
    for other in [of_stream, of_parquet] {
        assert_eq!(format!("{of_arrow:?}"), format!("{other:?}"));
    }
    of_arrow
}

fn floats(values: &[f64]) -> ArrayRef {
    Arc::new(Float64Array::from(values.to_vec()))
}

const TIME: [f64; 3] = [0.0, 0.5, 1.0];

#[test]
fn exact_columns_of_every_type_become_channels() {
    let keys: DictionaryArray<Int32Type> =
        DictionaryArray::new(vec![Some(1), None, Some(0)].into(), Arc::new(Float32Array::from(vec![1.5, 2.5])));
    let decimals = Decimal128Array::from(vec![Some(12345), None, Some(-1)]).with_precision_and_scale(10, 3).unwrap();
    let r = read(vec![
        ("time", Some("ms"), Arc::new(Int64Array::from(vec![0, 500, 1000]))),
        ("n [rpm]", None, Arc::new(Float32Array::from(vec![Some(0.25), None, Some(2.0)]))),
        ("on", None, Arc::new(BooleanArray::from(vec![Some(true), Some(false), None]))),
        ("price", Some("Nm"), Arc::new(decimals)),
        ("key", None, Arc::new(keys)),
        ("lag", None, Arc::new(DurationMillisecondArray::from(vec![1, 2, 3]))),
        ("state", None, Arc::new(StringArray::from(vec!["a", "b", "c"]))),
    ]);
    assert_eq!((r.rasters.len(), &r.rasters[0].time_s[..]), (1, &TIME[..]));
    let nan = f64::NAN;
    let expected = [
        ("n", "rpm", [0.25, nan, 2.0]),
        ("on", "", [1.0, 0.0, nan]),
        ("price", "Nm", [12.345, nan, -0.001]),
        ("key", "", [2.5, nan, 1.5]),
        ("lag", "s", [0.001, 0.002, 0.003]),
    ];
    for (channel, (name, unit, samples)) in r.channels.iter().zip(expected) {
        assert_eq!((channel.name.as_str(), channel.unit.as_str()), (name, unit));
        assert_eq!(
            channel.samples.iter().map(|s| s.to_bits()).collect::<Vec<_>>(),
            samples.map(f64::to_bits),
            "{name}"
        );
    }
    let reason = SkipReason::NotNumeric { kind: "text".into() };
    assert_eq!(r.findings, [Finding::SkippedChannel { channel: "state".into(), reason }]);
}

#[test]
fn exact_time_stamps_of_data_frames() {
    let start = 1_795_262_400_000_000_000;
    let stamps = |zone: Option<&str>| -> ArrayRef {
        let stamps = TimestampNanosecondArray::from(vec![start, start + 500_000_000, start + 1_000_000_000]);
        Arc::new(stamps.with_timezone_opt(zone.map(str::to_owned)))
    };
    for (zone, is_local, utc_offset_min) in [
        (None, true, None),
        (Some("UTC"), false, Some(0)),
        (Some("+01:00"), false, Some(60)),
        (Some("Europe/Berlin"), false, None),
    ] {
        let r = read(vec![("n", None, floats(&[1.0, 2.0, 3.0])), ("__index_level_0__", None, stamps(zone))]);
        assert_eq!((&r.rasters[0].time_s[..], r.channels.len()), (&TIME[..], 1));
        assert_eq!(r.start_time, Some(StartTime { nanoseconds: start, is_local, utc_offset_min }));
    }
    let micro: ArrayRef = Arc::new(TimestampMicrosecondArray::from(vec![start / 1000, start / 1000 + 1]));
    let r = read(vec![("when", None, micro), ("n", None, floats(&[1.0, 2.0]))]);
    assert_eq!(r.rasters[0].time_s, [0.0, 1e-6]);
    let lag: ArrayRef = Arc::new(DurationMillisecondArray::from(vec![-500, 0]));
    let r = read(vec![("since start", None, lag), ("n", None, floats(&[1.0, 2.0]))]);
    assert_eq!(r.rasters[0].time_s, [-0.5, 0.0]);
}

#[test]
fn exact_several_clocks_in_one_table() {
    let short = |values: [Option<f64>; 3]| -> ArrayRef { Arc::new(Float64Array::from(values.to_vec())) };
    let columns = |last| {
        vec![
            ("time_1", None, floats(&TIME)),
            ("a", None, floats(&[1.0, 2.0, 3.0])),
            ("time_2", None, short([Some(0.0), Some(1.0), None])),
            ("b", None, short([Some(4.0), None, last])),
        ]
    };
    let r = read(columns(None));
    assert_eq!((r.rasters.len(), &r.rasters[1].time_s[..]), (2, &[0.0, 1.0][..]));
    assert!(r.channels[1].samples[1].is_nan() && r.channels[1].samples.len() == 2);
    let error = decode("a", &parquet(&batch(columns(Some(5.0)))), &Selection::All).unwrap_err();
    assert!(error.to_string().contains("row 3 has a value but no time stamp; write the stamp"), "{error}");
    assert!(!error.to_string().contains("copy the file"), "{error}");
}

fn compressed(batch: &RecordBatch, compression: Compression) -> Vec<u8> {
    let properties = WriterProperties::builder().set_compression(compression).build();
    let mut writer = ArrowWriter::try_new(Vec::new(), batch.schema(), Some(properties)).unwrap();
    writer.write(batch).unwrap();
    writer.into_inner().unwrap()
}

#[test]
fn exact_every_compression_but_two_is_read() {
    let columns = || batch(vec![("time", None, floats(&TIME)), ("a", None, floats(&[1.0, 2.0, 3.0]))]);
    let zstd = Compression::ZSTD(Default::default());
    for compression in [Compression::SNAPPY, Compression::GZIP(Default::default()), Compression::LZ4_RAW, zstd] {
        let bytes = compressed(&columns(), compression);
        assert_eq!(decode("a", &bytes, &Selection::All).unwrap().channels[0].samples, [1.0, 2.0, 3.0], "{compression}");
    }
}

/// Written by pyarrow, since brotli cannot be written here either.
#[test]
fn exact_brotli_is_refused_with_what_to_do() {
    let error = decode("a", include_bytes!("data/brotli.parquet"), &Selection::All).unwrap_err();
    assert!(error.to_string().ends_with("brotli; save the file with snappy, gzip, lz4 or zstd"), "{error}");
    assert!(matches!(error, RecordingError::UnusableChannel { .. }), "{error:?}");
}

/// A wide table is read in blocks of columns, in which a damaged one is named as it is when alone.
#[test]
fn exact_wide_tables_are_read_in_blocks() {
    const ROWS: usize = 1 << 13;
    let column = |k: usize| floats(&(0..ROWS).map(|i| (i * k) as f64).collect::<Vec<_>>());
    let names: Vec<&'static str> = (0..20).map(|k| &*format!("c{k}").leak()).collect();
    let columns = names.iter().enumerate().map(|(k, name)| (*name, None, column(k)));
    let all = batch(std::iter::once(("time", None, column(1))).chain(columns).collect());
    let bytes = compressed(&all, Compression::UNCOMPRESSED);
    let recording = decode("a", &bytes, &Selection::All).unwrap();
    for (k, channel) in recording.channels.iter().enumerate() {
        let is_as_written = channel.samples.iter().enumerate().all(|(i, sample)| *sample == (i * k) as f64);
        assert!(is_as_written && channel.samples.len() == ROWS, "{}", channel.name);
    }
    let file = SerializedFileReader::new(bytes::Bytes::from(bytes.clone())).unwrap();
    let (start, _) = file.metadata().row_group(0).column(12).byte_range();
    let mut damaged = bytes;
    damaged[start as usize..start as usize + 8].fill(0xFF);
    let error = decode("a", &damaged, &Selection::All).unwrap_err();
    assert!(matches!(&error, RecordingError::DamagedChannel { channel, .. } if channel == "c11"), "{error}");
}

#[test]
fn exact_only_the_selected_columns_and_what_is_not_there() {
    let bytes = parquet(&batch(vec![
        ("time", None, floats(&TIME)),
        ("a", None, floats(&TIME)),
        ("state", None, Arc::new(StringArray::from(vec!["a", "b", "c"]))),
        ("b", None, floats(&TIME)),
    ]));
    let r = decode("a", &bytes, &Selection::names(["b"])).unwrap();
    assert_eq!((r.channels.len(), r.channels[0].name.as_str(), r.channels[0].raster), (1, "b", 0));
    assert!(matches!(decode("a", &bytes, &Selection::names(["c"])), Err(RecordingError::NoSuchChannel { .. })));
    assert!(matches!(decode("a", &bytes, &Selection::names(["state"])), Err(RecordingError::UnusableChannel { .. })));
    let untimed = parquet(&batch(vec![("u", None, floats(&[1.0, 2.0])), ("T", None, floats(&[3.0, 4.0]))]));
    let error = decode("a", &untimed, &Selection::All).unwrap_err();
    assert_eq!(error, RecordingError::NoTimeColumn { file: "a".into(), first: "u".into() });
    let r = decode_untimed("a", &untimed, 0.1).unwrap();
    assert_eq!((r.channels.len(), &r.rasters[0].time_s[..]), (2, &[0.0, 0.1][..]));
}

#[test]
fn exact_rasters_are_merged_into_one_table() {
    let table = b"time,a,time,b\n0,1,0.25,10\n0.5,2,0.5,20\n1,3,,\n";
    let r = decode("a.csv", table, &Selection::All).unwrap();
    let bytes = encode_parquet(&r).unwrap();
    let read = decode("a.parquet", &bytes, &Selection::All).unwrap();
    assert_eq!((&read.rasters, &read.channels), (&r.rasters, &r.channels));
    // A reader that knows nothing of the rasters finds all stamps in one column.
    let builder = parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder::try_new(bytes::Bytes::from(bytes));
    let merged = builder.unwrap().build().unwrap().next().unwrap().unwrap();
    assert_eq!(merged.column(0), &floats(&[0.0, 0.25, 0.5, 1.0]));
    let nulls: Vec<usize> = merged.columns().iter().map(|c| c.null_count()).collect();
    assert_eq!(nulls, [0, 1, 2]);
    assert!(encode_csv(&read).is_ok());
}

#[test]
fn exact_a_stream_without_an_end_is_said() {
    let whole = small_stream();
    let r = decode("a", &whole, &Selection::All).unwrap();
    assert_eq!((r.findings, r.channels[0].samples.len()), (vec![], 2));
    let r = decode("a", &whole[..whole.len() - 8], &Selection::All).unwrap();
    assert_eq!((r.findings, r.channels[0].samples.len()), (vec![Finding::NotFinalised], 2));
}

#[test]
fn exact_announced_sizes_of_compressed_buffers_are_not_believed() {
    let zeros = batch(vec![("time", None, floats(&[0.0; 1000])), ("a", None, floats(&[0.0; 1000]))]);
    let options = IpcWriteOptions::default().try_with_compression(Some(CompressionType::LZ4_FRAME)).unwrap();
    let mut file = FileWriter::try_new_with_options(Vec::new(), &zeros.schema(), options.clone()).unwrap();
    let mut stream = StreamWriter::try_new_with_options(Vec::new(), &zeros.schema(), options).unwrap();
    file.write(&zeros).unwrap();
    stream.write(&zeros).unwrap();
    for mut bytes in [file.into_inner().unwrap(), stream.into_inner().unwrap()] {
        assert_eq!(decode("a", &bytes, &Selection::All).unwrap().channels[0].samples, [0.0; 1000]);
        let size = bytes.windows(12).rposition(|w| w == b"\x40\x1F\0\0\0\0\0\0\x04\x22\x4D\x18").unwrap();
        for (place, value) in [(5, 1), (3, 1)] {
            let mut large = bytes.clone();
            large[size + place] = value;
            let error = decode("a", &large, &Selection::All).unwrap_err();
            assert!(error.to_string().contains("plausible"), "{error}");
        }
        bytes[size + 5] = 1;
        let error = decode("a", &bytes, &Selection::All).unwrap_err();
        assert!(error.to_string().contains("plausible"), "{error}");
        // In a file the length of a description may be wrong: the footer has it too.
        let marks = bytes.windows(4).enumerate().filter(|(_, w)| *w == [0xFF; 4]).map(|(at, _)| at);
        let Some(batch) = marks.filter(|_| bytes.starts_with(b"ARROW1")).nth(1) else { continue };
        bytes[batch + 4..batch + 8].fill(0);
        let error = decode("a", &bytes, &Selection::All).unwrap_err();
        assert!(error.to_string().contains("plausible"), "{error}");
    }
}

#[test]
fn regress_announced_sizes_of_batches_are_not_believed() {
    let numbers = batch(vec![("time", None, floats(&[0.0, 1.0])), ("a", None, floats(&[2.0, 3.0]))]);
    let mut file = FileWriter::try_new(Vec::new(), &numbers.schema()).unwrap();
    file.write(&numbers).unwrap();
    let mut bytes = file.into_inner().unwrap();
    assert!(decode("a", &bytes, &Selection::All).is_ok());
    // In the footer: where the batch begins, the length of its description, that of its buffers.
    let (start, length) = (bytes.len() - 10, bytes.len() - 10);
    let footer = start - u32::from_le_bytes(bytes[length..length + 4].try_into().unwrap()) as usize;
    let body = 2 * 64_i64;
    let place = bytes[footer..start].windows(8).position(|w| w == body.to_le_bytes()).unwrap() + footer;
    for announced in [1_i64 << 30, 1 << 50, i64::MAX, -1] {
        bytes[place..place + 8].copy_from_slice(&announced.to_le_bytes());
        let error = decode("a", &bytes, &Selection::All).unwrap_err();
        assert!(error.to_string().contains("plausible"), "{error}");
    }
}

#[test]
fn regress_text_is_no_stream() {
    let error = decode("a", &[0xFF, 0xFF, 0xFF, 0xFF, 8, 0, 0, 0, 1, 2], &Selection::All).unwrap_err();
    assert!(!matches!(error, RecordingError::Csv { problem: CsvProblem::NoData, .. }), "{error}");
}

/// A batch of more rows than are read at once, of values of one bit, of codes, with missing ones, between columns of
/// text.
#[test]
fn exact_long_batches_are_read_in_parts() {
    const ROWS: usize = 200_001;
    let on = |i: usize| (i % 7 != 3).then_some(i % 5 < 2);
    let gear = |i: usize| (!i.is_multiple_of(11)).then(|| ["1.5", "2.5", "-3"][i % 3]);
    let gears = [1.5, 2.5, -3.0];
    let codes = (0..ROWS).map(|i| gear(i).map(|_| (i % 3) as i32));
    let gear_values: ArrayRef = Arc::new(Float64Array::from(gears.to_vec()));
    let columns: Vec<Column> = vec![
        ("note", None, Arc::new((0..ROWS).map(|i| (i % 2 == 0).then(|| format!("n{i}"))).collect::<StringArray>())),
        ("time", None, floats(&(0..ROWS).map(|i| i as f64 * 1e-3).collect::<Vec<_>>())),
        ("on", None, Arc::new((0..ROWS).map(on).collect::<BooleanArray>())),
        ("gear", None, Arc::new(DictionaryArray::<Int32Type>::new(codes.collect(), gear_values))),
        ("count", None, Arc::new((0..ROWS).map(|i| Some(i as i64 * 3)).collect::<Int64Array>())),
    ];
    let batch = batch(columns);
    for packed in [None, Some(CompressionType::LZ4_FRAME), Some(CompressionType::ZSTD)] {
        let options = IpcWriteOptions::default().try_with_compression(packed).unwrap();
        let mut writer = FileWriter::try_new_with_options(Vec::new(), &batch.schema(), options).unwrap();
        writer.write(&batch).unwrap();
        let bytes = writer.into_inner().unwrap();
        let recording = decode("a.arrow", &bytes, &Selection::All).unwrap();
        assert_eq!(catalogue("a.arrow", &bytes).unwrap(), recording.catalogue());
        let is = |name: &str, value: &dyn Fn(usize) -> f64| {
            let samples = &recording.channel(name).unwrap().samples;
            let is_same = |i: usize| samples[i] == value(i) || (samples[i].is_nan() && value(i).is_nan());
            samples.len() == ROWS && (0..ROWS).all(is_same)
        };
        assert!(is("on", &|i| on(i).map_or(f64::NAN, |on| f64::from(u8::from(on)))), "{packed:?}");
        assert!(is("gear", &|i| gear(i).map_or(f64::NAN, |_| gears[i % 3])), "{packed:?}");
        assert!(is("count", &|i| i as f64 * 3.0), "{packed:?}");
        assert_eq!(recording.rasters[0].time_s.len(), ROWS);
    }
}

#[test]
fn exact_rounded_integers_are_said() {
    let rounded = |count: i64| {
        let counts: ArrayRef = Arc::new(Int64Array::from(vec![1, count]));
        let r = read(vec![("time", None, floats(&[0.0, 1.0])), ("n", None, counts)]);
        r.findings.contains(&Finding::RoundedIntegers { channel: "n".into() })
    };
    assert!(rounded(i64::MAX) && rounded((1 << 53) + 1) && !rounded((1 << 53) - 1));
}
