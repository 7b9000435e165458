//! The written dates and times of day of a file, counted from its first.

use super::stamp::{DAY, Frame, Stamp};
use crate::{CsvProblem, StartTime};

/// The days that spreadsheets count begin this many days before 1970.
const SPREADSHEET_DAYS: f64 = 25_569.0;
const NANOSECONDS_PER_DAY: f64 = 86_400e9;

/// Written dates and times of day of a file, in seconds since its first.
#[derive(Clone, Default)]
pub(super) struct Stamps {
    /// The first stamp of the file, from which seconds are counted.
    pub(super) first: Option<Stamp>,
    /// The decimal sign of a fraction that was just read.
    pub(super) sign: Option<u8>,
}

impl Stamps {
    /// The first stamp that was read.
    pub(super) fn first(&self) -> Option<Stamp> {
        self.first
    }

    /// A stamp in seconds; `last` is the one before it in its column, and its midnight.
    pub(super) fn time_s(
        &mut self,
        cell: &str,
        date: Option<&str>,
        last: &mut Option<(i64, i64)>,
    ) -> Result<f64, CsvProblem> {
        let stamp = match date {
            Some(date) => Stamp::read_pair(date, cell)?,
            None => Stamp::read(cell)?,
        };
        let stamp = stamp.ok_or_else(|| CsvProblem::NotATime { text: cell.into() })?;
        self.sign = stamp.is_comma.then_some(b',');
        let first = *self.first.get_or_insert(stamp);
        if stamp.frame != first.frame {
            return Err(CsvProblem::NotATime { text: cell.into() });
        }
        if stamp.frame != Frame::Clock {
            return Ok(seconds_between(first.nanoseconds, stamp.nanoseconds));
        }
        let (before, midnight) = last.unwrap_or((first.nanoseconds, 0));
        // A step back by more than half a day is midnight.
        let midnight = if stamp.nanoseconds < before - DAY / 2 { midnight + DAY } else { midnight };
        *last = Some((stamp.nanoseconds, midnight));
        Ok(seconds_between(0, stamp.nanoseconds + midnight))
    }

    /// Days and their fraction as spreadsheets count them.
    pub(super) fn spreadsheet(&mut self, days: f64, cell: &str) -> Result<f64, CsvProblem> {
        let since_1970 = (days - SPREADSHEET_DAYS) * NANOSECONDS_PER_DAY;
        if since_1970.is_nan() || since_1970.abs() > 9e18 {
            return Err(CsvProblem::NotATime { text: cell.into() });
        }
        // A double holds today's days to about half a microsecond: the rest is noise.
        let nanoseconds = (since_1970 / 1e3).round() as i64 * 1000;
        let stamp = Stamp { nanoseconds, frame: Frame::Local, offset_min: None, is_comma: false };
        Ok(seconds_between(self.first.get_or_insert(stamp).nanoseconds, nanoseconds))
    }

    pub(super) fn start(&self) -> Option<StartTime> {
        let first = self.first.filter(|first| first.frame != Frame::Clock)?;
        let is_local = first.frame == Frame::Local;
        Some(StartTime { nanoseconds: first.nanoseconds, is_local, utc_offset_min: first.offset_min })
    }
}

fn seconds_between(from: i64, to: i64) -> f64 {
    to.saturating_sub(from) as f64 / 1e9
}
