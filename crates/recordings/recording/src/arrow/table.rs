//! Arrays of values to columns.

use std::collections::BTreeSet;
use std::ops::Range;

use arrow_array::{Array, ArrayRef};

use super::plan::{Clock, Group, Plan, TIME};
use super::values::{is_wide, numbers, per_second, ticks};
use crate::error::of_channel;
use crate::finding::are_rounded;
use crate::unstated;
use crate::{Channel, Finding, Format, Raster, Recording, RecordingError, SkipReason, StartTime};

const DAY_S: f64 = 86_400.0;
/// Values that are turned into numbers at once.
const PIECE: usize = 1 << 16;
const TYPE_CHANGES: &str = "its type changes";
/// Rows of a group from one whose place is noted to the next.
pub(super) const NOTED: usize = 1 << 10;

/// Columns under construction.
pub(super) struct Table {
    plan: Plan,
    parts: Vec<Part>,
    start_time: Option<StartTime>,
    row_distance_s: Option<f64>,
    /// Rows of the batches so far.
    rows: usize,
    /// Columns whose integers were rounded.
    rounded: BTreeSet<String>,
}

/// Values of a group that were read.
struct Part {
    time_s: Vec<f64>,
    channels: Vec<Vec<f64>>,
    /// The last time of day and the midnight before it, s.
    last: Option<(f64, f64)>,
    places: Places,
}

/// The rows of a table that are a group's.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Places {
    /// How many there are.
    count: usize,
    /// The rows that are the first of the group, and each that is [`NOTED`] rows of it later.
    noted: Vec<usize>,
}

impl Places {
    /// Takes notice of rows; in `present` those of the group are true, where not all are its.
    fn add(&mut self, first: usize, rows: usize, present: Option<&[bool]>) {
        let Some(present) = present else {
            let due = (self.count.next_multiple_of(NOTED)..self.count + rows).step_by(NOTED);
            self.noted.extend(due.map(|own| first + own - self.count));
            self.count += rows;
            return;
        };
        for row in (0..present.len()).filter(|&row| present[row]) {
            if self.count.is_multiple_of(NOTED) {
                self.noted.push(first + row);
            }
            self.count += 1;
        }
    }

    /// Rows of a table of so many that hold these of the group, and how many of the group stand before these in them.
    pub(super) fn rows(&self, own: &Range<usize>, all: usize) -> (Range<usize>, usize) {
        let begin = self.noted.get(own.start / NOTED).copied().unwrap_or(all);
        let end = self.noted.get(own.end.div_ceil(NOTED)).copied().unwrap_or(all);
        if self.count == all { (own.clone(), 0) } else { (begin..end, own.start % NOTED) }
    }
}

/// Fault of a column.
pub(super) struct Fault {
    column: String,
    flaw: Flaw,
}

/// Why values cannot be had.
pub(super) enum Flaw {
    /// The file is damaged.
    Damage(String),
    /// It is sound, but this is in the way.
    Unusable(SkipReason),
}

impl<T: Into<String>> From<T> for Flaw {
    fn from(detail: T) -> Self {
        Self::Damage(detail.into())
    }
}

impl Fault {
    pub(super) fn error(self, file: &str) -> RecordingError {
        let channel = self.column;
        match self.flaw {
            Flaw::Damage(detail) => of_channel(file, channel, detail),
            Flaw::Unusable(reason) => RecordingError::UnusableChannel { file: file.into(), channel, reason },
        }
    }
}

impl Table {
    /// `expected` says for each group how many samples there will be, which is memory that is taken at once.
    pub(super) fn new(plan: Plan, row_distance_s: Option<f64>, expected: &[usize]) -> Self {
        let column = |count: usize| {
            let mut column = Vec::new();
            // If there is not so much, it shows when the numbers are there.
            let _ = column.try_reserve_exact(count);
            column
        };
        let part = |(group, &count): (&Group, &usize)| Part {
            time_s: column(count),
            channels: group.channels.iter().map(|_| column(count)).collect(),
            last: None,
            places: Places::default(),
        };
        let parts = plan.groups.iter().zip(expected).map(part).collect();
        Self { parts, plan, start_time: None, row_distance_s, rows: 0, rounded: BTreeSet::new() }
    }

    /// The same for rows from this one on.
    pub(super) fn starting_at(self, rows: usize) -> Self {
        Self { rows, ..self }
    }

