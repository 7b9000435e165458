//! Writing level 5: a list of what there is, then a vector for each clock and channel, deflated.

use std::collections::{HashMap, HashSet};
use std::io::{Cursor, Result as Io, Seek, SeekFrom, Write};

use flate2::{Compression, write::ZlibEncoder};

use super::listed::{NAME, start_text};
use super::scope::MAX_CHANNELS;
use super::value::MAX_TEXT;
use crate::source::unwritable;
use crate::{PROGRAM, Recording, RecordingError};

/// Below this, compression does not pay.
const SMALL: usize = 1 << 10;
/// Samples that are written at once.
const PIECE: usize = 1 << 13;
/// The longest name of a variable in MATLAB.
const MAX_NAME: usize = 63;
/// The largest variable that MATLAB reads.
const MAX_BYTES: usize = i32::MAX as usize;

const STRUCT: u32 = 2;
const TEXT: u32 = 4;
const DOUBLE: u32 = 6;
/// Doubles as an element.
const DOUBLE_DATA: u32 = 9;

/// Words that cannot be names of variables in MATLAB.
const KEYWORDS: [&str; 20] = [
    "break",
    "case",
    "catch",
    "classdef",
    "continue",
    "else",
    "elseif",
    "end",
    "for",
    "function",
    "global",
    "if",
    "otherwise",
    "parfor",
    "persistent",
    "return",
    "spmd",
    "switch",
    "try",
    "while",
];

/// Writes a recording as a MAT-file of level 5 to `out`, which is empty, as MATLAB saves it with `-v7`.
///
/// Each raster becomes a column vector `time` (`time_2`, … where there are more), each channel a column vector of
/// doubles named like the channel as far as MATLAB allows: other characters become `_`, and a number is appended where
/// a name occurs again. The struct `recording_info` holds the comment, the start time, and in `rasters` and `channels`
/// which variable has which name, unit and comment in the recording, and which is its clock; [`crate::decode`] reads
/// all of it back bit for bit. Of the findings nothing is written.
///
/// # Errors
///
/// [`RecordingError::NoSuchRaster`] and [`RecordingError::LengthMismatch`] where the recording contradicts itself,
/// [`RecordingError::CannotExpress`] for a channel or text longer than the format allows and for too many channels,
/// [`RecordingError::Unwritable`] where `out` fails.
///
/// # Example
///
/// ```
/// let recording = recording::decode("run.csv", b"time [s],n [rpm]\n0,1200\n1,1210\n", &recording::Selection::All)?;
/// let bytes = recording::encode_mat5(&recording)?;
/// let read = recording::decode("run.mat", &bytes, &recording::Selection::All)?;
/// assert_eq!((read.channels, read.rasters), (recording.channels, recording.rasters));
/// # Ok::<(), recording::RecordingError>(())
/// ```
pub fn write_mat5(recording: &Recording, program: &str, mut out: impl Write + Seek) -> Result<(), RecordingError> {
    check(recording)?;
    let mut names = Names { used: HashSet::from([NAME.to_owned()]), numbers: HashMap::new() };
    let clocks: Vec<String> = recording.rasters.iter().map(|_| names.variable("time")).collect();
    let variables: Vec<String> = recording.channels.iter().map(|c| names.variable(&c.name)).collect();
    out.write_all(&header(program)).map_err(|error| unwritable(&error))?;
    put(&mut out, NAME, &info(recording, &clocks, &variables)?, &[])?;
    for (name, raster) in clocks.iter().zip(&recording.rasters) {
        put(&mut out, name, &vector(name, raster.time_s.len())?, &raster.time_s)?;
    }
    for (name, channel) in variables.iter().zip(&recording.channels) {
        put(&mut out, name, &vector(name, channel.samples.len())?, &channel.samples)?;
    }
    out.flush().map_err(|error| unwritable(&error))
}

