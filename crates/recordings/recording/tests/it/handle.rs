//! Ranges and overviews of open recordings: they are parts of the whole decoding.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use proptest::prelude::*;
use recording::{
    Channel, Finding, Format, Handle, Raster, Recording, RecordingError, Selection, Source, Span, catalogue_from,
    decode, encode_csv, encode_mat5, encode_mdf4, open,
};
use work::{Cancel, Context};

use crate::made::{Cg, Made, cn, time};

/// Bytes that tell how many of them were read.
pub(crate) struct Counted {
    bytes: Vec<u8>,
    read: AtomicU64,
}

impl Counted {
    pub(crate) fn new(bytes: Vec<u8>) -> Arc<Self> {
        Arc::new(Self { bytes, read: AtomicU64::new(0) })
    }

    /// Bytes that were read since the last call.
    pub(crate) fn taken(&self) -> u64 {
        self.read.swap(0, Ordering::Relaxed)
    }
}

impl Source for Counted {
    fn size(&self) -> std::io::Result<u64> {
        self.bytes.size()
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> std::io::Result<()> {
        self.read.fetch_add(buffer.len() as u64, Ordering::Relaxed);
        self.bytes.read_at(offset, buffer)
    }
}

fn noise(seed: usize, row: usize) -> f64 {
    let mixed = ((seed << 40) + row) as u64 ^ 0x9E37_79B9_7F4A_7C15;
    let mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB) as f64 / 1e18
}

/// Two clocks, the second slower, with samples that are missing, and integers that are rounded.
pub(crate) fn noisy(rows: usize) -> Recording {
    let lengths = [rows, rows / 3 + 1];
    let sample = |k: usize, i: usize| match i % 97 {
        0 if k == 1 => f64::NAN,
        1 if k == 2 && i > rows / 6 => 2_f64.powi(53),
        _ => (noise(k, i) * 1e6).round() / 1e3,
    };
    let channel = |k: usize| Channel {
        name: format!("x{k}"),
        unit: "Nm".into(),
        comment: String::new(),
        raster: k / 2,
        samples: (0..lengths[k / 2]).map(|i| sample(k, i)).collect(),
    };
    let time_s = |raster: usize| (0..lengths[raster]).map(|i| (i * [2, 6][raster]) as f64 / 1e3).collect();
    Recording {
        format: Format::Mdf { version: 410 },
        comment: None,
        start_time: None,
        rasters: (0..2).map(|raster| Raster { time_s: time_s(raster), name: None }).collect(),
        channels: (0..4).map(channel).collect(),
        findings: vec![],
    }
}

fn record(recording: &Recording, raster: usize, row: usize) -> Vec<u8> {
    let own = recording.channels.iter().filter(|channel| channel.raster == raster).map(|channel| channel.samples[row]);
    let time_s = recording.rasters[raster].time_s[row];
    std::iter::once(time_s).chain(own).flat_map(f64::to_le_bytes).collect()
}

fn columns(made: &mut Made) -> u64 {
    made.channels(&[time(), cn(4, 8, 64), cn(4, 16, 64)])
}

/// Each clock by itself, in blocks of data that a list names.
pub(crate) fn plain_mdf(recording: &Recording) -> Vec<u8> {
    let (mut made, mut next) = (Made::new(true, 0), 0);
    for raster in (0..2).rev() {
        let rows = recording.rasters[raster].time_s.len();
        let records: Vec<u8> = (0..rows).flat_map(|row| record(recording, raster, row)).collect();
        let first = columns(&mut made);
        let group = made.group(0, first, Cg { cycles: rows as u64, data_bytes: 24, ..Cg::default() });
        // Records lie across the ends of blocks.
        let parts: Vec<&[u8]> = records.chunks(1_000_003).collect();
        let offsets: Vec<u8> = (0..parts.len() as u64).flat_map(|i| (i * 1_000_003).to_le_bytes()).collect();
        let data = [&[0; 4], &(parts.len() as u32).to_le_bytes()[..], &offsets].concat();
        let blocks: Vec<u64> = parts.iter().map(|part| made.block(b"##DT", &[], part)).collect();
        let list = made.block(b"##DL", &[&[0][..], &blocks].concat(), &data);
        next = made.data_group_before(next, group, list, 0);
    }
    made.finish(next)
}

