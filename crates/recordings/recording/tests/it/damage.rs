//! The readers on the conformance suite of `testkit`, and damage particular to a format.

use recording::{
    Channel, Finding, Format, Raster, Recording, RecordingError, Selection, SkipReason, decode, encode_csv,
    encode_mat5, encode_mdf4,
};
use testkit::reader::{Case, Content, Signal, conform};

use crate::mat::{self, variable};

fn read(name: &'static str) -> impl Fn(&[u8]) -> Result<Content, String> {
    move |bytes| {
        let recording = decode(name, bytes, &Selection::All).map_err(|e| e.to_string())?;
        Ok(Content {
            reports_loss: recording.findings.iter().any(Finding::is_loss),
            clocks: recording.rasters.into_iter().map(|r| r.time_s).collect(),
            channels: recording.channels.into_iter().map(signal).collect(),
        })
    }
}

fn signal(channel: Channel) -> Signal {
    Signal { name: channel.name, clock: channel.raster, samples: channel.samples }
}

/// Channels `(name, raster, samples)` on rasters of these lengths at 100 Hz.
fn made(lengths: &[usize], channels: &[(&str, usize, f64)]) -> Recording {
    let raster = |&n: &usize| Raster { time_s: (0..n).map(|i| i as f64 / 100.0).collect(), name: None };
    let channel = |&(name, raster, offset): &(&str, usize, f64)| Channel {
        name: name.into(),
        unit: "Nm".into(),
        comment: String::new(),
        raster,
        samples: (0..lengths[raster]).map(|i| offset + i as f64).collect(),
    };
    Recording {
        format: Format::Mdf { version: 410 },
        comment: None,
        start_time: None,
        rasters: lengths.iter().map(raster).collect(),
        channels: channels.iter().map(channel).collect(),
        findings: vec![],
    }
}

fn duplicates() -> Recording {
    made(&[4], &[("n", 0, 0.0), ("n", 0, 10.0)])
}

fn mixed() -> Recording {
    made(&[4, 7], &[("a", 0, 0.0), ("b", 1, 10.0)])
}

type Encode = fn(&Recording) -> Result<Vec<u8>, RecordingError>;

/// Runs the whole suite on a file, beside those that `encode` makes; a cut at one of `cuts` cannot be recognised.
fn conforms(name: &'static str, small: &[u8], cuts: Vec<usize>, numbers_per_byte: usize, encode: Encode) {
    conform(&Case {
        read: read(name),
        small,
        duplicates: &encode(&duplicates()).unwrap(),
        mixed_rates: &encode(&mixed()).unwrap(),
        unrecognisable_cuts: cuts,
        numbers_per_byte,
    });
}

/// A file without others beside it.
fn alone<'a>(
    name: &'static str,
    small: &'a [u8],
    cuts: Vec<usize>,
) -> Case<'a, impl Fn(&[u8]) -> Result<Content, String>> {
    Case {
        read: read(name),
        small,
        duplicates: &[],
        mixed_rates: &[],
        unrecognisable_cuts: cuts,
        numbers_per_byte: 1000,
    }
}

/// Reads a file whole, cut at every length, and with every byte corrupted.
fn survives_damage(name: &'static str, small: &[u8], cuts: Vec<usize>) {
    let case = alone(name, small, cuts);
    let content = (case.read)(small);
    assert!(content.as_ref().is_ok_and(|c| c.is_consistent() && c.numbers() > 0), "undamaged file: {content:?}");
    testkit::reader::reports_every_truncation(&case);
    testkit::reader::survives_every_corrupted_byte(&case);
}

/// On two clocks, long enough to be worth compressing.
fn longer() -> Recording {
    made(&[40, 100], &[("a", 0, 0.0), ("b", 1, 5.0)])
}

#[test]
fn exact_mdf3_conforms() {
    conform(&Case {
        read: read("small.mdf"),
        small: include_bytes!("data/small.mdf"),
        duplicates: include_bytes!("data/duplicates.mdf"),
        mixed_rates: include_bytes!("data/mixed.mdf"),
        unrecognisable_cuts: vec![],
        numbers_per_byte: 300,
    });
}

