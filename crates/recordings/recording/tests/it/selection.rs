//! Of every format only what is selected is read, whatever lies around it.

use std::sync::Arc;

use recording::{
    Channel, Format, Raster, Recording, RecordingError, Selection, Source, catalogue_from, decode, decode_from,
    encode_csv, encode_mat5, encode_mdf4,
};
use work::Context;

const CHANNELS: usize = 40;
const SAMPLES: usize = 20_000;

/// Channels of noise, so that nothing can be packed away, some with names that MATLAB has to change.
fn noisy() -> Recording {
    let noise = |k: usize, i: usize| {
        let mixed = ((k * SAMPLES + i) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9) as f64 / 1e3
    };
    let channel = |k: usize| Channel {
        name: if k.is_multiple_of(2) { format!("Speed {k}(°)") } else { format!("torque_{k}") },
        unit: "Nm".into(),
        comment: String::new(),
        raster: 0,
        samples: (0..SAMPLES).map(|i| noise(k, i)).collect(),
    };
    Recording {
        format: Format::Mdf { version: 410 },
        comment: None,
        start_time: None,
        rasters: vec![Raster { time_s: (0..SAMPLES).map(|i| i as f64 * 1e-3).collect(), name: None }],
        channels: (0..CHANNELS).map(channel).collect(),
        findings: vec![],
    }
}

/// The formats, with whether their readers skip what is not selected.
fn encoded(recording: &Recording) -> Vec<(&'static str, Vec<u8>, bool)> {
    let mut all = vec![
        ("a.csv", encode_csv(recording).unwrap(), false),
        ("a.mf4", encode_mdf4(recording).unwrap(), false),
        ("a.mat", encode_mat5(recording).unwrap(), true),
    ];
    if cfg!(feature = "parquet") {
        all.extend(tables(recording));
    }
    all
}

