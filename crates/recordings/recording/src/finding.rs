//! Findings of a reader about a file that could be read.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

/// Something the user should know about a file that was read. Displayed as a sentence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Finding {
    /// A channel is in the file but not in the recording.
    SkippedChannel {
        /// Its name.
        channel: String,
        /// Why.
        reason: SkipReason,
    },
    /// The file announces more samples than it holds.
    MissingSamples {
        /// Index of the raster in the recording.
        raster: usize,
        /// How many samples the file announces.
        announced: u64,
        /// How many it holds.
        found: u64,
    },
    /// The file holds more records than it announces; all of them were read.
    UnannouncedSamples {
        /// Index of the raster in the recording.
        raster: usize,
        /// How many samples the file announces.
        announced: u64,
        /// How many it holds.
        found: u64,
    },
    /// The program that recorded the file did not close it.
    NotFinalised,
    /// The file ends within its data.
    CutOff {
        /// Where the missing part begins.
        offset: u64,
    },
    /// More than one channel has this name.
    DuplicateName {
        /// The name.
        name: String,
        /// How many channels have it.
        count: usize,
    },
    /// A text file that is not UTF-8 was read as Latin-1.
    AssumedLatin1,
    /// A text file ends in bytes of NUL, as one does whose writer lost power; they were left out.
    NulBytes {
        /// Where they begin.
        offset: u64,
        /// How many there are.
        count: u64,
    },
    /// The last line of a text file has too few columns and was left out.
    IncompleteLastLine {
        /// Its number, from 1.
        line: u64,
    },
    /// A text file ends without a line end: it may have been cut off, even within its last number.
    NoFinalLineEnd {
        /// Number of the last line, from 1.
        line: u64,
    },
    /// A clock without a unit was not read as seconds, since a number beside it states the sampling.
    AssumedTimeUnit {
        /// The variable that is the clock.
        clock: String,
        /// The unit it was read in.
        unit: String,
        /// The variable that states the sampling rate or time.
        stated_by: String,
    },
    /// A clock counts from 1970 in a unit that only its numbers show; it was read so, and counts from its first stamp.
    CountsSince1970 {
        /// The unit.
        unit: String,
    },
    /// A clock without a unit was read as seconds, which its numbers can hardly be.
    DoubtfulSeconds {
        /// The column that is the clock.
        clock: String,
        /// The unit that its numbers suggest.
        likely: String,
    },
    /// A clock that its format counts in seconds gives another unit.
    IgnoredTimeUnit {
        /// Index of the raster in the recording.
        raster: usize,
        /// The unit.
        unit: String,
    },
    /// Integers of a channel, or of a clock, are too large for a double and were rounded.
    RoundedIntegers {
        /// The channel.
        channel: String,
    },
    /// A file that lists its variables lacks one of them, or its clock.
    MissingVariable {
        /// The variable.
        variable: String,
    },
}

impl Finding {
    /// Returns true if it says how the time was read.
    #[must_use]
    pub fn is_about_time(&self) -> bool {
        matches!(
            self,
            Self::AssumedTimeUnit { .. }
                | Self::CountsSince1970 { .. }
                | Self::DoubtfulSeconds { .. }
                | Self::IgnoredTimeUnit { .. }
        )
    }

    /// Returns true if samples are, or may be, missing or cut off.
    #[must_use]
    pub fn is_loss(&self) -> bool {
        matches!(
            self,
            Self::MissingSamples { .. }
                | Self::NotFinalised
                | Self::CutOff { .. }
                | Self::NulBytes { .. }
                | Self::IncompleteLastLine { .. }
                | Self::NoFinalLineEnd { .. }
                | Self::MissingVariable { .. }
        )
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SkippedChannel { channel, reason } => {
                write!(f, "channel \"{channel}\" was skipped: {reason}")
            }
            Self::MissingSamples { raster, announced, found } => {
                write!(f, "samples are missing: raster {raster} announces {announced}, the file holds {found}")
            }
            Self::UnannouncedSamples { raster, announced, found } => {
                write!(f, "raster {raster} announces {announced} samples, the file holds {found}; all were read")
            }
            Self::NotFinalised => {
                f.write_str("the file was not closed by the program that recorded it; the last samples may be missing")
            }
            Self::CutOff { offset } => {
                write!(f, "the file ends within its data, at byte {offset}; samples may be missing")
            }
            Self::DuplicateName { name, count } => {
                write!(f, "{count} channels are named \"{name}\"")
            }
            Self::AssumedLatin1 => f.write_str("the text is not UTF-8 and was read as Latin-1"),
            Self::NulBytes { offset, count } => write!(
                f,
                "the text ends at byte {offset}; the {count} bytes after it are NUL, as where the writer lost power, and were \
                 left out; samples may be missing"
            ),
            Self::IncompleteLastLine { line } => {
                write!(f, "line {line}, the last, is incomplete and was left out; the file seems to be cut off")
            }
            Self::NoFinalLineEnd { line } => {
                write!(f, "line {line}, the last, has no line end; if the file was cut off, its last number is wrong")
            }
            Self::AssumedTimeUnit { clock, unit, stated_by } => {
                write!(f, "time \"{clock}\" was read in {unit}, which its distance and \"{stated_by}\" agree on")
            }
            Self::CountsSince1970 { unit } => write!(
                f,
                "the time stamps are so large that they count {unit} since 1970; they were read so, and seconds count from the \
                 first of them"
            ),
            Self::DoubtfulSeconds { clock, likely } => write!(
                f,
                "time \"{}\" has no unit and was read in s, but its numbers look like {likely}; write the unit into the heading, as \
                 in \"time [{}]\"",
                clock.escape_debug(),
                likely.split_once(' ').map_or(likely.as_str(), |(_, how)| if how.contains("MATLAB") {
                    "d"
                } else {
                    "excel"
                })
            ),
            Self::IgnoredTimeUnit { raster, unit } => write!(
                f,
                "the time of raster {raster} was read in seconds, as the format prescribes, though its unit is \"{}\"; \
                 check its duration",
                unit.escape_debug()
            ),
            Self::RoundedIntegers { channel } => write!(
                f,
                "channel \"{channel}\" holds integers of 2^53 or more, which were rounded to the closest double"
            ),
            Self::MissingVariable { variable } => {
                write!(f, "variable \"{variable}\" is listed in the file, but it or its clock is not there")
            }
        }
    }
}

