//! Times opening, listing and reading of an MDF file: `measure FILE (list|five|all)`.
//!
//! Prints wall and processor time in seconds and the peak of the memory in MB, where the system reports them.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::fs::File;
use std::time::Instant;

use mdf::{Address, Kind, Mdf, Values};
use work::Context;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, path, what] = arguments.as_slice() else { return Err("measure FILE (list|five|all)".into()) };
    let start = Instant::now();
    let file = Mdf::open(File::open(path)?)?;
    let opened = start.elapsed().as_secs_f64();
    let chosen = chosen(&file, what);
    let values = file.read(&chosen, &Context::new())?;
    let samples: usize = values.iter().map(Values::len).sum();
    let (wall, (processor, peak)) = (start.elapsed().as_secs_f64(), usage());
    let channels: usize = file.groups().iter().map(|g| g.channels.len()).sum();
    println!(
        "ours {what}: {channels} channels, {samples} samples; open {opened:.4} s, wall {wall:.4} s, processor \
         {processor:.2} s, peak {peak:.0} MB"
    );
    Ok(())
}

/// The channels to be read: none, five of the first groups, or all.
fn chosen(file: &Mdf<File>, what: &str) -> Vec<Address> {
    let mut all = Vec::new();
    for (group, info) in file.groups().iter().enumerate() {
        let readable = info.channels.iter().enumerate().filter(|(_, c)| c.obstacle.is_none() && c.kind == Kind::Number);
        all.extend(readable.map(|(channel, _)| Address { group, channel }));
    }
    match what {
        "all" => all,
        "five" => (0..5.min(file.groups().len())).map(|group| Address { group, channel: 10 + 20 * group }).collect(),
        _ => vec![],
    }
}

/// Processor time in s and peak memory in MB.
fn usage() -> (f64, f64) {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|l| l.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?.parse::<f64>().ok());
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let ticks = stat.split_whitespace().skip(13).take(2).filter_map(|t| t.parse::<f64>().ok());
    (ticks.sum::<f64>() / 100.0, peak.unwrap_or(f64::NAN) / 1000.0)
}