#[test]
fn exact_mdf4_of_asammdf_conforms() {
    conforms("small.mf4", include_bytes!("data/small.mf4"), vec![], 300, encode_mdf4);
}

#[test]
fn exact_deflated_mdf4_of_ours_conforms() {
    conforms("small.mf4", &encode_mdf4(&longer()).unwrap(), vec![], 1000, encode_mdf4);
}

/// The lengths after each line.
fn line_ends(text: &[u8]) -> Vec<usize> {
    let ends = text.iter().enumerate().filter(|(_, b)| **b == b'\n');
    ends.map(|(at, _)| at + 1).collect()
}

#[test]
fn exact_csv_conforms() {
    let small = encode_csv(&mixed()).unwrap();
    conforms("small.csv", &small, line_ends(&small), 1, encode_csv);
}

/// Text with everything that the reader knows.
#[test]
fn exact_csv_with_everything_survives_damage() {
    let small = "sep=;\nBench;4\n# by hand\nDate;time_1;\"n;1\";state;time_2;M\n;s;1/min;;s;Nm\n;;speed;;;\n\
        21.11.2026;23:59:59,5;1,5;on;21.11.2026 23:59:59;-\n22.11.2026;0:00:00;\"2,5\";off;;\n";
    survives_damage("small.csv", small.as_bytes(), line_ends(small.as_bytes()));
    assert!(read("small.csv")(small.as_bytes()).is_ok_and(|content| content.clocks.len() == 2));
}

#[test]
fn exact_mat5_of_ours_conforms() {
    conforms("small.mat", &encode_mat5(&longer()).unwrap(), vec![], 1000, encode_mat5);
}

#[test]
fn exact_mat73_survives_damage() {
    for small in [&include_bytes!("data/mat/small73.mat")[..], include_bytes!("data/mat/small.h5")] {
        survives_damage("small.mat", small, vec![]);
        testkit::reader::refuses_a_wrong_magic(&alone("small.mat", small, vec![]));
    }
}

#[cfg(feature = "parquet")]
#[test]
fn exact_parquet_conforms() {
    conforms("small.parquet", &recording::encode_parquet(&mixed()).unwrap(), vec![], 1000, recording::encode_parquet);
}

#[cfg(feature = "parquet")]
#[test]
fn exact_arrow_conforms() {
    conforms("small.arrow", &recording::encode_arrow(&mixed()).unwrap(), vec![], 1000, recording::encode_arrow);
}

#[cfg(feature = "parquet")]
#[test]
fn exact_arrow_streams_survive_damage() {
    survives_damage("small.arrow", &crate::tables::small_stream(), vec![]);
}

/// The lengths after each variable of a MAT-file of level 5.
fn variable_ends(bytes: &[u8]) -> Vec<usize> {
    let mut ends = vec![128];
    while let Some(size) = ends.last().and_then(|end| bytes.get(end + 4..end + 8)) {
        let size = u32::from_le_bytes(size.try_into().unwrap()) as usize;
        ends.push(ends[ends.len() - 1] + 8 + size);
    }
    ends
}

#[test]
fn exact_plain_mat5_conforms() {
    let variables = [("time", 4), ("a", 4), ("time_2", 7), ("b", 7)].map(|(name, n)| {
        let samples: Vec<f64> = (0..n).map(f64::from).collect();
        variable(name, &samples)
    });
    let header = &include_bytes!("data/mat/variables.mat")[..128];
    let small = [header, &variables.concat()].concat();
    let twice = [variable("a", &[1.0, 2.0, 3.0, 4.0]), variable("a", &[5.0, 6.0, 7.0, 8.0])];
    conform(&Case {
        read: read("small.mat"),
        small: &small,
        duplicates: &[header, &variables[0], &twice.concat()].concat(),
        mixed_rates: &small,
        unrecognisable_cuts: variable_ends(&small),
        numbers_per_byte: 1000,
    });
}

