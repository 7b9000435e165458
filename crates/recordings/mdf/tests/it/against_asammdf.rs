//! The reader against asammdf, on files of others and on a grid of files that asammdf writes.
//!
//! `tests/against_asammdf/dump.py` writes down what asammdf reads. Where `DYNOID_PYTHON` names no interpreter that has
//! it, the tests are skipped.

use std::ffi::OsStr;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;

use mdf::{Address, Kind, Mdf, Values};
use testdata::{python, shared};
use work::Context;

use crate::features::{LZ4, ZSTANDARD, mixed, one_packed};
use crate::made::{Cn, cn, one_group};

fn script(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/against_asammdf").join(name)
}

fn files_in(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let ending = path.extension().map(|e| e.to_ascii_lowercase());
        if path.is_dir() {
            files_in(&path, found);
        } else if ending.is_some_and(|e| e == "mf4" || e == "mdf" || e == "dat") {
            found.push(path);
        }
    }
    found.sort();
}

/// Content of a channel as asammdf reads it.
struct Expected {
    kind: u8,
    group: usize,
    name: String,
    unit: String,
    count: usize,
    numbers: Vec<f64>,
    strings: Vec<Vec<u8>>,
}

struct Dump<'a> {
    rest: &'a [u8],
}

impl<'a> Dump<'a> {
    fn line(&mut self) -> Option<Vec<String>> {
        let end = self.rest.iter().position(|&b| b == b'\n')?;
        let line = String::from_utf8_lossy(&self.rest[..end]).into_owned();
        self.rest = &self.rest[end + 1..];
        Some(line.split('\t').map(str::to_owned).collect())
    }

    fn take(&mut self, count: usize) -> &'a [u8] {
        let (head, tail) = self.rest.split_at(count);
        self.rest = tail;
        head
    }

    fn channel(&mut self) -> Option<Expected> {
        let fields = self.line()?;
        let count = fields[4].parse().unwrap();
        let mut expected = Expected {
            kind: fields[0].as_bytes()[0],
            group: fields[1].parse().unwrap(),
            name: fields[2].clone(),
            unit: fields[3].clone(),
            count,
            numbers: vec![],
            strings: vec![],
        };
        match expected.kind {
            b'N' | b'M' => {
                let bytes = self.take(8 * count);
                expected.numbers = bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
            }
            b'T' | b'B' => {
                for _ in 0..count {
                    let length = u32::from_le_bytes(self.take(4).try_into().unwrap());
                    expected.strings.push(self.take(length as usize).to_vec());
                }
            }
            _ => {}
        }
        Some(expected)
    }
}

/// Where we differ and the format is on our side: files and channels (beginnings of names). See the README of the
/// crate.
const DIFFERS: [(&str, &str); 3] = [
    ("ASAP2_Demo_V161", "ASAM.M.SCALAR.UBYTE.VTAB_RANGE_"),
    ("asammdf-grid", "ranges_uint8"),
    ("asammdf-grid", "ranges_int16"),
];

/// Equal but for the order in which a conversion is computed; `largest` is what it computes with.
fn same(ours: f64, theirs: f64, largest: f64) -> bool {
    let tolerance = 1e-12 * theirs.abs() + 1e-15 * largest;
    ours == theirs || (ours.is_nan() && theirs.is_nan()) || (ours - theirs).abs() <= tolerance
}

fn plain(text: &str) -> String {
    text.replace(['\t', '\n', '\r'], " ")
}

fn compare_values(values: &Values, expected: &Expected) -> Result<(), String> {
    if values.len() != expected.count {
        return Err(format!("{} samples, asammdf has {}", values.len(), expected.count));
    }
    let finite = expected.numbers.iter().filter(|n| n.is_finite());
    let largest = finite.fold(0.0_f64, |largest, n| largest.max(n.abs()));
    for i in 0..expected.count {
        let (ours, theirs, equal) = match (values, expected.kind) {
            (Values::Numbers(n), b'N' | b'M') => {
                let (a, b) = (n[i], expected.numbers[i]);
                (a.to_string(), b.to_string(), same(a, b, largest))
            }
            (Values::Text(t), b'T') => {
                let (a, b) = (t.get(i), &expected.strings[i]);
                (a.to_owned(), String::from_utf8_lossy(b).into_owned(), a.as_bytes() == &b[..])
            }
            (Values::Bytes(b), b'B') => {
                let (a, b) = (b.get(i), &expected.strings[i]);
                // asammdf fills values of varying length up.
                let equal = b.starts_with(a) && b[a.len()..].iter().all(|&b| b == 0);
                (format!("{a:?}"), format!("{b:?}"), equal)
            }
            _ => return Err(format!("another kind of values, asammdf has {}", char::from(expected.kind))),
        };
        if !equal {
            return Err(format!("sample {i} is {ours:?}, asammdf has {theirs:?}"));
        }
    }
    Ok(())
}

