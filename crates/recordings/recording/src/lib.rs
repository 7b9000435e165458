#![doc = include_str!("../README.md")]
//!
//! Measurement files as plain data: decodes bytes into a [`Recording`], and a [`Recording`] back into bytes.
//!
//! A recording holds channels with the names, units and comments found in the file, each on one of the file's clocks
//! ([`Raster`]). Nothing is resampled, renamed, converted to other units or repaired: time stamps that run backwards,
//! NaN and missing samples are handed on as they are, and what could not be taken over is listed as a [`Finding`].
//!
//! This crate knows no SI units (time alone is in seconds), no torque, no resampling, no models, and no paths: its
//! input and output are bytes, or for large files a [`Source`] of them, of which only what is asked for is read.
//!
//! | format | read | written |
//! | --- | --- | --- |
//! | MDF 2.x and 3.x (`.mdf`, `.dat`) | yes | – |
//! | MDF 4.x (`.mf4`) | yes | 4.10, deflated ([`write_mdf4`]) |
//! | CSV | yes | yes ([`write_csv`], [`write_tsv`]) |
//! | MAT-files of MATLAB, levels 4, 5 and 7.3 (`-v4`, `-v6`, `-v7`, `-v7.3`; `.mat`), HDF5 | yes | level 5, deflated ([`write_mat5`]) |
//! | Parquet, Arrow (file and stream), with the feature `parquet` | yes | yes (`write_parquet`, `write_arrow`) |
//!
//! HDF5 and level 7.3 are read with the feature `hdf5`.
//!
//! Text is read with tabs, semicolons, commas or bars between the columns and decimal points or commas, in UTF-8,
//! UTF-16 or Latin-1; bytes of NUL behind it are left out, and said. A heading is one row with a name of time in it,
//! and up to two more with units and comments; what stands above is the recording's comment, and lines that begin with
//! `#` or `%` are skipped. Time is a number in the unit that the heading gives, a time of day (past midnight the next
//! day's), or date and time; with a date, seconds count from the first stamp, which is the start time. A column whose
//! first value is text is skipped, and so is a first column without a name that counts the rows. `1,234` is a decimal
//! number where some other number of the file shows that digits are not grouped; otherwise, where signs are mixed, and
//! where a number is beyond what a double holds, the file is refused.
//!
//! Each clock is that of the columns up to the next, which may be shorter. The first column named as time is one,
//! unless it repeats itself and another shows the same time and rises with every row, as seconds do beside a time of
//! day. Another is one if it is named alike (`time`, `time_2`, `Time (s).1`), or if a word of its name means time
//! (`time_slow`), it is between channels, and its first rows (of the 200 of the heading and after it) rise, from about
//! the same time as the first clock's, but faster or slower. It is a channel if it falls or stays, if no channel
//! follows it, if it counts the same time from elsewhere, if it is the same to the last row, or if its name ends in
//! `_channel`. What may be either is refused.
//!
//! The masters of MDF are in seconds; one that says otherwise is read so all the same, and named. Groups without a
//! master are left out, unless the distance of samples is given.
//!
//! Numbers as large as the milliseconds, microseconds or nanoseconds since 1970 are read as such, whatever unit is
//! stated: seconds count from the first, which is the start time, and it is said.
//!
//! A table of Parquet or Arrow follows the same rules for names. Without such a name its only column of time stamps is
//! the clock. Null is NaN, and in a clock a row without channels; units are in the metadata `unit` of a field or in its
//! name.
//!
//! A MAT-file holds variables and says nothing of clocks. Its real numeric arrays become channels: a vector one, a
//! matrix one for each column (`y(:,1)`), fields of structs with dots (`data.y`), cells by number (`y{1}`). Their clock
//! is a vector that does not decrease, is as long, and is named as time (`t`, `Time`, `Zeit`, `tout`, `time_ms`, …) in
//! the same struct or one around it; a matrix that has as many columns as a clock has stamps, and not as many rows,
//! holds its channels in rows. Data with a sample time `Ts` and `u` or `y` beside it start at `Tstart` or 0. A clock is
//! in seconds, unless its name, a text beside it (`time_unit`; in HDF5 its attribute `unit`), or else a sampling rate
//! or time beside it, says otherwise; what is no unit of time, or not the one in its name, is refused. A capital `T` is
//! no clock.
//!
//! Of the objects of MATLAB, tables and timetables are read, like structs of their columns. The times of a timetable's
//! rows are its clock, and so is the only column of times in a table; elsewhere durations and dates are read where they
//! are named like a clock. Dates count from the first of the file, which is the start time. How others are stored, as
//! time series, nobody has published: they are named, with what to save instead.

#[cfg(feature = "parquet")]
mod arrow;
#[cfg(not(feature = "parquet"))]
#[path = "arrow/absent.rs"]
mod arrow;
mod csv;
mod epoch;
mod error;
mod finding;
mod handle;
mod heading;
mod kept;
mod kind;
mod mat;
mod mdf;
mod model;
pub mod names;
mod part;
mod required;
mod source;
mod unstated;

use std::sync::Arc;

use kind::Kind;
use work::Context;

