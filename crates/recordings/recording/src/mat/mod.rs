//! MAT-files of MATLAB: variables that hold arrays, text, cells and structs, in any order.
//!
//! [`level73`], [`level5`] and [`level4`] read the variables, [`scope`] finds the clocks among them, [`listed`] reads
//! the list that [`write`] puts into its files.

#[cfg(feature = "hdf5")]
mod dataset;
#[cfg(not(feature = "hdf5"))]
#[path = "no_dataset.rs"]
mod dataset;
mod labels;
mod level4;
mod level5;
#[cfg(feature = "hdf5")]
mod level73;
#[cfg(not(feature = "hdf5"))]
#[path = "absent.rs"]
mod level73;
mod listed;
mod objects;
mod part;
mod scope;
mod stored;
mod value;
mod variables;
mod wanted;
mod write;

use crate::source::{self, Shared};
use crate::{Catalogue, Format, Recording, RecordingError, Selection};
#[cfg(feature = "parquet")]
pub(crate) use listed::{start_text, start_time};
pub(crate) use part::Content;
use scope::Plan;
use variables::Variables;
use wanted::Wanted;
use work::Context;
pub use write::{encode_mat5, write_mat5};

/// First bytes of an HDF5 file; one of level 7.3 has them after a header like that of level 5.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Bytes that show the level.
const HEAD: u64 = 256;

/// Returns true if content is a MAT-file, of a level that can be read or not.
pub(crate) fn is_mat(bytes: &[u8]) -> bool {
    is_level5(bytes) || bytes.starts_with(b"MATLAB 5.0 MAT-file") || bytes.starts_with(HDF5) || level4::starts(bytes)
}

fn is_level5(bytes: &[u8]) -> bool {
    // Text before the level, and no text as level: other text has those letters too.
    let (text, level) = (bytes.get(..4), bytes.get(124..126));
    level5::is_big_endian(bytes).is_some()
        && text.is_some_and(|text| text.iter().all(|b| !b.is_ascii_control()))
        && level.is_some_and(|level| level.iter().all(|b| *b < b' ' && !b.is_ascii_whitespace()))
}

/// Decodes a MAT-file; arrays without a time vector are left out, or have rows `row_distance_s` apart if that is known.
pub(crate) fn decode(
    name: &str,
    source: &Shared,
    selection: &Selection,
    row_distance_s: Option<f64>,
    context: &Context,
) -> Result<Recording, RecordingError> {
    read(name, source, Wanted::new(selection), row_distance_s, context).map(|content| content.recording)
}

/// Finds the channels of a MAT-file. Those of HDF5 whose samples lie along the first dimension are left to be read in
/// part.
pub(crate) fn content(
    name: &str,
    source: &Shared,
    selection: &Selection,
    row_distance_s: Option<f64>,
    context: &Context,
) -> Result<Content, RecordingError> {
    let mut content = read(name, source, Wanted::places(selection), row_distance_s, context)?;
    content.fill(name)?;
    Ok(content)
}

/// Lists a MAT-file: of arrays that are neither small nor clocks, the shape is read.
pub(crate) fn catalogue(name: &str, source: &Shared, row_distance_s: Option<f64>) -> Result<Catalogue, RecordingError> {
    let content = read(name, source, Wanted::LIST, row_distance_s, &Context::new())?;
    Ok(content.recording.catalogue())
}

fn read(
    name: &str,
    source: &Shared,
    wanted: Wanted<'_>,
    row_distance_s: Option<f64>,
    context: &Context,
) -> Result<Content, RecordingError> {
    let selection = wanted.selection;
    let (format, Variables { mut list, start_time, datasets }) = variables(name, source, wanted, context)?;
    let mut plan = Plan::new(row_distance_s);
    let listed = listed::take(name, &mut list, &mut plan, selection)?;
    plan.top(list);
    let (mut recording, stored) = plan.finish(name, selection, format)?;
    (recording.comment, recording.start_time) = (listed.0, listed.1.or(start_time));
    Ok(Content { recording, stored, datasets })
}

fn variables(
    name: &str,
    source: &Shared,
    wanted: Wanted<'_>,
    context: &Context,
) -> Result<(Format, Variables), RecordingError> {
    let head = source::bytes(name, &**source, 0, HEAD)?;
    if head.starts_with(HDF5) {
        return Ok((Format::Hdf5, level73::variables(name, source, wanted)?));
    }
    if level4::starts(&head) {
        return Ok((
            Format::Mat { level: 4 },
            Variables { list: level4::variables(name, &**source, &wanted)?, start_time: None, datasets: Vec::new() },
        ));
    }
    let Some(big) = level5::is_big_endian(&head) else {
        return Err(RecordingError::Truncated {
            file: name.into(),
            offset: 0,
            expected: level5::HEADER as u64,
            available: head.len() as u64,
        });
    };
    match (if big { head[124] } else { head[125] }, head[124].max(head[125])) {
        (1, _) => Ok((Format::Mat { level: 5 }, level5::variables(name, source, wanted, context)?)),
        (2, _) => Ok((Format::Mat { level: 73 }, level73::variables(name, source, wanted)?)),
        (_, other) => Err(RecordingError::Damaged {
            file: name.into(),
            offset: Some(124),
            detail: format!("a MAT-file of level {other}"),
        }),
    }
}
