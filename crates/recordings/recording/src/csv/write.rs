//! Writing CSV.

use std::fmt::Write as _;
use std::io::Write;

use super::number::is_grouped;
use super::stamp::Stamp;
use crate::heading::{heading, mentions_time, name_and_unit, seconds, time_word};
use crate::source::unwritable;
use crate::{Channel, Raster, Recording, RecordingError};

/// Bytes of text that are written at once.
const PIECE: usize = 1 << 16;

/// Writes a recording as CSV: commas, decimal points, one block `time [s], channel [unit], …` for each raster, side by
/// side, shorter ones padded with empty cells, those without samples last, those without channels not at all.
///
/// Numbers are written with as many digits as it takes to read the same number back. File comment, start time,
/// raster names and channel comments are not written.
///
/// # Errors
///
/// [`RecordingError::NoSuchRaster`] and [`RecordingError::LengthMismatch`] where the recording contradicts itself,
/// [`RecordingError::CannotExpress`] for a channel whose name or unit would not be read back (see [`fits_text`]),
/// [`RecordingError::Unwritable`] where `out` fails.
pub fn write_csv(recording: &Recording, out: impl Write) -> Result<(), RecordingError> {
    write(recording, ',', out)
}

/// Writes a recording as [`write_csv`] does, with tabs between the columns.
///
/// # Errors
///
/// As [`write_csv`].
pub fn write_tsv(recording: &Recording, out: impl Write) -> Result<(), RecordingError> {
    write(recording, '\t', out)
}

/// A recording as [`write_csv`] writes it, in memory.
///
/// # Errors
///
/// As [`write_csv`].
pub fn encode_csv(recording: &Recording) -> Result<Vec<u8>, RecordingError> {
    let mut bytes = Vec::new();
    write_csv(recording, &mut bytes).map(|()| bytes)
}

/// A recording as [`write_tsv`] writes it, in memory.
///
/// # Errors
///
/// As [`write_csv`].
pub fn encode_tsv(recording: &Recording) -> Result<Vec<u8>, RecordingError> {
    let mut bytes = Vec::new();
    write_tsv(recording, &mut bytes).map(|()| bytes)
}

/// Returns true if a heading of text can hold a channel's name and unit. The name is not empty, and neither has control
/// characters or blanks at its ends. Together they are not read as a date, a time of day or a clock. A name with a word
/// for time is read as a clock if it is in a unit of time or in none; with `_channel` at its end it fits.
#[must_use]
pub fn fits_text(name: &str, unit: &str) -> bool {
    let plain = |text: &str| text.trim() == text && !text.chars().any(char::is_control);
    let is_label = |label: &String| name_and_unit(label) == (name, unit) && matches!(Stamp::read(label), Ok(None));
    let is_read_back = labelled(name, unit).as_ref().is_some_and(is_label);
    let is_time = mentions_time(name) && seconds(unit).is_some();
    !is_time && time_word(name) != Some("time") && !name.is_empty() && plain(name) && plain(unit) && is_read_back
}

/// `name [unit]`, or with other brackets where the unit has such.
fn labelled(name: &str, unit: &str) -> Option<String> {
    match unit.contains(['[', ']']) {
        false => Some(heading(name, unit)),
        true => (!unit.contains(['(', ')'])).then(|| format!("{name} ({unit})")),
    }
}

fn write(recording: &Recording, delimiter: char, mut out: impl Write) -> Result<(), RecordingError> {
    recording.check()?;
    let mut blocks: Vec<(&Raster, Vec<&Channel>)> = recording.rasters.iter().map(|r| (r, Vec::new())).collect();
    for channel in &recording.channels {
        blocks[channel.raster].1.push(channel);
    }
    blocks.retain(|(_, channels)| !channels.is_empty());
    // The first block's clock tells a reader where the samples begin.
    blocks.sort_by_key(|(raster, _)| raster.time_s.is_empty());
    let mut headings = Vec::new();
    for (_, channels) in &blocks {
        headings.push(String::from("time [s]"));
        for channel in channels {
            headings.push(quoted(channel)?);
        }
    }
    let mut text = headings.join(&String::from(delimiter));
    text.push('\n');
    let rows = blocks.iter().map(|(raster, _)| raster.time_s.len()).max();
    let columns: Vec<&[f64]> = blocks.iter().flat_map(|(raster, channels)| columns(raster, channels)).collect();
    for row in 0..rows.unwrap_or(0) {
        write_row(&mut text, &columns, row, delimiter);
        if text.len() >= PIECE {
            out.write_all(text.as_bytes()).map_err(|error| unwritable(&error))?;
            text.clear();
        }
    }
    out.write_all(text.as_bytes()).map_err(|error| unwritable(&error))
}

fn columns<'a>(raster: &'a Raster, channels: &'a [&Channel]) -> impl Iterator<Item = &'a [f64]> {
    std::iter::once(raster.time_s.as_slice()).chain(channels.iter().map(|c| c.samples.as_slice()))
}

/// `name [unit]`, quoted where necessary.
fn quoted(channel: &Channel) -> Result<String, RecordingError> {
    let cannot = || RecordingError::CannotExpress {
        format: "CSV".into(),
        name: channel.name.clone(),
        what: "the name or the unit".into(),
    };
    let fitting = labelled(&channel.name, &channel.unit).filter(|_| fits_text(&channel.name, &channel.unit));
    let plain = fitting.ok_or_else(cannot)?;
    Ok(match plain.contains(['"', ',', ';', '\t', '|']) {
        true => format!("\"{}\"", plain.replace('"', "\"\"")),
        false => plain,
    })
}

fn write_row(out: &mut String, columns: &[&[f64]], row: usize, delimiter: char) {
    for (place, column) in columns.iter().enumerate() {
        if place > 0 {
            out.push(delimiter);
        }
        let Some(value) = column.get(row) else { continue };
        let start = out.len();
        // Writing to a string does not fail.
        let _ = write!(out, "{value:?}");
        // Without commas between the columns, 1.234 may be read as one thousand and more.
        if delimiter != ',' && is_grouped(&out[start..], '.') {
            out.push_str("e0");
        }
    }
    out.push('\n');
}