/// Why a channel was skipped.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum SkipReason {
    /// It holds text, bytes, arrays, or dates.
    NotNumeric {
        /// Its content.
        kind: String,
    },
    /// Its group has no time channel.
    NoTime,
    /// Its group runs over an angle, a distance or an index.
    NotOverTime,
    /// It uses a feature of the format that this reader does not know.
    Unsupported {
        /// The feature.
        detail: String,
    },
    /// A variable without a clock: no vector of its length is named as time.
    NoTimeVector {
        /// Its samples.
        samples: usize,
    },
    /// More than one vector of its length is named as time, and they differ.
    AmbiguousTime {
        /// Their names.
        candidates: String,
    },
    /// The unit stated for its time is none of time, or contradicts the name.
    TimeUnit {
        /// The variable that is the clock.
        clock: String,
        /// The unit.
        unit: String,
    },
    /// It has a value in a row without a time stamp.
    NoTimeStamp {
        /// The row, from 1.
        row: usize,
    },
    /// It is named as time, but no other variable has its length.
    UnusedTime {
        /// Its length.
        samples: usize,
    },
    /// Time that repeats itself, beside time that rises with every row, which is the clock.
    CoarseTime,
    /// A clock that no channel follows.
    NoChannels,
    /// A column without a name that counts the rows.
    RowNumbers,
    /// A constant.
    SingleNumber {
        /// The number.
        number: String,
    },
}

impl fmt::Display for SkipReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotNumeric { kind } => write!(f, "it holds {kind}, not numbers"),
            Self::NoTime => {
                f.write_str("its group has no time channel; give the sample time, or export it with its time")
            }
            Self::NotOverTime => f.write_str("its group is recorded over something other than time"),
            Self::Unsupported { detail } => {
                write!(f, "it is stored in a way not supported: {detail}")
            }
            Self::NoTimeVector { samples } => write!(
                f,
                "no increasing vector of {samples} elements is named as time; save its time with it as \"t\", or give the \
                 sample time"
            ),
            Self::AmbiguousTime { candidates } => {
                write!(f, "its time may be any of {candidates}, which differ; name only one of them as time")
            }
            Self::TimeUnit { clock, unit } => write!(
                f,
                "its time \"{clock}\" is stated to be in \"{unit}\", which is no unit of time or not the one in its name; \
                 state s, ms, us, ns, min, h or d"
            ),
            Self::NoTimeStamp { row } => {
                write!(f, "row {row} has a value but no time stamp; write the stamp, or empty or remove the row")
            }
            Self::UnusedTime { samples } => {
                write!(f, "it is named as time, but no array beside it has its {samples} samples")
            }
            Self::CoarseTime => f.write_str(
                "this time does not rise with every row; another column has the same time with a finer step, and is the clock",
            ),
            Self::NoChannels => f.write_str("it is named as a clock, but no channel follows it"),
            Self::RowNumbers => f.write_str("it has no name and counts the rows"),
            Self::SingleNumber { number } => write!(f, "it is the single number {number}, not samples over time"),
        }
    }
}

/// Returns true if some of these, which were integers, may have been rounded: those below 2^53 are exact.
pub(crate) fn are_rounded(integers: &[f64]) -> bool {
    integers.iter().any(|number| number.abs() >= 9_007_199_254_740_992.0)
}

/// One finding for each name that occurs more than once.
pub(crate) fn duplicate_names<'a>(names: impl Iterator<Item = &'a str>) -> Vec<Finding> {
    let mut counts = BTreeMap::new();
    for name in names {
        *counts.entry(name).or_insert(0_usize) += 1;
    }
    let doubles = counts.into_iter().filter(|&(_, count)| count > 1);
    doubles.map(|(name, count)| Finding::DuplicateName { name: name.to_owned(), count }).collect()
}