    /// Rows so far.
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// The rows of each group.
    pub(super) fn take_places(&mut self) -> Vec<Places> {
        self.parts.iter_mut().map(|part| std::mem::take(&mut part.places)).collect()
    }

    /// Appends rows, of which `read` gives the arrays of one column. `read` gets its place among the columns that are
    /// read. One column is read after the other, and twice where it says which rows are a group's.
    pub(super) fn append<A: Iterator<Item = Result<ArrayRef, String>>>(
        &mut self,
        rows: usize,
        read: impl Fn(usize) -> Result<A, Flaw>,
    ) -> Result<(), Fault> {
        let each = |column: usize, name: &str, take: &mut dyn FnMut(usize, &ArrayRef) -> Result<(), Flaw>| {
            each(read(column), rows, take).map_err(|flaw| Fault { column: name.into(), flaw })
        };
        for index in 0..self.plan.groups.len() {
            let group = &self.plan.groups[index];
            let clock = group.clock.as_ref().map(|(column, _)| *column);
            let mut present = Vec::new();
            if let Some((column, name)) = &group.mark {
                each(*column, name, &mut |_, array| {
                    present.extend((0..array.len()).map(|row| array.is_valid(row)));
                    Ok(())
                })?;
            }
            let present = present.contains(&false).then_some(present);
            self.parts[index].places.add(self.rows, rows, present.as_deref());
            match clock {
                Some(column) => {
                    each(column, TIME, &mut |before, array| self.time(index, before, array, present.as_deref()))?;
                }
                None => {
                    let distance_s = self.row_distance_s.unwrap_or(1.0);
                    let stamps = (self.rows..self.rows + rows).map(|row| row as f64 * distance_s);
                    self.parts[index].time_s.extend(stamps);
                }
            }
            let group = &self.plan.groups[index];
            for (heading, samples) in group.channels.iter().zip(&mut self.parts[index].channels) {
                each(heading.column, &heading.name, &mut |before, array| {
                    let first = samples.len();
                    append(array, present.as_deref().map(|p| &p[before..]), self.rows + before, samples)?;
                    if is_wide(array.data_type()) && are_rounded(&samples[first..]) {
                        self.rounded.insert(heading.name.clone());
                    }
                    Ok(())
                })?;
            }
        }
        self.rows += rows;
        Ok(())
    }

    /// Appends the time stamps of the rows of an array, those that are present, `before` rows into what is appended.
    fn time(&mut self, index: usize, before: usize, array: &dyn Array, present: Option<&[bool]>) -> Result<(), Flaw> {
        let Some((_, clock)) = &self.plan.groups[index].clock else { return Ok(()) };
        let part = &mut self.parts[index];
        let is_present = |row: &usize| present.is_none_or(|present| present[before + *row]);
        if let Some(row) = (0..array.len()).filter(is_present).find(|&row| array.is_null(row)) {
            return Err(Flaw::Unusable(SkipReason::NoTimeStamp { row: self.rows + before + row + 1 }));
        }
        if let Clock::Numbers((factor, divisor), _) = clock {
            let values = numbers(array).ok_or(TYPE_CHANGES)?;
            if is_wide(array.data_type()) && are_rounded(&values) {
                self.rounded.insert(TIME.into());
            }
            part.time_s.extend((0..values.len()).filter(is_present).map(|row| values[row] * factor / divisor));
            return Ok(());
        }
        let ticks = ticks(array).ok_or(TYPE_CHANGES)?;
        for row in (0..ticks.len()).filter(is_present) {
            let tick = ticks[row].unwrap_or_default();
            let time_s = match clock {
                Clock::Stamps(unit, zone) => {
                    let nanoseconds = tick.checked_mul(1_000_000_000 / per_second(*unit));
                    let nanoseconds = nanoseconds.ok_or_else(|| format!("the date {tick} is out of range"))?;
                    let start = self.start_time.get_or_insert_with(|| start(nanoseconds, zone.as_deref()));
                    nanoseconds.saturating_sub(start.nanoseconds) as f64 / 1e9
                }
                Clock::TimeOfDay(unit) => part.time_of_day(tick as f64 / per_second(*unit) as f64),
                Clock::Duration(unit) => tick as f64 / per_second(*unit) as f64,
                Clock::Numbers(..) => f64::NAN,
            };
            part.time_s.push(time_s);
        }
        Ok(())
    }

