//! Writing CSV.

use std::fmt::Write as _;

use crate::heading::{heading, time_word};
use crate::{Channel, Recording, RecordingError};

/// Encodes a recording as CSV: commas, decimal points, one block `time [s], channel [unit], …` for each raster, side by
/// side, shorter ones padded with empty cells.
///
/// Numbers are written with as many digits as it takes to read the same number back. File comment, start time,
/// raster names and channel comments are not written.
///
/// # Errors
///
/// [`RecordingError::NoSuchRaster`] and [`RecordingError::LengthMismatch`] where the recording contradicts itself,
/// [`RecordingError::CannotExpress`] for a channel whose name would be read back as a time column.
pub fn encode_csv(recording: &Recording) -> Result<Vec<u8>, RecordingError> {
    let rasters = recording.rasters.len();
    let mut blocks: Vec<Vec<&Channel>> = vec![Vec::new(); rasters];
    recording.check()?;
    for channel in &recording.channels {
        check(channel)?;
        blocks[channel.raster].push(channel);
    }
    let mut out = String::new();
    let headings = blocks.iter().flat_map(|block| {
        let names = block.iter().map(|c| quoted(&c.name, &c.unit));
        std::iter::once(String::from("time [s]")).chain(names)
    });
    out.push_str(&headings.collect::<Vec<_>>().join(","));
    out.push('\n');
    let rows = recording.rasters.iter().map(|r| r.time_s.len()).max();
    for row in 0..rows.unwrap_or(0) {
        write_row(&mut out, recording, &blocks, row);
    }
    Ok(out.into_bytes())
}

fn check(channel: &Channel) -> Result<(), RecordingError> {
    if time_word(&channel.name) == Some("time") || channel.name.trim().is_empty() {
        return Err(RecordingError::CannotExpress {
            format: "CSV".into(),
            name: channel.name.clone(),
            what: "the name".into(),
        });
    }
    Ok(())
}

/// `name [unit]`, quoted where necessary.
fn quoted(name: &str, unit: &str) -> String {
    let plain = heading(name, unit);
    match plain.contains(['"', ',', '\n', '\r', ';', '\t']) {
        true => format!("\"{}\"", plain.replace('"', "\"\"")),
        false => plain,
    }
}

fn write_row(out: &mut String, recording: &Recording, blocks: &[Vec<&Channel>], row: usize) {
    let mut separator = "";
    for (raster, block) in recording.rasters.iter().zip(blocks) {
        let samples = block.iter().map(|c| &c.samples);
        for column in std::iter::once(&raster.time_s).chain(samples) {
            out.push_str(separator);
            separator = ",";
            if let Some(value) = column.get(row) {
                // Writing to a string does not fail.
                let _ = write!(out, "{value:?}");
            }
        }
    }
    out.push('\n');
}