/// A recording as [`write_mat5`] writes it, in memory.
///
/// # Errors
///
/// As [`write_mat5`].
pub fn encode_mat5(recording: &Recording) -> Result<Vec<u8>, RecordingError> {
    let mut out = Cursor::new(Vec::new());
    write_mat5(recording, PROGRAM, &mut out).map(|()| out.into_inner())
}

fn check(recording: &Recording) -> Result<(), RecordingError> {
    recording.check()?;
    // Each is listed with five texts, and readers bound the number of those.
    if recording.channels.len() + recording.rasters.len() > MAX_CHANNELS / 4 {
        return Err(cannot(NAME, "the number of channels"));
    }
    Ok(())
}

fn cannot(name: &str, what: &str) -> RecordingError {
    RecordingError::CannotExpress { format: "MAT 5".into(), name: name.into(), what: what.into() }
}

/// Names of variables that are taken.
struct Names {
    used: HashSet<String>,
    /// The last number that was appended to a name.
    numbers: HashMap<String, usize>,
}

impl Names {
    /// A name that MATLAB takes and that is not taken.
    fn variable(&mut self, name: &str) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let mut stem: String = name.trim().chars().take(MAX_NAME - 8).map(plain).collect();
        if !stem.starts_with(|c: char| c.is_ascii_alphabetic()) || KEYWORDS.contains(&stem.as_str()) {
            stem.insert(0, 'x');
        }
        let mut found = stem.clone();
        let number = self.numbers.entry(stem.clone()).or_insert(1);
        while !self.used.insert(found.clone()) {
            *number += 1;
            found = format!("{stem}_{number}");
        }
        found
    }
}

/// Text, level and byte order.
fn header(program: &str) -> Vec<u8> {
    let mut out = format!("MATLAB 5.0 MAT-file, Platform: any, Created by: {program}").into_bytes();
    out.resize(116, b' ');
    out.extend_from_slice(&[0; 8]);
    out.extend_from_slice(&[0, 1, b'I', b'M']);
    out
}

/// Appends a variable that begins with `head` and goes on with samples, deflated if that pays.
fn put(out: &mut (impl Write + Seek), name: &str, head: &[u8], samples: &[f64]) -> Result<(), RecordingError> {
    let size = head.len().saturating_add(samples.len().saturating_mul(8));
    if size > MAX_BYTES {
        return Err(cannot(name, "the size"));
    }
    if size < SMALL {
        return put_into(out, head, samples).map_err(|error| unwritable(&error));
    }
    let packed = deflated(out, head, samples).map_err(|error| unwritable(&error))?;
    let size = u32::try_from(packed.1 - packed.0).map_err(|_| cannot(name, "the size"))?;
    let mut note = || {
        out.seek(SeekFrom::Start(packed.0 - 4))?;
        out.write_all(&size.to_le_bytes())?;
        out.seek(SeekFrom::Start(packed.1))
    };
    note().map(drop).map_err(|error| unwritable(&error))
}

/// Appends a deflated variable, without its size, and says where it begins and ends.
fn deflated(out: &mut (impl Write + Seek), head: &[u8], samples: &[f64]) -> Io<(u64, u64)> {
    out.write_all(&15_u32.to_le_bytes())?;
    out.write_all(&[0; 4])?;
    let begin = out.stream_position()?;
    let mut encoder = ZlibEncoder::new(&mut *out, Compression::new(4));
    put_into(&mut encoder, head, samples)?;
    encoder.finish()?;
    Ok((begin, out.stream_position()?))
}

