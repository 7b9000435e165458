//! The recordings of the two simulated benches against what asammdf reads in them.
//!
//! `data/bench_files.txt` holds, for each file and channel, name, unit, number of samples, and a checksum of the time
//! stamps and of the samples; see its first lines for how it was made.

use std::collections::BTreeMap;

use recording::{Selection, decode};
use testdata::shared;

/// FNV-1a over the little-endian bytes.
fn checksum(samples: &[f64]) -> u64 {
    let bytes = samples.iter().flat_map(|s| s.to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn ref_bench_files_equal_asammdf() {
    let expected = include_str!("data/bench_files.txt").lines().filter(|l| !l.starts_with('#'));
    let mut files: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for line in expected {
        let (file, rest) = line.split_once('\t').unwrap();
        files.entry(file).or_default().push(rest);
    }
    for (file, channels) in files {
        let Some(path) = shared(&format!("recordings/{file}")) else { continue };
        let bytes = std::fs::read(path).unwrap();
        let recording = decode(file, &bytes, &Selection::All).unwrap();
        assert_eq!(recording.findings, [], "{file}");
        let read: Vec<String> = recording
            .channels
            .iter()
            .map(|c| {
                let time_s = recording.time_s(c).unwrap();
                let (time, samples) = (checksum(time_s), checksum(&c.samples));
                format!("{}\t{}\t{}\t{time:016x}\t{samples:016x}", c.name, c.unit, time_s.len())
            })
            .collect();
        assert_eq!(read, channels, "{file}");
    }
}