#[test]
fn exact_mat5_with_structs_survives_damage() {
    const FILES: [&[u8]; 3] = [
        include_bytes!("data/mat/variables.mat"),
        include_bytes!("data/mat/variables_deflated.mat"),
        include_bytes!("data/mat/tables.mat"),
    ];
    for small in FILES {
        survives_damage("small.mat", small, variable_ends(small));
    }
}

#[test]
fn exact_mat4_survives_damage() {
    let small = include_bytes!("data/mat/level4.mat");
    let field = |at: usize| u32::from_le_bytes(small[at..at + 4].try_into().unwrap()) as usize;
    // Of each variable: type, rows, columns, whether it is complex, bytes of its name.
    let mut ends = vec![0];
    while let Some(&at) = ends.last().filter(|&&at| at < small.len()) {
        let width = [8, 4, 4, 2, 2, 1][field(at) / 10 % 10];
        let numbers = field(at + 4) * field(at + 8) * (1 + field(at + 12));
        ends.push(at + 20 + field(at + 16) + width * numbers);
    }
    assert_eq!(ends.last(), Some(&small.len()));
    survives_damage("small.mat", small, ends);
    testkit::reader::refuses_a_wrong_magic(&alone("small.mat", small, vec![]));
}

/// The file with its records moved to the end, as a logger writes them; `link` is where their address is kept.
fn records_last(bytes: &[u8], at: usize, length: usize, link: std::ops::Range<usize>) -> Vec<u8> {
    let mut moved = bytes.to_vec();
    moved[at..at + length].fill(0xAA);
    let end = (moved.len() as u64).to_le_bytes();
    let width = link.len();
    moved[link].copy_from_slice(&end[..width]);
    moved.extend_from_slice(&bytes[at..at + length]);
    moved
}

fn find(bytes: &[u8], what: &[u8]) -> usize {
    bytes.windows(what.len()).position(|w| w == what).unwrap()
}

