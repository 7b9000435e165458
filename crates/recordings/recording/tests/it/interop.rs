//! Files that we write are read by others value for value, and theirs by us: `interop.py` is the other side.

use std::path::{Path, PathBuf};
use std::process::Command;

use recording::{Channel, Format, Raster, Recording, RecordingError, Selection, decode};

/// Runs `interop.py`; `None`, and the test counts as skipped, where no Python is named.
fn python(arguments: &[&str]) -> Option<String> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/interop.py");
    let output = Command::new(testdata::python()?).arg(script).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8(output.stdout).unwrap())
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// FNV-1a over the little-endian bytes; NaN as Python has it.
fn checksum(samples: &[f64]) -> u64 {
    let bits = samples.iter().map(|s| if s.is_nan() { f64::NAN.to_bits() } else { s.to_bits() });
    let bytes = bits.flat_map(u64::to_le_bytes);
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn lines(file: &str, recording: &Recording) -> Vec<String> {
    let line = |c: &Channel| {
        let time_s = recording.time_s(c).unwrap();
        let (time, samples) = (checksum(time_s), checksum(&c.samples));
        format!("{file}\t{}\t{}\t{}\t{time:016x}\t{samples:016x}", c.name, c.unit, time_s.len())
    };
    recording.channels.iter().map(line).collect()
}

/// Numbers that are hard to print, on two rasters.
fn awkward() -> Recording {
    let hard = [0.1 + 0.2, 5e-324, f64::MAX, -1.0 / 3.0, f64::NAN, -0.0, 1e22, 123_456_789.123_456_79, 2.5];
    let raster = |step: f64, n: usize| Raster { time_s: (0..n).map(|i| i as f64 * step).collect(), name: None };
    let channel = |name: &str, unit: &str, raster, samples: Vec<f64>| Channel {
        name: name.into(),
        unit: unit.into(),
        comment: "made up".into(),
        raster,
        samples,
    };
    Recording {
        format: Format::Mdf { version: 410 },
        comment: Some("two rasters".into()),
        start_time: None,
        rasters: vec![raster(0.1, 9), raster(0.25, 5)],
        channels: vec![
            channel("Drehzahl", "1/min", 0, hard.to_vec()),
            channel("Öl", "°C", 1, hard[..5].to_vec()),
            channel("torque", "", 0, hard.iter().map(|v| v * 0.5).collect()),
        ],
        findings: vec![],
    }
}

type Encode = fn(&Recording) -> Result<Vec<u8>, RecordingError>;

#[test]
fn ref_others_read_what_is_written() {
    let folder = folder("written");
    let recording = awkward();
    let encoders: [(&str, Encode); 4] = [
        ("written.csv", recording::encode_csv),
        ("written.mat", recording::encode_mat5),
        ("written.parquet", recording::encode_parquet),
        ("written.arrow", recording::encode_arrow),
    ];
    let mut expected = Vec::new();
    for (file, encode) in encoders {
        std::fs::write(folder.join(file), encode(&recording).unwrap()).unwrap();
        let mut lines = lines(file, &recording);
        if file == "written.csv" {
            // The blocks stand side by side.
            lines.swap(1, 2);
        }
        expected.extend(lines);
    }
    let Some(read) = python(&["read", folder.to_str().unwrap()]) else { return };
    assert_eq!(read.lines().collect::<Vec<_>>(), expected);
}

#[test]
fn ref_what_others_write_is_read() {
    let folder = folder("of_others");
    let Some(written) = python(&["write", folder.to_str().unwrap()]) else { return };
    let mut files: Vec<&str> = written.lines().filter_map(|line| Some(line.split_once('\t')?.0)).collect();
    files.dedup();
    for file in files {
        let bytes = std::fs::read(folder.join(file)).unwrap();
        let recording = decode(file, &bytes, &Selection::All).unwrap_or_else(|error| panic!("{error}"));
        let is_of = |line: &&str| line.split('\t').next() == Some(file);
        assert_eq!(lines(file, &recording), written.lines().filter(is_of).collect::<Vec<_>>(), "{file}");
    }
}
