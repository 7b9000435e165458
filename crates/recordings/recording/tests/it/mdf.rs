//! Small MDF files with known content.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use recording::{
    Channel, Finding, Format, Raster, Recording, RecordingError, Selection, SkipReason, Source, catalogue,
    catalogue_from, decode, decode_from, decode_untimed, encode_csv, encode_mdf4,
};
use work::Context;

fn small(name: &str) -> &'static [u8] {
    match name {
        "small.mdf" => include_bytes!("data/small.mdf"),
        _ => include_bytes!("data/small.mf4"),
    }
}

fn read(name: &str) -> Recording {
    decode(name, small(name), &Selection::All).unwrap()
}

const TIME: [f64; 6] = [0.0, 0.01, 0.02, 0.03, 0.04, 0.05];

#[test]
fn ref_small_mdf3_is_as_written() {
    let recording = read("small.mdf");
    assert_eq!(recording.format.to_string(), "MDF 3.30");
    assert_eq!(recording.rasters.len(), 1);
    assert_eq!(recording.rasters[0].time_s, TIME);
    assert_eq!(recording.rasters[0].name.as_deref(), Some("grp"));
    let torque = recording.channel("Drehmoment").unwrap();
    assert_eq!((torque.unit.as_str(), &torque.samples[..]), ("Nm", &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0][..]));
    assert_eq!(recording.findings, []);
}

#[test]
fn regress_mdf3_texts_are_latin1() {
    let oil = read("small.mdf").channel("Öltemperatur").cloned().unwrap();
    assert_eq!((oil.unit.as_str(), oil.samples[1]), ("°C", 20.0));
}

#[test]
fn ref_small_mdf4_is_as_written() {
    let recording = read("small.mf4");
    assert_eq!(recording.format.to_string(), "MDF 4.10");
    assert_eq!(recording.rasters[0].time_s, TIME);
    let names: Vec<_> = recording.channels.iter().map(|c| (c.name.as_str(), c.unit.as_str())).collect();
    assert_eq!(names, [("Torque", "Nm"), ("Count", "-")]);
    assert_eq!(recording.channels[1].samples, [10.0, 20.0, 30.0, 40.0, 50.0, 60.0]);
    assert!(recording.start_time.is_some());
}

#[test]
fn exact_catalogue_is_the_recording_without_samples() {
    for name in ["small.mdf", "small.mf4"] {
        assert_eq!(catalogue(name, small(name)).unwrap(), read(name).catalogue(), "{name}");
    }
}

#[test]
fn exact_selection_takes_names_only() {
    let some = decode("small.mf4", small("small.mf4"), &Selection::names(["Count"])).unwrap();
    assert_eq!((some.channels.len(), some.channels[0].name.as_str()), (1, "Count"));
    let error = decode("small.mf4", small("small.mf4"), &Selection::names(["count"])).unwrap_err();
    assert!(matches!(error, RecordingError::NoSuchChannel { .. }));
    assert_eq!(error.to_string(), "small.mf4: there is no channel \"count\"; did you mean \"Count\"?");
}

#[test]
fn exact_duplicates_are_kept_and_reported() {
    let bytes = include_bytes!("data/duplicates.mdf");
    let recording = decode("duplicates.mdf", bytes, &Selection::names(["n"])).unwrap();
    assert_eq!(recording.channels.len(), 2);
    assert_eq!(recording.findings, [Finding::DuplicateName { name: "n".into(), count: 2 }]);
}

#[test]
fn exact_groups_without_a_clock_are_skipped() {
    // The time channel of the only group made an ordinary one.
    let mut bytes = small("small.mf4").to_vec();
    let master =
        bytes.windows(8).enumerate().position(|(at, w)| w.starts_with(b"##CN") && bytes[at + 88] == 2).unwrap();
    bytes[master + 88..master + 90].copy_from_slice(&[0, 0]);
    let recording = decode("a.mf4", &bytes, &Selection::All).unwrap();
    assert_eq!((recording.rasters.len(), recording.channels.len()), (0, 0));
    let reason = SkipReason::NoTime;
    let channel = String::from("Torque");
    assert!(recording.findings.contains(&Finding::SkippedChannel { channel, reason }));
    let error = decode("a.mf4", &bytes, &Selection::names(["Torque"])).unwrap_err();
    assert!(error.to_string().contains("its group has no time channel; give the sample time"), "{error}");
    let counted = decode_untimed("a.mf4", &bytes, 0.5).unwrap();
    assert_eq!(counted.channel("Torque").unwrap().samples, read("small.mf4").channels[0].samples);
    assert_eq!(counted.rasters[0].time_s, [0.0, 0.5, 1.0, 1.5, 2.0, 2.5]);
}