#[test]
fn exact_samples_before_a_cut_are_kept_mdf4() {
    let bytes = encode_mdf4(&made(&[10], &[("a", 0, 0.0)])).unwrap();
    let link = find(&bytes, b"##DG") + 24 + 16;
    let bytes = records_last(&bytes, find(&bytes, b"##DT"), 24 + 10 * 16, link..link + 8);
    let whole = decode("a.mf4", &bytes, &Selection::All).unwrap();
    assert_eq!((whole.findings, whole.channels[0].samples[9]), (vec![], 9.0));
    let cut = decode("a.mf4", &bytes[..bytes.len() - 40], &Selection::All).unwrap();
    let missing = Finding::MissingSamples { raster: 0, announced: 10, found: 7 };
    assert_eq!(cut.findings, [Finding::CutOff { offset: bytes.len() as u64 - 40 }, missing]);
    assert_eq!(cut.channels[0].samples, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
}

/// Small MDF 3 file, its records at the end: six of 18 bytes.
fn mdf3_records_last() -> Vec<u8> {
    let bytes = include_bytes!("data/small.mdf");
    let group = find(bytes, b"DG");
    let at = u32::from_le_bytes(bytes[group + 16..group + 20].try_into().unwrap());
    records_last(bytes, at as usize, 6 * 18, group + 16..group + 20)
}

#[test]
fn exact_samples_before_a_cut_are_kept_mdf3() {
    let bytes = mdf3_records_last();
    let whole = decode("a.mdf", &bytes, &Selection::All).unwrap();
    assert_eq!((whole.findings, whole.channels[1].samples[5]), (vec![], 60.0));
    let cut = decode("a.mdf", &bytes[..bytes.len() - 40], &Selection::All).unwrap();
    let missing = Finding::MissingSamples { raster: 0, announced: 6, found: 3 };
    assert_eq!(cut.findings, [Finding::CutOff { offset: bytes.len() as u64 - 40 }, missing]);
    assert_eq!(cut.channels[1].samples, [10.0, 20.0, 30.0]);
}

#[test]
fn exact_announced_counts_are_not_believed_mdf3() {
    for mut bytes in [mdf3_records_last(), include_bytes!("data/small.mdf").to_vec()] {
        let group = find(&bytes, b"CG");
        bytes[group + 22..group + 26].copy_from_slice(&u32::MAX.to_le_bytes());
        match decode("a.mdf", &bytes, &Selection::All) {
            Ok(r) => {
                assert!(r.findings.iter().any(Finding::is_loss) && r.channels[0].samples.len() == 6)
            }
            Err(error) => assert!(matches!(error, RecordingError::Truncated { .. }), "{error}"),
        }
    }
}

#[test]
fn exact_shared_blocks_are_refused() {
    let mut bytes = include_bytes!("data/small.mdf").to_vec();
    let group = bytes.windows(2).position(|w| w == b"DG").unwrap();
    let itself = u32::try_from(group).unwrap();
    bytes[group + 4..group + 8].copy_from_slice(&itself.to_le_bytes());
    let error = decode("a.mdf", &bytes, &Selection::All).unwrap_err();
    assert!(matches!(error, RecordingError::Damaged { offset: Some(_), .. }), "{error}");
}

#[test]
fn exact_repeated_data_blocks_are_refused() {
    let small = made(&[100], &[("a", 0, 0.0)]);
    let mut bytes = encode_mdf4(&small).unwrap();
    let block = find(&bytes, b"##DZ") as u64;
    let group = find(&bytes, b"##DG");
    let count = 10_000_u64;
    let list = bytes.len() as u64;
    bytes[group + 40..group + 48].copy_from_slice(&list.to_le_bytes());
    bytes.extend_from_slice(b"##DL\0\0\0\0");
    for field in [24 + 8 * (count + 1) + 16, count + 1, 0] {
        bytes.extend_from_slice(&field.to_le_bytes());
    }
    (0..count).for_each(|_| bytes.extend_from_slice(&block.to_le_bytes()));
    bytes.extend_from_slice(&(1 | (count << 32)).to_le_bytes());
    bytes.extend_from_slice(&1600_u64.to_le_bytes());
    let error = decode("a.mf4", &bytes, &Selection::All).unwrap_err();
    assert!(error.to_string().contains("repeatedly"), "{error}");
}

/// A MAT-file of level 5 with one variable, deflated.
fn deflated_mat5(variable: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    std::io::Write::write_all(&mut encoder, variable).unwrap();
    let packed = encoder.finish().unwrap();
    let size = u32::try_from(packed.len()).unwrap();
    let header = &include_bytes!("data/mat/variables.mat")[..128];
    [header, &15_u32.to_le_bytes(), &size.to_le_bytes(), &packed].concat()
}

#[test]
fn exact_deflate_bombs_stop_at_what_is_announced_mat5() {
    let inner = variable("x", &[1.0, 2.0]);
    let bytes = deflated_mat5(&[&inner[..], &vec![0; 64 << 20]].concat());
    let error = decode("a.mat", &bytes, &Selection::All).unwrap_err();
    assert!(error.to_string().contains("has more or less"), "{error}");
    let mut huge = vec![0; 1 << 20];
    huge[..8].copy_from_slice(&[14, 0, 0, 0, 0xF8, 0xFF, 0xFF, 0xFF]);
    let error = decode("a.mat", &deflated_mat5(&huge), &Selection::All).unwrap_err();
    assert!(error.to_string().contains("4294967288 bytes is deflated"), "{error}");
}

/// Cells within cells, `depth` of them, or `width` empty cells in one.
fn cells(depth: usize, width: u32) -> Vec<u8> {
    let mut content = vec![];
    for level in 0..depth {
        let count = if level == 0 { width } else { 1 };
        let mut matrix = mat::element(6, &[1, 0, 0, 0, 0, 0, 0, 0]);
        matrix.extend(mat::element(5, &[1_u32.to_le_bytes(), count.to_le_bytes()].concat()));
        matrix.extend(mat::element(1, if level + 1 == depth { b"c" } else { b"" }));
        matrix.extend(if level == 0 { mat::element(14, &[]).repeat(width as usize) } else { content });
        content = mat::element(14, &matrix);
    }
    content
}

#[test]
fn exact_nesting_and_number_of_cells_are_bounded_mat5() {
    for (depth, width, refused) in [(3, 2, false), (500, 1, true), (1, 1 << 20, true)] {
        let after = variable("gain", &[1.0]);
        let mut bytes = deflated_mat5(&cells(depth, width));
        bytes.extend_from_slice(&after);
        let recording = decode("a.mat", &bytes, &Selection::All).unwrap();
        let is_refused = |f: &Finding| {
            let reason = |r: &SkipReason| matches!(r, SkipReason::Unsupported { .. });
            matches!(f, Finding::SkippedChannel { channel, reason: r } if channel == "c" && reason(r))
        };
        assert_eq!(recording.findings.iter().any(is_refused), refused, "{depth} {width}");
        let last = recording.findings.last().unwrap().to_string();
        assert!(last.contains("\"gain\""), "{last}");
    }
}

#[test]
fn exact_announced_sizes_are_not_believed_mat5() {
    let good = variable("x", &[1.0, 2.0]);
    let at = 8 + 16 + 8;
    for (rows, columns) in [(u32::MAX, 1_u32), (3, 1), (1, 1)] {
        let mut bad = good.clone();
        bad[at..at + 8].copy_from_slice(&[rows.to_le_bytes(), columns.to_le_bytes()].concat());
        let error = decode("a.mat", &deflated_mat5(&bad), &Selection::All).unwrap_err();
        assert!(matches!(error, RecordingError::Damaged { offset: Some(128), .. }), "{error}");
    }
}

proptest::proptest! {
    /// Deflated content is hit too: some bytes of the variables are replaced before they are deflated.
    #[test]
    fn prop_damaged_content_does_no_harm_mat5(
        hits in proptest::collection::vec((8_usize..4500, proptest::prelude::any::<u8>()), 1..6)
    ) {
        let whole = include_bytes!("data/mat/variables.mat");
        let mut at = 128;
        let mut bytes = whole[..128].to_vec();
        while at < whole.len() {
            let size = u32::from_le_bytes(whole[at + 4..at + 8].try_into().unwrap()) as usize;
            let mut matrix = whole[at..at + 8 + size].to_vec();
            for (place, value) in &hits {
                if let Some(byte) = place.checked_sub(at).and_then(|p| matrix.get_mut(p)) {
                    *byte = *value;
                }
            }
            bytes.extend_from_slice(&deflated_mat5(&matrix)[128..]);
            at += 8 + size;
        }
        for result in [decode("a.mat", &bytes, &Selection::All), recording::decode_untimed("a.mat", &bytes, 0.1)] {
            let Ok(recording) = result else { continue };
            for channel in &recording.channels {
                let time_s = recording.time_s(channel);
                proptest::prop_assert_eq!(time_s.map(<[f64]>::len), Some(channel.samples.len()));
            }
        }
    }
}

#[test]
fn exact_lines_of_text_and_fields_are_bounded_mat5() {
    let header = |class: u8, rows: u32, columns: u32| {
        let flags = mat::element(6, &[class, 0, 0, 0, 0, 0, 0, 0]);
        let dimensions = mat::element(5, &[rows.to_le_bytes(), columns.to_le_bytes()].concat());
        [flags, dimensions, mat::element(1, b"x")].concat()
    };
    let lines = [header(4, 1 << 19, 1), mat::element(2, &vec![b'a'; 1 << 19])].concat();
    let width = mat::element(5, &1_u32.to_le_bytes());
    let fields = [header(2, 0, 0), width, mat::element(1, &vec![b'a'; 1 << 19])].concat();
    for content in [lines, fields] {
        let bytes = deflated_mat5(&mat::element(14, &content));
        let recording = decode("a.mat", &bytes, &Selection::All).unwrap();
        assert!(recording.findings[0].to_string().contains("fields and lines of text"), "{:?}", recording.findings);
    }
}
