//! The plain data a measurement file is decoded into.

use std::collections::HashSet;
use std::fmt;

use jiff::ToSpan;
use jiff::civil::Date;
use serde::{Deserialize, Serialize};

use crate::{Finding, RecordingError, names};

/// The program by which files are made, where no other is named.
pub const PROGRAM: &str = concat!("dynoid ", env!("CARGO_PKG_VERSION"));

/// A decoded measurement file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recording {
    /// Format of the bytes.
    pub format: Format,
    /// The file's own comment.
    pub comment: Option<String>,
    /// When the measurement started, as the file states it.
    pub start_time: Option<StartTime>,
    /// The clocks of the file.
    pub rasters: Vec<Raster>,
    /// The channels in the order of the file. Names are not necessarily unique.
    pub channels: Vec<Channel>,
    /// Losses of the reader, and facts to know about the file.
    pub findings: Vec<Finding>,
}

impl Recording {
    /// The first channel of this name.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|c| c.name == name)
    }

    /// The time stamps in seconds of a channel of this recording.
    #[must_use]
    pub fn time_s(&self, channel: &Channel) -> Option<&[f64]> {
        let raster = self.rasters.get(channel.raster)?;
        Some(&raster.time_s)
    }

    /// Fails where a channel has no raster, or not one sample for each of its time stamps.
    pub(crate) fn check(&self) -> Result<(), RecordingError> {
        let rasters = self.rasters.len();
        for Channel { name, raster, samples, .. } in &self.channels {
            let Some(clock) = self.rasters.get(*raster) else {
                return Err(RecordingError::NoSuchRaster { channel: name.clone(), raster: *raster, rasters });
            };
            let (samples, times) = (samples.len(), clock.time_s.len());
            if samples != times {
                return Err(RecordingError::LengthMismatch { channel: name.clone(), samples, times });
            }
        }
        Ok(())
    }

    /// The list of channels without their samples.
    #[must_use]
    pub fn catalogue(&self) -> Catalogue {
        let raster = |r: &Raster| RasterInfo { name: r.name.clone(), samples: Some(r.time_s.len()) };
        let channel = |c: &Channel| ChannelInfo {
            name: c.name.clone(),
            unit: c.unit.clone(),
            comment: c.comment.clone(),
            raster: c.raster,
        };
        Catalogue {
            format: self.format,
            comment: self.comment.clone(),
            start_time: self.start_time,
            rasters: self.rasters.iter().map(raster).collect(),
            channels: self.channels.iter().map(channel).collect(),
            findings: self.findings.clone(),
        }
    }
}

/// One clock: the time stamps that a group of channels shares.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Raster {
    /// Time stamps in seconds, as recorded: they need not start at zero, be evenly spaced, nor even increase.
    pub time_s: Vec<f64>,
    /// The name or comment that the file gives the group.
    pub name: Option<String>,
}

/// One measured signal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Channel {
    /// The name in the file.
    pub name: String,
    /// The unit as spelled in the file; empty where it gives none.
    pub unit: String,
    /// The description in the file; empty where it gives none.
    pub comment: String,
    /// Index into [`Recording::rasters`].
    pub raster: usize,
    /// One sample per time stamp of the raster; NaN where missing or marked invalid.
    pub samples: Vec<f64>,
}

/// Inventory of a file, without the samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Catalogue {
    /// Format of the bytes.
    pub format: Format,
    /// The file's own comment.
    pub comment: Option<String>,
    /// When the measurement started, as the file states it.
    pub start_time: Option<StartTime>,
    /// The clocks of the file.
    pub rasters: Vec<RasterInfo>,
    /// The channels in the order of the file.
    pub channels: Vec<ChannelInfo>,
    /// Losses of the reader, and facts to know about the file.
    pub findings: Vec<Finding>,
}

impl Catalogue {
    /// Adds a finding for each name that occurs more than once.
    pub(crate) fn note_duplicates(&mut self) {
        let names = self.channels.iter().map(|c| c.name.as_str());
        let doubles = crate::finding::duplicate_names(names);
        self.findings.extend(doubles);
    }
}

/// A [`Raster`] without its time stamps.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RasterInfo {
    /// The name or comment that the file gives the group.
    pub name: Option<String>,
    /// How many samples each of its channels has; none if only reading can count them.
    pub samples: Option<usize>,
}

/// A [`Channel`] without its samples.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChannelInfo {
    /// The name in the file.
    pub name: String,
    /// The unit as spelled in the file.
    pub unit: String,
    /// The description in the file.
    pub comment: String,
    /// Index into [`Catalogue::rasters`].
    pub raster: usize,
}