/// Of the master's unit nothing is believed, but it is said.
#[test]
fn exact_a_clock_in_another_unit_is_said() {
    let recording = read("small.mf4");
    let bytes = encode_mdf4(&recording).unwrap();
    let unit = bytes.windows(26).position(|w| w.starts_with(b"##TX") && w[24..26] == *b"s\0").unwrap() + 24;
    let mut minutes = bytes.clone();
    minutes[unit] = b'h';
    let read = decode("a.mf4", &minutes, &Selection::All).unwrap();
    assert_eq!(read.rasters, recording.rasters);
    assert_eq!(read.findings, [Finding::IgnoredTimeUnit { raster: 0, unit: "h".into() }]);
    assert_eq!(catalogue("a.mf4", &minutes).unwrap().findings, read.findings);
}

#[test]
fn exact_records_of_a_closed_file_that_are_not_announced_are_said() {
    let mut bytes = small("small.mf4").to_vec();
    let group = bytes.windows(4).position(|w| w == b"##CG").unwrap();
    let links = usize::from(bytes[group + 16]);
    let cycles = group + 24 + 8 * links + 8;
    assert_eq!(bytes[cycles], 6);
    bytes[cycles] = 0;
    let recording = decode("a.mf4", &bytes, &Selection::All).unwrap();
    assert_eq!(recording.channels[0].samples.len(), 6);
    assert_eq!(recording.findings, [Finding::UnannouncedSamples { raster: 0, announced: 0, found: 6 }]);
}

/// Bytes that tell how many of them were read.
struct Counted {
    bytes: Vec<u8>,
    read: AtomicU64,
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

/// Two rasters of noise, the first far larger than the second.
fn noisy() -> Recording {
    let lengths = [400_000, 1000];
    let noise = |i: usize| ((i as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 11) as f64;
    let channel = |raster: usize| Channel {
        name: format!("noise {raster}"),
        unit: "Nm".into(),
        comment: String::new(),
        raster,
        samples: (0..lengths[raster]).map(noise).collect(),
    };
    Recording {
        format: Format::Mdf { version: 410 },
        comment: None,
        start_time: None,
        rasters: lengths.map(|n| Raster { time_s: (0..n).map(|i| i as f64).collect(), name: None }).to_vec(),
        channels: vec![channel(0), channel(1)],
        findings: vec![],
    }
}

#[test]
fn exact_of_a_source_only_what_is_asked_for_is_read() {
    let recording = noisy();
    let source = Arc::new(Counted { bytes: encode_mdf4(&recording).unwrap(), read: AtomicU64::new(0) });
    let size = source.bytes.len() as u64;
    assert_eq!(catalogue_from("a.mf4", source.clone()).unwrap(), recording.catalogue());
    let listed = source.read.swap(0, Ordering::Relaxed);
    // The structure is read in pages of 32 kB.
    assert!(listed < size / 8, "{listed} of {size} bytes were read to list the channels");
    let some = decode_from("a.mf4", source.clone(), &Selection::names(["noise 1"]), None, &Context::new()).unwrap();
    let read = source.read.swap(0, Ordering::Relaxed);
    assert_eq!(some.channels[0].samples, recording.channels[1].samples);
    assert!(read < size / 8, "{read} of {size} bytes were read for the smaller raster");
    let told = Arc::new(AtomicU64::new(0));
    let hears = Arc::clone(&told);
    let context = Context::new().with_listener(move |one| {
        assert!(hears.fetch_max(one.done, Ordering::Relaxed) <= one.total && one.done <= one.total);
    });
    let step = context.step("reading", 0);
    assert_eq!(decode_from("a.mf4", source, &Selection::All, None, &step).unwrap(), recording);
    assert_eq!(told.load(Ordering::Relaxed), 401_000 * 16);
}

#[test]
fn exact_other_formats_are_read_from_a_source_too() {
    let text = encode_csv(&read("small.mf4")).unwrap();
    let from_bytes = decode("a.csv", &text, &Selection::All).unwrap();
    let text = Arc::new(text);
    assert_eq!(decode_from("a.csv", text.clone(), &Selection::All, None, &Context::new()).unwrap(), from_bytes);
    assert_eq!(catalogue_from("a.csv", text).unwrap(), from_bytes.catalogue());
    let error = decode_from("a.mf4", Arc::new(Vec::new()), &Selection::All, None, &Context::new()).unwrap_err();
    assert!(matches!(error, RecordingError::Empty { .. }), "{error}");
}
