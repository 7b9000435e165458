//! Files that were written are read back, number for number.

use proptest::collection::vec;
use proptest::prelude::*;
use recording::{
    Channel, Format, Raster, Recording, RecordingError, Selection, StartTime, decode, encode_csv, encode_mat5,
    encode_mdf4, encode_tsv, fits_text,
};

/// Any number, NaN and infinities included; time stamps need not increase.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>(), Just(f64::NAN), -1e3..1e3, Just(-0.0)]
}

fn channel(raster: usize, samples: usize) -> impl Strategy<Value = Channel> {
    let texts = (
        "[a-zA-Z][A-Za-z0-9_°ä ,.\"()\\[\\]]{0,12}[A-Za-z0-9\\])]",
        "[a-zA-Z/°µ%^0-9]{0,6}",
        "([!-~][ -~]{0,20}[!-~])?",
    );
    (texts, vec(number(), samples)).prop_map(move |((name, unit, comment), samples)| Channel {
        name: format!("x{name}"),
        unit,
        comment,
        raster,
        samples,
    })
}

fn raster(index: usize) -> impl Strategy<Value = (Raster, Vec<Channel>)> {
    (1_usize..200, 1_usize..4).prop_flat_map(move |(samples, channels)| {
        let raster = (vec(number(), samples), proptest::option::of("[a-z]{1,8}"));
        let raster = raster.prop_map(|(time_s, name)| Raster { time_s, name });
        (raster, vec(channel(index, samples), channels))
    })
}

fn recording() -> impl Strategy<Value = Recording> {
    let start = (1_i64.., any::<bool>(), proptest::option::of(-840..840))
        .prop_map(|(nanoseconds, is_local, utc_offset_min)| StartTime { nanoseconds, is_local, utc_offset_min });
    let comment = proptest::option::of("[!-~][ -~]{0,20}[!-~]");
    (raster(0), raster(1), comment, proptest::option::of(start)).prop_map(|(a, b, comment, start_time)| Recording {
        format: Format::Mdf { version: 410 },
        comment,
        start_time,
        rasters: vec![a.0, b.0],
        channels: [a.1, b.1].concat(),
        findings: vec![],
    })
}

fn bits(samples: &[f64]) -> Vec<u64> {
    samples.iter().map(|s| s.to_bits()).collect()
}

/// NaN of any kind is the same.
fn values(samples: &[f64]) -> Vec<u64> {
    samples.iter().map(|s| if s.is_nan() { u64::MAX } else { s.to_bits() }).collect()
}