fn put_into(out: &mut impl Write, head: &[u8], samples: &[f64]) -> Io<()> {
    out.write_all(head)?;
    for piece in samples.chunks(PIECE) {
        let bytes: Vec<u8> = piece.iter().flat_map(|sample| sample.to_le_bytes()).collect();
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// An element: type, size and content, short content within the tag.
fn element(kind: u32, content: &[u8]) -> Result<Vec<u8>, RecordingError> {
    let size = u32::try_from(content.len()).map_err(|_| cannot(NAME, "the size"))?;
    let mut out = Vec::with_capacity(content.len() + 16);
    if (1..=4).contains(&size) {
        out.extend_from_slice(&(kind | size << 16).to_le_bytes());
    } else {
        out.extend_from_slice(&kind.to_le_bytes());
        out.extend_from_slice(&size.to_le_bytes());
    }
    out.extend_from_slice(content);
    out.resize(out.len().next_multiple_of(8), 0);
    Ok(out)
}

/// A matrix of `rows` × `columns`; `body` is what follows its name.
fn matrix(class: u32, [rows, columns]: [usize; 2], name: &str, body: &[u8]) -> Result<Vec<u8>, RecordingError> {
    let size = |n: usize| i32::try_from(n).map_err(|_| cannot(name, "the size"));
    let mut content = element(6, &[class.to_le_bytes(), [0; 4]].concat())?;
    content.extend(element(5, &[size(rows)?.to_le_bytes(), size(columns)?.to_le_bytes()].concat())?);
    content.extend(element(1, name.as_bytes())?);
    content.extend_from_slice(body);
    element(14, &content)
}

/// Bytes before the numbers of a column vector of `count` doubles.
fn vector(name: &str, count: usize) -> Result<Vec<u8>, RecordingError> {
    // Eight bytes a number leave nothing to be filled up.
    let size = |bytes: usize| u32::try_from(bytes).map_err(|_| cannot(name, "the size"));
    let bytes = size(count.saturating_mul(8))?;
    let mut head = matrix(DOUBLE, [count, 1], name, &[DOUBLE_DATA.to_le_bytes(), bytes.to_le_bytes()].concat())?;
    let whole = size(head.len() - 8 + bytes as usize)?;
    head[4..8].copy_from_slice(&whole.to_le_bytes());
    Ok(head)
}

fn text(owner: &str, text: &str) -> Result<Vec<u8>, RecordingError> {
    let units: Vec<u16> = text.encode_utf16().collect();
    if units.len() > MAX_TEXT {
        return Err(cannot(owner, "a text"));
    }
    let content: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let rows = usize::from(!units.is_empty());
    // Type 17 is UTF-16.
    matrix(TEXT, [rows, units.len()], "", &element(17, &content)?)
}

/// Structs in a column, with the values of their fields.
fn structs(name: &str, fields: &[&str], elements: &[Vec<Vec<u8>>]) -> Result<Vec<u8>, RecordingError> {
    const WIDTH: usize = 32;
    let mut names = Vec::new();
    for field in fields {
        names.extend_from_slice(field.as_bytes());
        names.resize(names.len().next_multiple_of(WIDTH), 0);
    }
    let mut body = element(5, &(WIDTH as u32).to_le_bytes())?;
    body.extend(element(1, &names)?);
    elements.iter().flatten().for_each(|value| body.extend_from_slice(value));
    matrix(STRUCT, [elements.len(), 1], name, &body)
}

/// The list of what there is.
fn info(recording: &Recording, clocks: &[String], variables: &[String]) -> Result<Vec<u8>, RecordingError> {
    let raster = |(variable, raster): (&String, &crate::Raster)| {
        let name = raster.name.as_deref().unwrap_or_default();
        Ok(vec![text(name, variable)?, text(name, name)?])
    };
    let rasters = clocks.iter().zip(&recording.rasters).map(raster).collect::<Result<Vec<_>, RecordingError>>()?;
    let channel = |(variable, channel): (&String, &crate::Channel)| {
        let texts = [variable, &channel.name, &channel.unit, &channel.comment, &clocks[channel.raster]];
        texts.into_iter().map(|t| text(&channel.name, t)).collect()
    };
    let channels = variables.iter().zip(&recording.channels).map(channel).collect::<Result<Vec<_>, _>>()?;
    let element = vec![
        text(NAME, recording.comment.as_deref().unwrap_or_default())?,
        text(NAME, &start_text(recording.start_time))?,
        structs("", &["variable", "name"], &rasters)?,
        structs("", &["variable", "name", "unit", "comment", "time"], &channels)?,
    ];
    structs(NAME, &["comment", "start_time", "rasters", "channels"], &[element])
}