/// Records of both clocks between each other.
fn mixed_mdf(recording: &Recording, is_announced: bool) -> Vec<u8> {
    let mut made = Made::new(true, 0);
    let mut records = Vec::new();
    let lengths = [0, 1].map(|raster| recording.rasters[raster].time_s.len());
    for row in 0..lengths[0].max(lengths[1]) {
        for raster in (0..2).filter(|&raster| row < lengths[raster]) {
            records.push(1 + raster as u8);
            records.extend(record(recording, raster, row));
        }
    }
    let mut next = 0;
    for raster in (0..2).rev() {
        let first = columns(&mut made);
        let cycles = if is_announced { lengths[raster] as u64 } else { 0 };
        next = made.group(next, first, Cg { id: 1 + raster as u64, cycles, data_bytes: 24, ..Cg::default() });
    }
    let data = made.block(b"##DT", &[], &records);
    let first = made.data_group(next, data, 1);
    made.finish(first)
}

/// The recording in every format.
fn files(recording: &Recording) -> Vec<(&'static str, Vec<u8>)> {
    let mut all = vec![
        ("packed.mf4", encode_mdf4(recording).unwrap()),
        ("plain.mf4", plain_mdf(recording)),
        ("mixed.mf4", mixed_mdf(recording, true)),
        ("counted.mf4", mixed_mdf(recording, false)),
        ("a.csv", encode_csv(recording).unwrap()),
        ("a.mat", encode_mat5(recording).unwrap()),
    ];
    let text = String::from_utf8(encode_csv(recording).unwrap()).unwrap();
    let utf16: Vec<u8> = [0xFEFF].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    let latin1 = text.replace("Nm", "µm").chars().map(|c| u32::from(c) as u8).collect();
    all.extend([("utf16.csv", utf16), ("latin1.csv", latin1)]);
    #[cfg(feature = "parquet")]
    all.extend([
        ("a.parquet", recording::encode_parquet(recording).unwrap()),
        ("a.arrow", recording::encode_arrow(recording).unwrap()),
    ]);
    all
}

fn opened(name: &str, bytes: &[u8]) -> Handle {
    open(name, Arc::new(bytes.to_vec()), None, &Context::new()).unwrap()
}

/// The rows of a clock in a span: the first to the last whose stamp is in it.
fn rows(time_s: &[f64], span: &Span) -> Range<usize> {
    match span {
        Span::All => 0..time_s.len(),
        Span::Rows(rows) => {
            let end = time_s.len().min(rows.end as usize);
            end.min(rows.start as usize)..end
        }
        Span::Time { from_s, to_s } => {
            let is_in = |t: &f64| t >= from_s && t <= to_s;
            let first = time_s.iter().position(is_in);
            first.map_or(0..0, |first| first..time_s.iter().rposition(is_in).unwrap() + 1)
        }
    }
}

/// The part of a whole decoding.
pub(crate) fn part(whole: &Recording, span: &Span) -> Recording {
    let mut part = whole.clone();
    for channel in &mut part.channels {
        channel.samples = channel.samples[rows(&whole.rasters[channel.raster].time_s, span)].to_vec();
    }
    part.rasters.iter_mut().for_each(|raster| raster.time_s = raster.time_s[rows(&raster.time_s, span)].to_vec());
    let is_rounded = |name: &String| {
        let mut named = part.channels.iter().filter(|c| c.name == *name).peekable();
        // That of a clock is of all its rows.
        named.peek().is_none() || named.any(|c| c.samples.iter().any(|s| s.abs() >= 2_f64.powi(53)))
    };
    part.findings.retain(|finding| match finding {
        Finding::RoundedIntegers { channel } => is_rounded(channel),
        _ => true,
    });
    part
}

/// Equal, where NaN is.
pub(crate) fn assert_same(read: &Recording, expected: &Recording, what: &str) {
    let bits = |samples: &[f64]| samples.iter().map(|s| s.to_bits()).collect::<Vec<_>>();
    for (r, e) in read.rasters.iter().zip(&expected.rasters) {
        assert_eq!((bits(&r.time_s), &r.name), (bits(&e.time_s), &e.name), "{what}");
    }
    for (r, e) in read.channels.iter().zip(&expected.channels) {
        assert_eq!(bits(&r.samples), bits(&e.samples), "{what}: {}", e.name);
        assert_eq!((&r.name, &r.unit, &r.comment, r.raster), (&e.name, &e.unit, &e.comment, e.raster), "{what}");
    }
    let rest = |r: &Recording| (r.format, r.comment.clone(), r.start_time, r.rasters.len(), r.channels.len());
    assert_eq!((rest(read), &read.findings), (rest(expected), &expected.findings), "{what}");
}

