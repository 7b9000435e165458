//! Batches of rows to columns.

use arrow_array::{Array, RecordBatch};

use super::plan::{Clock, Group, Plan};
use super::values::{numbers, per_second, ticks};
use crate::{Channel, Format, Raster, Recording, RecordingError, StartTime};

const DAY_S: f64 = 86_400.0;

/// Columns under construction.
pub(super) struct Table {
    plan: Plan,
    parts: Vec<Part>,
    start_time: Option<StartTime>,
    row_distance_s: Option<f64>,
    /// Rows of the batches so far.
    rows: usize,
}

/// What a group has become.
struct Part {
    time_s: Vec<f64>,
    channels: Vec<Vec<f64>>,
    /// The last time of day and the midnight before it, s.
    last: Option<(f64, f64)>,
}

/// What is wrong with a column.
pub(super) struct Fault {
    column: String,
    detail: String,
}

impl Fault {
    pub(super) fn error(self, file: &str) -> RecordingError {
        RecordingError::DamagedChannel { file: file.into(), channel: self.column, detail: self.detail }
    }
}

impl Table {
    pub(super) fn new(plan: Plan, row_distance_s: Option<f64>) -> Self {
        let part = |group: &Group| Part {
            time_s: Vec::new(),
            channels: group.channels.iter().map(|_| Vec::new()).collect(),
            last: None,
        };
        let parts = plan.groups.iter().map(part).collect();
        Self { parts, plan, start_time: None, row_distance_s, rows: 0 }
    }

    pub(super) fn append(&mut self, batch: &RecordBatch) -> Result<(), Fault> {
        for index in 0..self.parts.len() {
            let present = self.present(index, batch);
            self.time(index, batch, present.as_deref())?;
            let group = &self.plan.groups[index];
            for (heading, samples) in group.channels.iter().zip(&mut self.parts[index].channels) {
                let fault = |detail: String| Fault { column: heading.name.clone(), detail };
                let array = batch.column(heading.column).as_ref();
                let values = numbers(array).ok_or_else(|| fault("its type changes".into()))?;
                match &present {
                    None => samples.extend_from_slice(&values),
                    Some(present) => {
                        let lost = (0..values.len()).find(|&row| !present[row] && !array.is_null(row));
                        if let Some(row) = lost {
                            return Err(fault(format!("row {} has a value but no time stamp", self.rows + row + 1)));
                        }
                        samples.extend(values.iter().zip(present).filter(|(_, present)| **present).map(|(v, _)| v));
                    }
                }
            }
        }
        self.rows += batch.num_rows();
        Ok(())
    }

    /// Which rows belong to a group; `None` where all do.
    fn present(&self, index: usize, batch: &RecordBatch) -> Option<Vec<bool>> {
        let group = &self.plan.groups[index];
        let column = match (&group.clock, group.channels.first()) {
            (_, Some(heading)) if group.is_listed => heading.column,
            (Some((clock, _)), _) => *clock,
            _ => return None,
        };
        let array = batch.column(column);
        (array.null_count() > 0).then(|| (0..array.len()).map(|row| !array.is_null(row)).collect())
    }

    /// Appends the time stamps of the rows that are present.
    fn time(&mut self, index: usize, batch: &RecordBatch, present: Option<&[bool]>) -> Result<(), Fault> {
        let is_present = |row: &usize| present.is_none_or(|present| present[*row]);
        let part = &mut self.parts[index];
        let Some((column, clock)) = &self.plan.groups[index].clock else {
            let distance_s = self.row_distance_s.unwrap_or(1.0);
            part.time_s.extend((self.rows..self.rows + batch.num_rows()).map(|row| row as f64 * distance_s));
            return Ok(());
        };
        let name = batch.schema().field(*column).name().clone();
        let array = batch.column(*column).as_ref();
        let fault = |detail: String| Fault { column: name.clone(), detail };
        if let Some(row) = (0..array.len()).filter(is_present).find(|&row| array.is_null(row)) {
            return Err(fault(format!("row {} has no time stamp", self.rows + row + 1)));
        }
        if let Clock::Numbers((factor, divisor)) = clock {
            let values = numbers(array).ok_or_else(|| fault("its type changes".into()))?;
            part.time_s.extend((0..values.len()).filter(is_present).map(|row| values[row] * factor / divisor));
            return Ok(());
        }
        let ticks = ticks(array).ok_or_else(|| fault("its type changes".into()))?;
        for row in (0..ticks.len()).filter(is_present) {
            let tick = ticks[row].unwrap_or_default();
            let time_s = match clock {
                Clock::Stamps(unit, zone) => {
                    let nanoseconds = tick.checked_mul(1_000_000_000 / per_second(*unit));
                    let nanoseconds = nanoseconds.ok_or_else(|| fault(format!("the date {tick} is out of range")))?;
                    let start = self.start_time.get_or_insert_with(|| start(nanoseconds, zone.as_deref()));
                    nanoseconds.saturating_sub(start.nanoseconds) as f64 / 1e9
                }
                Clock::TimeOfDay(unit) => part.time_of_day(tick as f64 / per_second(*unit) as f64),
                Clock::Duration(unit) => tick as f64 / per_second(*unit) as f64,
                Clock::Numbers(_) => f64::NAN,
            };
            part.time_s.push(time_s);
        }
        Ok(())
    }

    pub(super) fn finish(self) -> Recording {
        let (mut rasters, mut channels) = (Vec::new(), Vec::new());
        for (group, part) in self.plan.groups.into_iter().zip(self.parts) {
            for (heading, samples) in group.channels.into_iter().zip(part.channels) {
                let (name, unit, comment) = (heading.name, heading.unit, heading.comment);
                channels.push((heading.column, Channel { name, unit, comment, raster: rasters.len(), samples }));
            }
            rasters.push(Raster { time_s: part.time_s, name: group.name });
        }
        channels.sort_by_key(|(column, _)| *column);
        Recording {
            format: Format::Arrow,
            comment: self.plan.comment,
            start_time: self.start_time.or(self.plan.start_time),
            rasters,
            channels: channels.into_iter().map(|(_, channel)| channel).collect(),
            findings: self.plan.findings,
        }
    }
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