/// Differences between what asammdf reads in a file and what we read.
fn differences(dump: &[u8], of_others: bool) -> Vec<String> {
    let mut dump = Dump { rest: dump };
    let path = dump.line().unwrap()[1].clone();
    if dump.rest.starts_with(b"refused") {
        let refused = format!("{path}\trefused by asammdf");
        eprintln!("{refused}");
        // Files of others may be damaged on purpose; where nothing is read, nothing is compared.
        return if of_others { vec![] } else { vec![refused] };
    }
    let file = match Mdf::open(File::open(&path).unwrap()) {
        Ok(file) => file,
        Err(error) => return vec![format!("{path}: {error}")],
    };
    let mut differences = vec![];
    let mut next = Address { group: usize::MAX, channel: 0 };
    let (mut listed, mut clocks, mut samples) = (0, 0, 0);
    while let Some(expected) = dump.channel() {
        let mut fail =
            |what: String| differences.push(format!("{path}: group {} {:?}: {what}", expected.group, expected.name));
        let Some(group) = file.groups().get(expected.group) else {
            fail("there is no such group".into());
            continue;
        };
        if expected.kind == b'M' {
            if let Some(master) = group.master {
                let values = file.read(&[master.address], &Context::new());
                match values.map_err(|e| e.to_string()).and_then(|v| compare_values(&v[0], &expected)) {
                    Ok(()) => clocks += 1,
                    Err(e) => fail(format!("clock: {e}")),
                }
            }
            continue;
        }
        let channel = if next.group == expected.group { next.channel } else { 0 };
        next = Address { group: expected.group, channel: channel + 1 };
        let address = Address { group: expected.group, channel };
        let Some(info) = group.channels.get(channel) else {
            fail("there is no such channel".into());
            continue;
        };
        listed += 1;
        // asammdf does not show the unit of a conversion.
        let has_unit = plain(&info.unit) == expected.unit || expected.unit.is_empty();
        if plain(&info.name) != expected.name || !has_unit {
            fail(format!("is {:?} in {:?}, asammdf has {:?}", info.name, info.unit, expected.unit));
        } else if expected.kind == b'L' {
            if info.obstacle.is_none() && info.kind == Kind::Number {
                fail("asammdf does not read numbers".into());
            }
        } else {
            let known = DIFFERS.iter().any(|(f, c)| path.contains(f) && expected.name.starts_with(c));
            let values = file.read(&[address], &Context::new()).map_err(|e| e.to_string());
            let values = values.map(|v| if known && v[0].len() == expected.count { vec![] } else { v });
            match values.and_then(|v| v.iter().try_for_each(|v| compare_values(v, &expected))) {
                Ok(()) => samples += if known { 0 } else { expected.count },
                Err(e) => fail(e),
            }
        }
    }
    let ours: usize = file.groups().iter().map(|g| g.channels.len()).sum();
    if ours != listed && differences.is_empty() {
        differences.push(format!("{path}: {ours} channels, asammdf has {listed}"));
    }
    let unlike = differences.len();
    eprintln!("{path}\t{listed} channels\t{samples} samples equal\t{clocks} clocks equal\t{unlike} differences");
    differences
}

fn check(folder: &Path, of_others: bool) {
    let mut dumps: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    dumps.retain(|p| p.extension().is_some_and(|e| e == "samples"));
    dumps.sort();
    let found: Vec<String> = dumps.iter().flat_map(|p| differences(&std::fs::read(p).unwrap(), of_others)).collect();
    assert!(found.is_empty(), "{} differences in {} files:\n{}", found.len(), dumps.len(), found.join("\n"));
}

fn dumped(python: &OsStr, files: &[PathBuf], folder: &Path) {
    let status = Command::new(python).arg(script("dump.py")).arg(folder).args(files).status().unwrap();
    assert!(status.success());
}

#[test]
fn ref_files_of_others_are_read_as_asammdf_reads_them() {
    let mut files = vec![];
    let (Some(reference), Some(recordings)) = (shared("reference/mdf"), shared("recordings")) else { return };
    files_in(&reference, &mut files);
    files_in(&recordings, &mut files);
    let Some(python) = python() else { return };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("asammdf-others");
    dumped(&python, &files, &folder);
    check(&folder, true);
}

/// Files with what asammdf reads but does not write.
fn made() -> Vec<(&'static str, Vec<u8>)> {
    // Integers that begin and end within bytes, in both byte orders, signed and not.
    let fields = [(0, 3, 12), (0, 0, 1), (1, 7, 1), (2, 0, 24), (3, 5, 27), (0, 0, 40), (1, 2, 50)];
    let field = |data_type| move |&(byte, bit, bits)| Cn { bit, ..cn(data_type, byte, bits) };
    let bits: Vec<Cn> = [0, 2].into_iter().flat_map(|data_type| fields.iter().map(field(data_type))).collect();
    let records: Vec<u8> = (0..250_u32).map(|i| (i * 167 % 251) as u8).collect();
    vec![
        ("bits.mf4", one_group(&bits, &records, 10, 0)),
        ("mixed.mf4", mixed(true, 0, 4, [0, 5, 9, 19])),
        ("zstandard.mf4", one_packed(2, ZSTANDARD)),
        ("lz4.mf4", one_packed(5, LZ4)),
    ]
}

#[test]
fn ref_made_files_are_read_as_asammdf_reads_them() {
    let Some(python) = python() else { return };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("asammdf-made");
    std::fs::create_dir_all(&folder).unwrap();
    let file = |(name, bytes): &(&str, Vec<u8>)| {
        std::fs::write(folder.join(name), bytes).unwrap();
        folder.join(name)
    };
    let files: Vec<PathBuf> = made().iter().map(file).collect();
    dumped(&python, &files, &folder);
    check(&folder, false);
}

#[test]
#[ignore = "slow"]
fn ref_files_of_asammdf_are_read_as_it_reads_them() {
    let Some(python) = python() else { return };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("asammdf-grid");
    let status = Command::new(&python).arg(script("generate.py")).arg(&folder).status().unwrap();
    assert!(status.success());
    let mut files = vec![];
    files_in(&folder, &mut files);
    dumped(&python, &files, &folder);
    check(&folder, false);
}