/// Compares spans of all channels, and of every second one, with the whole decoding.
pub(crate) fn assert_parts(name: &str, bytes: &[u8], row_distance_s: Option<f64>, spans: &[Span]) {
    let open = || open(name, Arc::new(bytes.to_vec()), row_distance_s, &Context::new()).unwrap();
    let read = |selection: &Selection, span: &Span| open().read(selection, span, &Context::new());
    let whole = read(&Selection::All, &Span::All).unwrap();
    let some = whole.channels.iter().skip(1).step_by(2).map(|c| c.name.clone()).collect();
    for (handle, selection) in [(open(), Selection::All), (open(), Selection::Names(some))] {
        let whole = read(&selection, &Span::All).unwrap();
        for span in spans {
            let read = handle.read(&selection, span, &Context::new()).unwrap();
            assert_same(&read, &part(&whole, span), &format!("{name} {span:?} {selection:?}"));
        }
    }
}

pub(crate) fn span() -> impl Strategy<Value = Span> {
    let rows = (0_u64..700, 0_u64..400).prop_map(|(first, count)| Span::Rows(first..first + count));
    let time = (-0.1..1.4, -0.05..0.9).prop_map(|(from_s, length_s)| Span::Time { from_s, to_s: from_s + length_s });
    prop_oneof![1 => Just(Span::All), 4 => rows, 4 => time]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn prop_ranges_are_parts_of_the_whole(count in 1_usize..600, spans in prop::collection::vec(span(), 1..5)) {
        for (name, bytes) in files(&noisy(count)) {
            assert_parts(name, &bytes, None, &spans);
        }
    }

    #[test]
    fn prop_views_hold_the_samples_of_their_span(
        count in 1_usize..5000, from in -0.1..1.1, length in 0.0..1.2, columns in 1_usize..40,
    ) {
        let span_s = count as f64 * 2e-3;
        let (from_s, to_s) = (from * span_s, (from + length) * span_s);
        for (name, bytes) in files(&noisy(count)) {
            let whole = decode(name, &bytes, &Selection::All).unwrap();
            let handle = opened(name, &bytes);
            let names: Vec<&str> = whole.channels.iter().take(2).map(|channel| channel.name.as_str()).collect();
            for pyramid in handle.pyramids(&names, &Context::new()).unwrap() {
                let channel = whole.channel(pyramid.channel()).unwrap();
                let time_s = whole.time_s(channel).unwrap();
                let view = pyramid.view(from_s, to_s, columns).unwrap();
                let rows = rows(time_s, &Span::Time { from_s, to_s });
                prop_assert!(view.len() <= columns);
                let (mut first, samples) = (rows.start, &channel.samples);
                for column in &view {
                    let own = first..first + column.samples as usize;
                    prop_assert_eq!((column.from_s, column.to_s), (time_s[own.start], time_s[own.end - 1]));
                    let (own, present): (_, Vec<f64>) =
                        (own.clone(), samples[own].iter().copied().filter(|s| !s.is_nan()).collect());
                    let least = present.iter().copied().reduce(f64::min);
                    prop_assert_eq!((column.min, column.max), (least, present.iter().copied().reduce(f64::max)));
                    prop_assert_eq!((column.first, column.last), (present.first().copied(), present.last().copied()));
                    prop_assert_eq!(column.missing as usize, own.len() - present.len());
                    first = own.end;
                }
                prop_assert_eq!(first, rows.end, "{}", name);
            }
        }
    }
}

#[test]
fn exact_the_list_of_a_handle_is_the_catalogue() {
    for (name, bytes) in files(&noisy(500)) {
        let list = catalogue_from(name, Arc::new(bytes.clone())).unwrap();
        assert_eq!(opened(name, &bytes).catalogue().unwrap(), list, "{name}");
    }
}

/// 2 s of the middle.
pub(crate) fn middle(recording: &Recording) -> (Span, u64) {
    let time_s = &recording.rasters[0].time_s;
    let from_s = time_s[time_s.len() / 2] + 0.0001;
    let span = Span::Time { from_s, to_s: from_s + 2.0 };
    let own = recording.rasters.iter().map(|raster| 24 * rows(&raster.time_s, &span).len() as u64).sum();
    (span, own)
}

#[test]
fn exact_of_mdf_a_range_reads_what_it_must() {
    let recording = noisy(400_000);
    let (span, own) = middle(&recording);
    // Bytes beyond those of the range, after the first range, which may have gone through all.
    let files = [
        ("plain.mf4", plain_mdf(&recording), 1 << 20),
        ("mixed.mf4", mixed_mdf(&recording, true), 1 << 25),
        ("packed.mf4", encode_mdf4(&recording).unwrap(), 1 << 25),
    ];
    for (name, bytes, most) in files {
        let whole = decode(name, &bytes, &Selection::All).unwrap();
        let source = Counted::new(bytes);
        let handle = open(name, source.clone(), None, &Context::new()).unwrap();
        if name == "mixed.mf4" {
            handle.read(&Selection::All, &Span::Rows(0..1), &Context::new()).unwrap();
        }
        source.taken();
        let read = handle.read(&Selection::All, &span, &Context::new()).unwrap();
        let taken = source.taken();
        assert_same(&read, &part(&whole, &span), name);
        assert!(taken < own + most, "{name}: {taken} bytes were read for {own}");
        let narrow = handle.read(&Selection::All, &Span::Rows(200_000..200_010), &Context::new()).unwrap();
        assert_eq!(narrow.channels[0].samples, whole.channels[0].samples[200_000..200_010], "{name}");
        let taken = source.taken();
        assert!(taken < 3 << 20, "{name}: {taken} bytes were read for ten rows");
    }
}