#[cfg(feature = "parquet")]
fn tables(recording: &Recording) -> [(&'static str, Vec<u8>, bool); 2] {
    [
        ("a.parquet", recording::encode_parquet(recording).unwrap(), true),
        ("a.arrow", recording::encode_arrow(recording).unwrap(), true),
    ]
}

#[cfg(not(feature = "parquet"))]
fn tables(_: &Recording) -> [(&'static str, Vec<u8>, bool); 0] {
    []
}

/// A source that counts the bytes that are read and the most that are read at once.
struct Counted {
    bytes: Vec<u8>,
    read: std::sync::Mutex<(usize, usize)>,
}

impl Source for Counted {
    fn size(&self) -> std::io::Result<u64> {
        self.bytes.size()
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> std::io::Result<()> {
        let mut read = self.read.lock().unwrap();
        *read = (read.0 + buffer.len(), read.1.max(buffer.len()));
        self.bytes.read_at(offset, buffer)
    }
}

#[test]
fn exact_selected_channels_are_read_without_the_others() {
    let recording = noisy();
    for (name, bytes, skips) in encoded(&recording) {
        let size = bytes.len();
        let source = Arc::new(Counted { bytes, read: Default::default() });
        let selection = Selection::names(["torque_7", "Speed 8(°)"]);
        let some = decode_from(name, source.clone(), &selection, None, &Context::new()).unwrap();
        let (read, at_once) = *source.read.lock().unwrap();
        let expected: Vec<&Channel> = vec![&recording.channels[7], &recording.channels[8]];
        assert_eq!(some.channels.iter().collect::<Vec<_>>(), expected, "{name}");
        assert_eq!(some.rasters[0].time_s, recording.rasters[0].time_s, "{name}");
        assert!(!skips || read < size / 4, "{name}: {read} of {size} bytes were read");
        assert!(at_once <= 9 << 20, "{name}: {at_once} bytes were read at once");
    }
}

/// A list is made of the structure, and of what tells the clocks.
#[test]
fn exact_lists_are_made_without_the_samples() {
    let recording = noisy();
    for (name, bytes, _) in encoded(&recording) {
        let mut expected = decode(name, &bytes, &Selection::All).unwrap().catalogue();
        if name == "a.csv" {
            // Only its end would tell.
            expected.rasters[0].samples = None;
        }
        let size = bytes.len();
        let source = Arc::new(Counted { bytes, read: Default::default() });
        assert_eq!(catalogue_from(name, source.clone()).unwrap(), expected, "{name}");
        let (read, _) = *source.read.lock().unwrap();
        assert!(read < size / 7, "{name}: {read} of {size} bytes were read");
    }
}

/// Files are written piece by piece.
#[test]
fn exact_files_are_written_in_pieces() {
    struct Most(std::io::Cursor<Vec<u8>>, usize);
    impl std::io::Write for Most {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.1 = self.1.max(bytes.len());
            self.0.write(bytes)
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    impl std::io::Seek for Most {
        fn seek(&mut self, to: std::io::SeekFrom) -> std::io::Result<u64> {
            self.0.seek(to)
        }
    }
    let recording = noisy();
    type Write = fn(&Recording, &mut Most) -> Result<(), RecordingError>;
    let mut writers: Vec<(&str, Write)> = vec![
        ("a.csv", |recording, out| recording::write_csv(recording, out)),
        ("a.mf4", |recording, out| recording::write_mdf4(recording, recording::PROGRAM, out)),
        ("a.mat", |recording, out| recording::write_mat5(recording, recording::PROGRAM, out)),
    ];
    #[cfg(feature = "parquet")]
    writers.extend([
        ("a.parquet", (|recording, out| recording::write_parquet(recording, recording::PROGRAM, out)) as Write),
        ("a.arrow", |recording, out| recording::write_arrow(recording, out)),
    ]);
    let whole = encoded(&recording);
    for (name, write) in writers {
        let mut out = Most(Default::default(), 0);
        write(&recording, &mut out).unwrap();
        let (_, bytes, _) = whole.iter().find(|(other, ..)| *other == name).unwrap();
        assert!(out.0.get_ref() == bytes, "{name}");
        assert!(out.1 <= 9 << 19, "{name}: {} bytes were written at once", out.1);
    }
}

#[test]
fn exact_patterns_select_by_stars_and_question_marks() {
    let recording = noisy();
    for (name, bytes, _) in encoded(&recording) {
        let names = |patterns: &[&str]| {
            let selection = Selection::Patterns(patterns.iter().map(|p| (*p).to_owned()).collect());
            let channels = decode(name, &bytes, &selection).map(|r| r.channels);
            channels.map(|channels| channels.into_iter().map(|c| c.name).collect::<Vec<_>>())
        };
        assert_eq!(
            names(&["torque_?"]).unwrap(),
            ["torque_1", "torque_3", "torque_5", "torque_7", "torque_9"],
            "{name}"
        );
        assert_eq!(names(&["*_11", "Speed 1*(°)"]).unwrap().len(), 6, "{name}");
        let error = names(&["torque_7", "Torqe_9"]).unwrap_err();
        assert!(error.to_string().contains("\"torque_9\""), "{name}: {error}");
        assert!(matches!(names(&["z*"]), Err(RecordingError::NoSuchChannel { .. })), "{name}");
    }
}

/// Text is read in pieces of megabytes; what lies across their ends is the same.
#[test]
fn exact_text_is_read_across_the_ends_of_pieces() {
    let line = |i: usize| format!("{};\"note {i}\nof two lines \"\"ä\"\" 😀\";{}\r\n", i as f64 / 1e3, i as f64 * 0.5);
    let content: String = (0..700_000).map(line).collect();
    let text = format!("t [s];note;größe [µm]\r\n{content}");
    let utf16: Vec<u8> = [0xFEFF].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    let latin1: Vec<u8> = text.replace('😀', "-").chars().map(|c| u32::from(c) as u8).collect();
    for bytes in [text.into_bytes(), utf16, latin1] {
        assert!(bytes.len() > 24 << 20, "more than the piece in which the heading is looked for");
        let recording = decode("a.csv", &bytes, &Selection::All).unwrap();
        let channel = &recording.channels[0];
        assert_eq!((channel.name.as_str(), channel.unit.as_str(), channel.samples.len()), ("größe", "µm", 700_000));
        let is_right = |(i, (t, v)): (usize, (&f64, &f64))| *t == i as f64 / 1e3 && *v == i as f64 * 0.5;
        assert!(recording.rasters[0].time_s.iter().zip(&channel.samples).enumerate().all(is_right));
    }
}

/// An error tells the line, wherever in the file.
#[test]
fn regress_lines_are_counted_across_pieces() {
    let mut text: String = String::from("t [s];x\n");
    (0..2_500_000).for_each(|i| text.push_str(&format!("{i};{i}.5\n")));
    text.push_str("2500000;1.5;7\n");
    let error = decode("a.csv", text.as_bytes(), &Selection::All).unwrap_err();
    assert!(matches!(error, RecordingError::Csv { line: 2_500_002, .. }), "{error}");
}