fn bit_for_bit(read: &Recording, written: &Recording) -> Result<(), TestCaseError> {
    prop_assert_eq!((&read.comment, read.start_time), (&written.comment, written.start_time));
    prop_assert_eq!(read.channels.len(), written.channels.len());
    for (r, w) in read.rasters.iter().zip(&written.rasters) {
        prop_assert_eq!(&r.name, &w.name);
        prop_assert_eq!(bits(&r.time_s), bits(&w.time_s));
    }
    for (r, w) in read.channels.iter().zip(&written.channels) {
        prop_assert_eq!((&r.name, &r.unit, &r.comment, r.raster), (&w.name, &w.unit, &w.comment, w.raster));
        prop_assert_eq!(bits(&r.samples), bits(&w.samples));
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn prop_mdf4_is_read_back_bit_for_bit(written in recording()) {
        bit_for_bit(&decode("a.mf4", &encode_mdf4(&written).unwrap(), &Selection::All).unwrap(), &written)?;
    }

    #[cfg(feature = "parquet")]
    #[test]
    fn prop_tables_are_read_back_bit_for_bit(written in recording()) {
        for bytes in [recording::encode_parquet(&written).unwrap(), recording::encode_arrow(&written).unwrap()] {
            bit_for_bit(&decode("a", &bytes, &Selection::All).unwrap(), &written)?;
        }
    }

    #[test]
    fn prop_mat5_is_read_back_bit_for_bit(written in recording()) {
        bit_for_bit(&decode("a.mat", &encode_mat5(&written).unwrap(), &Selection::All).unwrap(), &written)?;
    }

    #[test]
    fn prop_csv_is_read_back_number_for_number(written in recording()) {
        for bytes in [encode_csv(&written).unwrap(), encode_tsv(&written).unwrap()] {
            let read = decode("a.csv", &bytes, &Selection::All).unwrap();
            prop_assert_eq!(read.channels.len(), written.channels.len());
            for (r, w) in read.rasters.iter().zip(&written.rasters) {
                prop_assert_eq!(values(&r.time_s), values(&w.time_s));
            }
            for (r, w) in read.channels.iter().zip(&written.channels) {
                prop_assert_eq!((&r.name, &r.unit, r.raster), (&w.name, &w.unit, w.raster));
                prop_assert_eq!(values(&r.samples), values(&w.samples));
            }
        }
    }

    #[test]
    fn prop_headings_that_fit_text_are_read_back(name in "[ -~°ä\t\n]{0,10}", unit in "[ -~°\n]{0,6}") {
        let recording = one(&name, &unit);
        match fits_text(&name, &unit) {
            false => prop_assert!(encode_csv(&recording).is_err()),
            true => {
                for bytes in [encode_csv(&recording).unwrap(), encode_tsv(&recording).unwrap()] {
                    let read = decode("a.csv", &bytes, &Selection::All).unwrap();
                    prop_assert_eq!((&read.channels[0].name, &read.channels[0].unit), (&name, &unit));
                }
            }
        }
    }
}

#[test]
fn regress_names_that_text_reads_as_something_else_do_not_fit_it() {
    for name in ["2026-11-21", "12:34:56", "a\u{1}b", "a\tb", "time", " a", "time_slow", "dead time", "t2"] {
        assert!(!fits_text(name, ""), "{name:?}");
    }
    assert!(fits_text("12", "Nm") && fits_text("Speed 2026-11-21", "rpm"));
    assert!(fits_text("t_oil", "°C") && fits_text("injection duration", "ms") && fits_text("dead time_channel", "ms"));
}

/// A recording of one channel.
fn one(name: &str, unit: &str) -> Recording {
    let (name, unit) = (name.to_owned(), unit.to_owned());
    Recording {
        format: Format::Mdf { version: 410 },
        comment: None,
        start_time: None,
        rasters: vec![Raster { time_s: vec![0.0, 1.0], name: None }],
        channels: vec![Channel { name, unit, comment: String::new(), raster: 0, samples: vec![1.5, 2.5] }],
        findings: vec![],
    }
}

#[test]
fn exact_numbers_that_look_grouped_are_written_so_that_they_are_not() {
    let mut recording = one("x", "");
    recording.rasters[0].time_s = vec![1.001, 1.002];
    recording.channels[0].samples = vec![1.234, 12.345];
    let read = decode("a.tsv", &encode_tsv(&recording).unwrap(), &Selection::All).unwrap();
    assert_eq!((&read.channels, &read.rasters), (&recording.channels, &recording.rasters));
}

#[test]
fn exact_a_raster_without_samples_comes_last_in_text() {
    let mut recording = one("x", "V");
    recording.rasters.insert(0, Raster { time_s: vec![], name: None });
    recording.channels[0].raster = 1;
    let (unit, comment) = ("A".to_owned(), String::new());
    recording.channels.push(Channel { name: "y".into(), unit, comment, raster: 0, samples: vec![] });
    let read = decode("a.csv", &encode_csv(&recording).unwrap(), &Selection::All).unwrap();
    let found: Vec<_> = read.channels.iter().map(|c| (c.name.as_str(), c.unit.as_str(), c.samples.len())).collect();
    assert_eq!(found, [("x", "V", 2), ("y", "A", 0)]);
}

#[test]
fn exact_a_raster_without_channels_is_not_written_as_text() {
    let mut recording = one("x", "V");
    recording.rasters.push(Raster { time_s: vec![0.0, 1.0, 2.0], name: None });
    assert_eq!(encode_csv(&recording).unwrap(), encode_csv(&one("x", "V")).unwrap());
}

#[test]
fn exact_contradictions_are_not_written() {
    let channel =
        Channel { name: "n".into(), unit: String::new(), comment: String::new(), raster: 0, samples: vec![1.0] };
    let mut recording = Recording {
        format: Format::Mdf { version: 410 },
        comment: None,
        start_time: None,
        rasters: vec![],
        channels: vec![channel],
        findings: vec![],
    };
    for encode in [encode_mdf4, encode_csv, encode_mat5] {
        assert!(matches!(encode(&recording), Err(RecordingError::NoSuchRaster { .. })));
    }
    recording.rasters.push(Raster { time_s: vec![], name: None });
    for encode in [encode_mdf4, encode_csv, encode_mat5] {
        assert!(matches!(encode(&recording), Err(RecordingError::LengthMismatch { .. })));
    }
}