/// The format of a file, displayed as "MDF 4.10", "CSV" or "MAT 5".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Format {
    /// ASAM MDF.
    Mdf {
        /// Version times one hundred: 410 is 4.10.
        version: u16,
    },
    /// Text with delimiters.
    Csv {
        /// Character that separates the columns.
        delimiter: char,
        /// True if numbers are written `1,5`.
        decimal_comma: bool,
    },
    /// MAT-file of MATLAB.
    Mat {
        /// 4, 5, or 73 for 7.3.
        level: u8,
    },
    /// HDF5 of another program.
    Hdf5,
    /// Apache Parquet.
    Parquet,
    /// Apache Arrow, as a file or a stream.
    Arrow,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mdf { version } => write!(f, "MDF {}.{:02}", version / 100, version % 100),
            Self::Csv { .. } => f.write_str("CSV"),
            Self::Mat { level: 73 } => f.write_str("MAT 7.3"),
            Self::Hdf5 => f.write_str("HDF5"),
            Self::Parquet => f.write_str("Parquet"),
            Self::Arrow => f.write_str("Arrow"),
            Self::Mat { level } => write!(f, "MAT {level}"),
        }
    }
}

/// When a measurement started, as stored in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct StartTime {
    /// Nanoseconds since 1970-01-01 00:00, in UTC or, where `is_local`, on the clock of the test bench.
    pub nanoseconds: i64,
    /// The count is on the local clock.
    pub is_local: bool,
    /// Minutes by which the local clock was ahead of UTC, daylight saving included, where the file says so.
    pub utc_offset_min: Option<i32>,
}

impl StartTime {
    /// The day, where the measurement was made if the file says so, as in 2026-05-03.
    ///
    /// # Example
    /// ```
    /// let start = recording::StartTime { nanoseconds: 1_777_847_400_000_000_000, is_local: false, utc_offset_min: None };
    /// assert_eq!(start.day(), "2026-05-03");
    /// let ahead = recording::StartTime { utc_offset_min: Some(120), ..start };
    /// assert_eq!(ahead.day(), "2026-05-04");
    /// ```
    #[must_use]
    pub fn day(&self) -> String {
        let offset_min = if self.is_local { 0 } else { self.utc_offset_min.unwrap_or(0) };
        let seconds = self.nanoseconds.div_euclid(1_000_000_000) + 60 * i64::from(offset_min);
        let days = seconds.div_euclid(86_400);
        Date::constant(1970, 1, 1).saturating_add(days.days()).to_string()
    }
}

/// Which channels to decode.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Selection {
    /// Every numeric channel.
    #[default]
    All,
    /// The channels of these names (all of them, where a name occurs more than once); a name that is not in the
    /// file is an error.
    Names(Vec<String>),
    /// The numeric channels whose names fit one of these patterns, in which `*` stands for any characters and `?` for
    /// one (a name fits itself, whatever is in it); a pattern that fits no name in the file is an error.
    Patterns(Vec<String>),
}

impl Selection {
    /// Selects channels by name.
    pub fn names<S: Into<String>>(names: impl IntoIterator<Item = S>) -> Self {
        Self::Names(names.into_iter().map(Into::into).collect())
    }

    /// Returns true if a channel of this name is among them.
    #[must_use]
    pub fn takes(&self, name: &str) -> bool {
        match self {
            Self::All => true,
            Self::Names(names) => names.iter().any(|n| n == name),
            Self::Patterns(patterns) => patterns.iter().any(|pattern| fits(pattern, name)),
        }
    }

    /// Returns true if a channel is asked for by its very name, so that it has to be there.
    pub(crate) fn insists_on(&self, name: &str) -> bool {
        match self {
            Self::All => false,
            Self::Names(names) | Self::Patterns(names) => names.iter().any(|n| n == name),
        }
    }

    /// The name or pattern that fits none of the names.
    pub(crate) fn missing<'s, 'a>(&'s self, present: impl Iterator<Item = &'a str> + Clone) -> Option<&'s str> {
        let missing = match self {
            Self::All => None,
            Self::Names(names) => {
                let present: HashSet<&str> = present.collect();
                names.iter().find(|n| !present.contains(n.as_str()))
            }
            Self::Patterns(patterns) => patterns.iter().find(|p| !present.clone().any(|name| fits(p, name))),
        };
        missing.map(String::as_str)
    }
}

fn fits(pattern: &str, name: &str) -> bool {
    pattern == name || names::matches(pattern, name)
}