/// Overviews of several channels take one pass, and what was made is not made again.
#[test]
fn exact_overviews_are_made_in_one_pass() {
    let recording = noisy(100_000);
    for (name, bytes) in [("plain.mf4", plain_mdf(&recording)), ("mixed.mf4", mixed_mdf(&recording, true))] {
        let whole = decode(name, &bytes, &Selection::All).unwrap();
        let size = bytes.len() as u64;
        let source = Counted::new(bytes);
        let handle = open(name, source.clone(), None, &Context::new()).unwrap();
        source.taken();
        let channels: Vec<String> = handle.catalogue().unwrap().channels.into_iter().map(|c| c.name).collect();
        let names: Vec<&str> = channels.iter().map(String::as_str).collect();
        assert_eq!(handle.pyramids(&names, &Context::new()).unwrap().len(), names.len());
        let taken = source.taken();
        assert!(taken <= size, "{name}: {taken} of {size} bytes were read");
        let pyramid = handle.pyramid(names[0], &Context::new()).unwrap();
        assert_eq!(source.taken(), 0, "{name}");
        assert_eq!((pyramid.samples() as usize, pyramid.base()), (whole.channels[0].samples.len(), 64));
    }
}

#[test]
fn exact_a_channel_that_is_not_there_is_said() {
    for (name, bytes) in files(&noisy(20)) {
        let handle = opened(name, &bytes);
        let span = Span::Rows(0..1);
        let errors = [
            handle.read(&Selection::names(["nothing"]), &span, &Context::new()).map(|_| ()).unwrap_err(),
            handle.pyramid("nothing", &Context::new()).map(|_| ()).unwrap_err(),
        ];
        for error in errors {
            assert!(matches!(&error, RecordingError::NoSuchChannel { file, .. } if file == name), "{error}");
        }
    }
}

/// Stamps out of order are met by the search, which then goes through all of them.
#[test]
fn exact_a_clock_that_runs_backwards_is_gone_through() {
    let mut recording = noisy(100_000);
    recording.rasters[0].time_s.reverse();
    let span = Span::Time { from_s: 20.0, to_s: 20.1 };
    for (name, bytes) in [("plain.mf4", plain_mdf(&recording)), ("packed.mf4", encode_mdf4(&recording).unwrap())] {
        let whole = decode(name, &bytes, &Selection::All).unwrap();
        let read = opened(name, &bytes).read(&Selection::All, &span, &Context::new()).unwrap();
        assert_same(&read, &part(&whole, &span), name);
        assert_eq!(read.rasters[0].time_s.len(), 51);
    }
}

#[test]
fn exact_ranges_and_overviews_can_be_cancelled() {
    let recording = noisy(50_000);
    for (name, bytes) in files(&recording) {
        let handle = opened(name, &bytes);
        let channel = handle.catalogue().unwrap().channels[0].name.clone();
        let cancel = Cancel::default();
        let ends = cancel.clone();
        // The first news of progress, or the step itself, ends the work.
        let context = Context::new().with_threads(1).with_cancel(cancel).with_listener(move |_| ends.cancel());
        let made = context.run(|| handle.pyramid(&channel, &context.step("reading", 0)).map(|_| ()));
        assert!(made.is_err(), "{name}");
        assert!(handle.pyramid(&channel, &Context::new()).is_ok(), "{name}");
    }
}

/// Threads share a handle.
#[test]
fn exact_a_handle_is_read_by_several_threads() {
    let recording = noisy(2000);
    for (name, bytes) in files(&recording) {
        let whole = decode(name, &bytes, &Selection::All).unwrap();
        let handle = opened(name, &bytes);
        std::thread::scope(|scope| {
            for first in (0..2000).step_by(500) {
                let (handle, whole) = (&handle, &whole);
                scope.spawn(move || {
                    let span = Span::Rows(first..first + 500);
                    let read = handle.read(&Selection::All, &span, &Context::new()).unwrap();
                    assert_same(&read, &part(whole, &span), name);
                });
            }
        });
    }
}
