//! Times and memory of an open recording: `cargo bench -p dynoid-recording --bench handles`.
//!
//! Writes `DYNOID_BENCH_MB` megabytes of numbers (64 without it) into `target`, in one format after the other: time at
//! 1 kHz and nine channels, MDF without compression. Of more than 500 MB, which the other writers would need in memory,
//! it writes MDF alone. A process of its own opens each file, reads 2 s from the middle, makes the overview of a
//! channel, and reads the channel and all of the file. The memory of a task is the peak above what was in use before
//! it, where the system reports it.
#![allow(clippy::print_stdout, reason = "the table is what this program is for")]
#![allow(clippy::disallowed_types, clippy::disallowed_methods, reason = "a program, outside of the crate it measures")]

use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

use recording::{Channel, Format, Handle, Raster, Recording, Selection, Span, open};
use work::Context;

const CHANNELS: usize = 9;
const RECORD_BYTES: u64 = 8 * (1 + CHANNELS as u64);
const STEP_S: f64 = 1e-3;
/// A channel of the file.
const CHANNEL: &str = "channel 4";
/// More is written as MDF alone, and not read whole.
const MOST_MB: u64 = 500;

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["write", path, megabytes] => write(Path::new(path), rows(megabytes.parse()?)),
        ["measure", path, megabytes] => measure(Path::new(path), megabytes.parse()?),
        _ => all(),
    }
}

fn all() -> Outcome<()> {
    let megabytes: u64 = std::env::var("DYNOID_BENCH_MB").ok().and_then(|text| text.parse().ok()).unwrap_or(64);
    let folder = std::env::var("DYNOID_BENCH_FOLDER").map_or(env!("CARGO_TARGET_TMPDIR").into(), PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    let endings: &[&str] = if megabytes > MOST_MB { &["mf4"] } else { &ENDINGS };
    println!("{:<10}{:<28}{:>12}{:>14}", "format", "task", "wall ms", "memory");
    for ending in endings {
        let path = folder.join(format!("handles.{ending}"));
        let done = ["write", "measure"].into_iter().try_for_each(|task| in_a_process(task, &path, megabytes));
        std::fs::remove_file(&path)?;
        done?;
    }
    Ok(())
}

/// The files' endings.
const ENDINGS: [&str; 5] = [
    "mf4",
    "csv",
    "mat",
    #[cfg(feature = "parquet")]
    "parquet",
    #[cfg(feature = "parquet")]
    "arrow",
];

fn in_a_process(task: &str, path: &Path, megabytes: u64) -> Outcome<()> {
    let status = Command::new(std::env::current_exe()?).arg(task).arg(path).arg(megabytes.to_string()).status()?;
    if status.success() { Ok(()) } else { Err(format!("{task} {} failed", path.display()).into()) }
}

fn rows(megabytes: u64) -> u64 {
    megabytes * 1_000_000 / RECORD_BYTES
}

fn ending(path: &Path) -> &str {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default()
}

fn measure(path: &Path, megabytes: u64) -> Outcome<()> {
    let timed = Timed { format: ending(path) };
    let rows = rows(megabytes);
    let handle = timed.task("open", || Ok(open("handles", Arc::new(File::open(path)?), None, &Context::new())?))?;
    let from_s = rows as f64 / 2.0 * STEP_S;
    timed.task("2 s of all, first time", || range(&handle, from_s))?;
    timed.task("2 s of all, elsewhere", || range(&handle, from_s / 2.0))?;
    timed.task("overview of one channel", || Ok(handle.pyramid(CHANNEL, &Context::new())?))?;
    let pyramid = handle.pyramid(CHANNEL, &Context::new())?;
    timed.task("view of all of it", || Ok(pyramid.view(0.0, rows as f64 * STEP_S, 2000)?))?;
    timed.task("view of 100 s", || Ok(pyramid.view(from_s, from_s + 100.0, 2000)?))?;
    let selection = Selection::names([CHANNEL]);
    timed.task("the channel read whole", || Ok(handle.read(&selection, &Span::All, &Context::new())?))?;
    if megabytes <= MOST_MB {
        timed.task("all read whole", || Ok(handle.read(&Selection::All, &Span::All, &Context::new())?))?;
    }
    Ok(())
}

fn range(handle: &Handle, from_s: f64) -> Outcome<usize> {
    let span = Span::Time { from_s, to_s: from_s + 2.0 };
    let read = handle.read(&Selection::All, &span, &Context::new())?;
    Ok(read.channels.iter().map(|channel| channel.samples.len()).sum())
}

/// Measures tasks on a file.
struct Timed<'a> {
    format: &'a str,
}

impl Timed<'_> {
    /// Does something, and says how long it took and how much memory.
    fn task<T>(&self, what: &str, work: impl FnOnce() -> Outcome<T>) -> Outcome<T> {
        // Sets the peak back to what is in use.
        let _ = std::fs::write("/proc/self/clear_refs", "5");
        let (before, start) = (megabytes_of("VmRSS:"), Instant::now());
        let done = work()?;
        let (wall_ms, more) = (start.elapsed().as_secs_f64() * 1e3, megabytes_of("VmHWM:") - before);
        println!("{:<10}{what:<28}{wall_ms:>12.2}{more:>11.1} MB", self.format);
        Ok(done)
    }
}