    pub(super) fn finish(self) -> Recording {
        let (mut rasters, mut channels, mut doubtful) = (Vec::new(), Vec::new(), Vec::new());
        for (group, part) in self.plan.groups.into_iter().zip(self.parts) {
            for (heading, samples) in group.channels.into_iter().zip(part.channels) {
                let (name, unit, comment) = (heading.name, heading.unit, heading.comment);
                channels.push((heading.column, Channel { name, unit, comment, raster: rasters.len(), samples }));
            }
            if let Some((_, Clock::Numbers(_, Some(name)))) = &group.clock {
                doubtful.extend(unstated::finding(name, &part.time_s));
            }
            rasters.push(Raster { time_s: part.time_s, name: group.name });
        }
        channels.sort_by_key(|(column, _)| *column);
        let rounded = self.rounded.into_iter().map(|channel| Finding::RoundedIntegers { channel });
        Recording {
            format: Format::Arrow,
            comment: self.plan.comment,
            start_time: self.start_time.or(self.plan.start_time),
            rasters,
            channels: channels.into_iter().map(|(_, channel)| channel).collect(),
            findings: self.plan.findings.into_iter().chain(doubtful).chain(rounded).collect(),
        }
    }
}

/// Hands on the arrays of a column, each with how many rows are before it; there must be `rows` in all.
fn each<A: Iterator<Item = Result<ArrayRef, String>>>(
    arrays: Result<A, Flaw>,
    rows: usize,
    take: &mut dyn FnMut(usize, &ArrayRef) -> Result<(), Flaw>,
) -> Result<(), Flaw> {
    let mut before = 0;
    for array in arrays? {
        let array = array?;
        if array.len() > rows - before {
            return Err(format!("it has more than {rows} rows").into());
        }
        take(before, &array)?;
        before += array.len();
    }
    match before == rows {
        true => Ok(()),
        false => Err(format!("it has {before} rows of {rows}").into()),
    }
}

/// Appends the numbers of the rows that are present; `first_row` counts those before the array.
fn append(array: &dyn Array, present: Option<&[bool]>, first_row: usize, samples: &mut Vec<f64>) -> Result<(), Flaw> {
    for first in (0..array.len()).step_by(PIECE) {
        let part = array.slice(first, PIECE.min(array.len() - first));
        let values = numbers(part.as_ref()).ok_or(TYPE_CHANGES)?;
        let Some(present) = present.map(|present| &present[first..]) else {
            samples.extend_from_slice(&values);
            continue;
        };
        if let Some(row) = (0..values.len()).find(|&row| !present[row] && !part.is_null(row)) {
            return Err(Flaw::Unusable(SkipReason::NoTimeStamp { row: first_row + first + row + 1 }));
        }
        samples.extend(values.iter().zip(present).filter(|(_, present)| **present).map(|(value, _)| value));
    }
    Ok(())
}

/// The start that the first of these stamps states; none where all are missing.
pub(super) fn start_of(array: &ArrayRef, clock: &Clock) -> Option<StartTime> {
    let Clock::Stamps(unit, zone) = clock else { return None };
    let tick = ticks(array.as_ref())?.into_iter().flatten().next()?;
    Some(start(tick.checked_mul(1_000_000_000 / per_second(*unit))?, zone.as_deref()))
}

impl Part {
    /// Seconds since the first midnight: a step back by more than half a day is the next.
    fn time_of_day(&mut self, time_s: f64) -> f64 {
        let (before, midnight) = self.last.unwrap_or((time_s, 0.0));
        let midnight = if time_s < before - DAY_S / 2.0 { midnight + DAY_S } else { midnight };
        self.last = Some((time_s, midnight));
        time_s + midnight
    }
}

/// The first time stamp; a zone that is only named says that the count is in UTC.
fn start(nanoseconds: i64, zone: Option<&str>) -> StartTime {
    let offset = |zone: &str| {
        let (sign, digits) = (zone.chars().next()?, zone.get(1..)?.replace(':', ""));
        let minutes = digits.get(..2)?.parse::<i32>().ok()? * 60 + digits.get(2..4)?.parse::<i32>().ok()?;
        match sign {
            '+' => Some(minutes),
            '-' => Some(-minutes),
            _ => None,
        }
    };
    let utc_offset_min = match zone {
        Some("UTC" | "Z" | "Etc/UTC") => Some(0),
        zone => zone.and_then(offset),
    };
    StartTime { nanoseconds, is_local: zone.is_none(), utc_offset_min }
}
