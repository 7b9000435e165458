//! Interface of the formats to the handle.

use std::ops::Range;

use work::Context;

use crate::finding::are_rounded;
use crate::{Catalogue, Channel, Finding, Recording, RecordingError, Selection};

/// Rows that are handed on at once.
pub(crate) const STEP: usize = 1 << 16;

/// A file that was opened.
pub(crate) trait Opened: Send + Sync {
    /// Lists the channels.
    fn catalogue(&self) -> Result<Catalogue, RecordingError>;

    /// Reads the selected channels whole.
    fn decode(&self, selection: &Selection, context: &Context) -> Result<Recording, RecordingError>;

    /// The selected channels, of which some rows are read.
    fn part<'s>(&'s self, selection: &'s Selection, context: &Context) -> Result<Box<dyn Part + 's>, RecordingError>;
}

/// Selected channels of a file.
pub(crate) trait Part {
    /// Their clocks, as the recording has them.
    fn clocks(&self) -> Result<Vec<ClockShape>, RecordingError>;

    /// The names of the channels, each with the index of its clock.
    fn channels(&self) -> Vec<(String, usize)>;

    /// Some time stamps of a clock, s.
    fn stamps(&self, clock: usize, rows: Range<u64>, context: &Context) -> Result<Vec<f64>, RecordingError>;

    /// The recording with these rows of each clock.
    fn read(&self, rows: &[Range<u64>], context: &Context) -> Result<Recording, RecordingError>;

    /// Goes through all stamps and samples once. Any thread calls `each`, in any order.
    fn visit(&self, context: &Context, each: Each<'_>) -> Result<(), RecordingError>;
}

/// Receives numbers of a clock or channel: the row of the first, and the numbers from there on.
pub(crate) type Each<'a> = &'a (dyn Fn(Series, u64, &[f64]) + Sync);

/// Numbers over rows, by index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Series {
    Clock(usize),
    Channel(usize),
}

/// Size of a clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ClockShape {
    pub(crate) samples: u64,
    /// Rows that are read at once anyway.
    pub(crate) grain: u64,
    /// True where stamps are known to be out of order, so that a search has to go through all of them.
    pub(crate) is_out_of_order: bool,
}

/// Some of the numbers.
pub(crate) fn slice<'a>(numbers: &'a [f64], rows: &Range<u64>) -> &'a [f64] {
    let place = |row: u64| usize::try_from(row).unwrap_or(usize::MAX);
    numbers.get(place(rows.start)..place(rows.end)).unwrap_or_default()
}

/// Tells whether a finding concerns the rows in these channels: one on rounded integers only where there are some.
pub(crate) fn concerns(finding: &Finding, channels: &[Channel]) -> bool {
    let Finding::RoundedIntegers { channel } = finding else { return true };
    let mut named = channels.iter().filter(|other| other.name == *channel).peekable();
    named.peek().is_none() || named.any(|channel| are_rounded(&channel.samples))
}