/// An entry of the process's memory.
fn megabytes_of(entry: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let size = status.lines().find_map(|l| l.strip_prefix(entry)?.trim().strip_suffix(" kB")?.parse::<f64>().ok());
    size.unwrap_or(f64::NAN) / 1000.0
}

fn sample(row: u64, channel: u64) -> f64 {
    ((row * 9 + channel).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as f64
}

/// The numbers of every file.
fn recording(rows: u64) -> Recording {
    let channel = |channel: u64| Channel {
        name: format!("channel {}", channel + 1),
        unit: "Nm".into(),
        comment: String::new(),
        raster: 0,
        samples: (0..rows).map(|row| sample(row, channel)).collect(),
    };
    Recording {
        format: Format::Parquet,
        comment: None,
        start_time: None,
        rasters: vec![Raster { time_s: (0..rows).map(|row| row as f64 * STEP_S).collect(), name: None }],
        channels: (0..CHANNELS as u64).map(channel).collect(),
        findings: Vec::new(),
    }
}

fn write(path: &Path, rows: u64) -> Outcome<()> {
    let mut file = BufWriter::with_capacity(1 << 20, File::create(path)?);
    match ending(path) {
        "csv" => recording::write_csv(&recording(rows), &mut file)?,
        "mat" => recording::write_mat5(&recording(rows), "bench", &mut file)?,
        #[cfg(feature = "parquet")]
        "parquet" => recording::write_parquet(&recording(rows), "bench", &mut file)?,
        #[cfg(feature = "parquet")]
        "arrow" => recording::write_arrow(&recording(rows), &mut file)?,
        _ => write_mdf(&mut file, rows)?,
    }
    Ok(file.flush()?)
}

fn write_mdf(file: &mut impl Write, rows: u64) -> Outcome<()> {
    file.write_all(&structure(rows))?;
    for row in 0..rows {
        file.write_all(&(row as f64 * STEP_S).to_le_bytes())?;
        for channel in 0..CHANNELS as u64 {
            file.write_all(&sample(row, channel).to_le_bytes())?;
        }
    }
    Ok(())
}

/// Everything up to the records: identification, header, channels, their group, and the head of the data.
fn structure(rows: u64) -> Vec<u8> {
    let mut bytes = vec![0; 64 + 104];
    bytes[..24].copy_from_slice(b"MDF     4.10    bench   ");
    bytes[28..30].copy_from_slice(&410_u16.to_le_bytes());
    let mut next = 0;
    for index in (0..=CHANNELS).rev() {
        let name = if index == 0 { "time\0".to_owned() } else { format!("channel {index}\0") };
        let name = block(&mut bytes, b"##TX", &[], name.as_bytes());
        let mut data = [0; 72];
        data[..4].copy_from_slice(if index == 0 { &[2, 1, 4, 0] } else { &[0, 0, 4, 0] });
        data[4..8].copy_from_slice(&(8 * index as u32).to_le_bytes());
        data[8..12].copy_from_slice(&64_u32.to_le_bytes());
        next = block(&mut bytes, b"##CN", &[next, 0, name, 0, 0, 0, 0, 0], &data);
    }
    let mut data = [0; 32];
    data[8..16].copy_from_slice(&rows.to_le_bytes());
    data[24..28].copy_from_slice(&(RECORD_BYTES as u32).to_le_bytes());
    let group = block(&mut bytes, b"##CG", &[0, next, 0, 0, 0, 0], &data);
    // The group of data stands before them, and the data at the end.
    let data_at = bytes.len().next_multiple_of(8) as u64 + 64;
    let data_group = block(&mut bytes, b"##DG", &[0, group, data_at, 0], &[0; 8]);
    bytes.resize(data_at as usize, 0);
    let head = head(b"##DT", &[], rows * RECORD_BYTES);
    bytes.extend_from_slice(&head);
    let header = self::head(b"##HD", &[data_group, 0, 0, 0, 0, 0], 32);
    bytes[64..64 + header.len()].copy_from_slice(&header);
    bytes
}

fn block(bytes: &mut Vec<u8>, id: &[u8; 4], links: &[u64], data: &[u8]) -> u64 {
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    let offset = bytes.len() as u64;
    bytes.extend_from_slice(&head(id, links, data.len() as u64));
    bytes.extend_from_slice(data);
    offset
}

fn head(id: &[u8; 4], links: &[u64], data_bytes: u64) -> Vec<u8> {
    let mut head = [&id[..], &[0; 4]].concat();
    head.extend_from_slice(&(24 + links.len() as u64 * 8 + data_bytes).to_le_bytes());
    head.extend_from_slice(&(links.len() as u64).to_le_bytes());
    links.iter().for_each(|link| head.extend_from_slice(&link.to_le_bytes()));
    head
}
