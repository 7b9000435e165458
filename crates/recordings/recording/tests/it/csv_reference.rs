//! Text files of others, against what `data/csv/make.py` reads in them, or the reason why they are refused.

use std::collections::BTreeMap;

use recording::{CsvProblem, Recording, RecordingError, Selection, decode, decode_untimed};

use testdata::shared;

/// FNV-1a over the little-endian bytes; NaN as Python has it.
fn checksum(samples: &[f64]) -> u64 {
    let bits = samples.iter().map(|s| if s.is_nan() { 0x7FF8_0000_0000_0000 } else { s.to_bits() });
    let bytes = bits.flat_map(u64::to_le_bytes);
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn lines(recording: &Recording) -> Vec<String> {
    let line = |c: &recording::Channel| {
        let time_s = recording.time_s(c).unwrap();
        let (time, samples) = (checksum(time_s), checksum(&c.samples));
        format!("{}\t{}\t{}\t{time:016x}\t{samples:016x}", c.name, c.unit, time_s.len())
    };
    recording.channels.iter().map(line).collect()
}

#[test]
fn ref_text_files_equal_python() {
    let mut files: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for line in include_str!("data/csv/reference.txt").lines().filter(|l| !l.starts_with('#')) {
        let (file, rest) = line.split_once('\t').unwrap();
        files.entry(file).or_default().push(rest);
    }
    for (file, expected) in files {
        let Some(path) = shared(&format!("reference/{file}")) else { continue };
        let bytes = std::fs::read(path).unwrap();
        let recording = decode(file, &bytes, &Selection::All).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(lines(&recording), expected, "{file}");
    }
}

/// Files that cannot be read right, with the reason that the user gets.
#[test]
fn ref_text_files_without_time_are_refused_with_a_reason() {
    let no_time = |name: &str| CsvProblem::NoTime { name: name.into() };
    let refused = [
        ("aalto-drivetrain/step_motor.csv", 1, CsvProblem::NoHeader),
        ("aalto-drivetrain/step_sensor.csv", 1, CsvProblem::NoHeader),
        ("aalto-drivetrain/sin_motor.csv", 1, CsvProblem::NoHeader),
        ("aalto-drivetrain/sin_sensor.csv", 1, CsvProblem::NoHeader),
        ("aalto-drivetrain/models/tb_A.csv", 1, CsvProblem::NoHeader),
        ("aalto-drivetrain/models/tb_T.csv", 1, CsvProblem::NoHeader),
        ("peers/cstr_daisy.csv", 1, no_time("q")),
        ("peers/dryer_slicot.csv", 1, no_time("u")),
        ("peers/gas_furnace_seriesJ.csv", 1, no_time("u")),
        ("peers/r_armaxsim.csv", 1, no_time("u")),
        ("peers/r_arxsim.csv", 1, no_time("u")),
        ("peers/r_bjsim.csv", 1, no_time("u")),
        ("peers/r_oesim.csv", 1, no_time("u")),
        // The names stand on two lines, and above one column on the first of them only.
        ("engine-ecu/dyno_vcds_sample_2.CSV", 8, CsvProblem::NoName),
        ("inertia-dyno/20V__20V4A.txt", 1, CsvProblem::NoDelimiter),
        ("wheel-with-bolts/test0-255_6ms.dat", 2, no_time("dt")),
    ];
    for (file, line, problem) in refused {
        let Some(path) = shared(&format!("reference/{file}")) else { continue };
        let error = decode(file, &std::fs::read(path).unwrap(), &Selection::All).unwrap_err();
        match error {
            RecordingError::Csv { line: at, problem: found, .. } => assert_eq!((at, found), (line, problem), "{file}"),
            other => panic!("{file}: {other}"),
        }
    }
}

/// The same files with the time from row to row told.
#[test]
fn ref_text_files_without_time_are_read_with_a_row_distance() {
    let read = [
        ("aalto-drivetrain/step_motor.csv", "column 3", 5, 2.1777),
        ("peers/cstr_daisy.csv", "Ca", 3, 0.1),
        ("peers/r_oesim.csv", "y", 2, -0.0365522805921075),
        ("daisy/dryer.dat", "column 2", 2, 4.7660989),
        ("daisy/heating_system.dat", "column 3", 3, 129.32),
        ("daisy/winding.dat", "column 1", 7, -1.2025481),
        ("inertia-dyno/20V__20V4A.txt", "column 4", 6, 778.36),
        ("wheel-with-bolts/test0-255_6ms.dat", "mVel", 4, 0.0),
    ];
    for (file, name, channels, first) in read {
        let Some(path) = shared(&format!("reference/{file}")) else { continue };
        let recording = decode_untimed(file, &std::fs::read(path).unwrap(), 0.1).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(recording.channels.len(), channels, "{file}");
        let channel = recording.channel(name).unwrap();
        assert!(channel.samples[0] == first, "{file}: {}", channel.samples[0]);
    }
}