pub use ::mdf::{Attachment, Event, Quantity, Source};
#[cfg(feature = "parquet")]
pub use arrow::{encode_arrow, encode_parquet, write_arrow, write_parquet};
pub use csv::{encode_csv, encode_tsv, fits_text, write_csv, write_tsv};
pub use error::{CsvProblem, RecordingError};
pub use finding::{Finding, SkipReason};
pub use handle::{Envelope, Handle, Pyramid, Span, open};
pub use mat::{encode_mat5, write_mat5};
pub use mdf::{Extras, encode_mdf4, write_mdf4};
pub use model::{
    Catalogue, Channel, ChannelInfo, Format, PROGRAM, Raster, RasterInfo, Recording, Selection, StartTime,
};

/// Decodes the bytes of a measurement file.
///
/// The format is recognised from the content. `name` is the file's name as the user knows it: it appears in error
/// messages, and its ending decides only whether content that is no known binary format may be read as CSV.
///
/// Samples that the file marks invalid, and empty CSV cells, are NaN. Only rasters that carry a selected channel are
/// returned; channels keep the order of the file.
///
/// # Errors
///
/// [`RecordingError`] where the content is not understood, damaged, or lacks a channel that was named in
/// `selection`. A file with samples missing at its end gives either an error or the samples that are there with a
/// [`Finding`] saying what is missing.
///
/// # Example
///
/// ```
/// let bytes = b"time [s];speed [rpm]\n0;1200\n0,1;1201,5\n";
/// let recording = recording::decode("run.csv", bytes, &recording::Selection::All)?;
/// assert_eq!(recording.channels[0].unit, "rpm");
/// assert_eq!(recording.channels[0].samples, [1200.0, 1201.5]);
/// assert_eq!(recording.rasters[0].time_s, [0.0, 0.1]);
/// # Ok::<(), recording::RecordingError>(())
/// ```
pub fn decode(name: &str, bytes: &[u8], selection: &Selection) -> Result<Recording, RecordingError> {
    decode_from(name, Arc::new(bytes.to_vec()), selection, None, &Context::new())
}

/// Decodes as [`decode`] does, and accepts what has no time too: text without a time column, groups of MDF without a
/// master, and the arrays of a MAT-file that no time vector fits. Its rows are `row_distance_s` apart, the first at 0;
/// arrays of the same length share a raster. Such text needs no heading either (its columns are then `column 1`,
/// `column 2`, …), and blanks may separate its columns.
///
/// # Errors
///
/// As [`decode`]; [`RecordingError::RowDistance`] where the distance is not a positive finite number.
///
/// # Example
///
/// ```
/// let recording = recording::decode_untimed("dryer.dat", b"1.5 2\n2.5 3\n", 0.08)?;
/// assert_eq!(recording.channels[1].name, "column 2");
/// assert_eq!(recording.rasters[0].time_s, [0.0, 0.08]);
/// # Ok::<(), recording::RecordingError>(())
/// ```
pub fn decode_untimed(name: &str, bytes: &[u8], row_distance_s: f64) -> Result<Recording, RecordingError> {
    decode_from(name, Arc::new(bytes.to_vec()), &Selection::All, Some(row_distance_s), &Context::new())
}

/// Lists the channels of a measurement file without their samples.
///
/// Only what is listed is read: of MDF, Parquet, Arrow and HDF5 the structure, of MAT-files also what gives the clocks
/// and what is small, of text the first megabytes. Where longer text goes on after them, nothing is said of the number
/// of its samples, and a column that is empty up to there is taken for a channel.
///
/// # Errors
///
/// As [`decode`].
///
/// # Example
///
/// ```
/// let list = recording::catalogue("run.csv", b"time,speed (rpm)\n0,1200\n")?;
/// assert_eq!(list.channels[0].name, "speed");
/// assert_eq!(list.rasters[list.channels[0].raster].samples, Some(1));
/// # Ok::<(), recording::RecordingError>(())
/// ```
pub fn catalogue(name: &str, bytes: &[u8]) -> Result<Catalogue, RecordingError> {
    catalogue_from(name, Arc::new(bytes.to_vec()))
}

/// Decodes as [`decode`] does, or as [`decode_untimed`] where the distance of rows is given, from a source, which is
/// read in pieces: memory is taken by the channels that are selected, and not by the file.
///
/// Beyond that it takes some tens of megabytes; for tables in MAT-files what the file keeps of all its objects (level
/// 5) or their other columns (7.3), for arrays whose rows are the channels as much again, and for compressed Arrow a
/// column of a batch.
///
/// `context` is the step of reading.
///
/// # Errors
///
/// As [`decode`] and [`decode_untimed`]; [`RecordingError::Unreadable`] where the source fails.
pub fn decode_from(
    name: &str,
    source: Arc<dyn Source>,
    selection: &Selection,
    row_distance_s: Option<f64>,
    context: &Context,
) -> Result<Recording, RecordingError> {
    open(name, source, row_distance_s, context)?.read(selection, &Span::All, context)
}

/// Lists as [`catalogue`] does, from a source. The samples of an MDF file are read where records of several groups have
/// to be counted, since the file was never closed.
///
/// # Errors
///
/// As [`decode_from`].
pub fn catalogue_from(name: &str, source: Arc<dyn Source>) -> Result<Catalogue, RecordingError> {
    open(name, source, None, &Context::new())?.catalogue()
}

/// Contents of an MDF file beside its channels; nothing for other formats.
///
/// # Errors
///
/// As [`catalogue_from`].
pub fn extras_from(name: &str, source: &dyn Source) -> Result<Extras, RecordingError> {
    match Kind::detect(name, source)? {
        Kind::Mdf => mdf::extras(name, source),
        _ => Ok(Extras::default()),
    }
}
