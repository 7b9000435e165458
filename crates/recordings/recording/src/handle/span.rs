//! Parts of a recording, and the rows that they have on a clock.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::RecordingError;
use crate::part::{ClockShape, STEP};

/// Part of a recording.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Span {
    /// Everything.
    #[default]
    All,
    /// On each clock the rows from the first to the last whose time stamp is in the span. The clock is searched by
    /// halves. Where that meets stamps out of order, all of the clock is read.
    Time {
        /// The first instant, s.
        from_s: f64,
        /// The last instant, s.
        to_s: f64,
    },
    /// On each clock the rows with these numbers, as far as it has them.
    Rows(Range<u64>),
}

/// Reader of some time stamps.
type Stamps<'a> = &'a dyn Fn(Range<u64>) -> Result<Vec<f64>, RecordingError>;

impl Span {
    /// The rows of a clock.
    pub(super) fn rows(&self, clock: &ClockShape, stamps: Stamps<'_>) -> Result<Range<u64>, RecordingError> {
        match self {
            Self::All => Ok(0..clock.samples),
            Self::Rows(rows) => {
                let end = rows.end.min(clock.samples);
                Ok(rows.start.min(end)..end)
            }
            Self::Time { from_s, to_s } => between(clock, *from_s, *to_s, stamps),
        }
    }
}

/// The rows from the first to the last whose stamps are in a span of time.
fn between(clock: &ClockShape, from_s: f64, to_s: f64, stamps: Stamps<'_>) -> Result<Range<u64>, RecordingError> {
    if clock.samples <= clock.grain || clock.is_out_of_order {
        return scanned(clock, from_s, to_s, stamps);
    }
    let mut search = Search { clock, stamps, seen: BTreeMap::new() };
    let begin = search.first(0, &|time_s| time_s >= from_s)?;
    let end = match begin {
        Some(begin) => search.first(begin, &|time_s| time_s > to_s)?,
        None => None,
    };
    match (begin, end) {
        (Some(begin), Some(end)) if search.is_in_order() => Ok(begin..end.max(begin)),
        _ => scanned(clock, from_s, to_s, stamps),
    }
}

/// The same for a clock that is gone through.
fn scanned(clock: &ClockShape, from_s: f64, to_s: f64, stamps: Stamps<'_>) -> Result<Range<u64>, RecordingError> {
    let step = clock.grain.max(STEP as u64);
    let mut found: Option<Range<u64>> = None;
    let mut first = 0;
    while first < clock.samples {
        work::checkpoint();
        let rows = first..clock.samples.min(first.saturating_add(step));
        for (row, time_s) in rows.clone().zip(stamps(rows.clone())?) {
            if time_s >= from_s && time_s <= to_s {
                found = Some(found.map_or(row, |found| found.start)..row + 1);
            }
        }
        first = rows.end;
    }
    Ok(found.unwrap_or(0..0))
}

/// Search of a clock by halves.
struct Search<'a> {
    clock: &'a ClockShape,
    stamps: Stamps<'a>,
    /// Stamps that were met, by row.
    seen: BTreeMap<u64, f64>,
}

impl Search<'_> {
    /// The first row from `begin` on of which something holds that holds for all later ones; none where stamps are out
    /// of order.
    fn first(&mut self, begin: u64, holds: &dyn Fn(f64) -> bool) -> Result<Option<u64>, RecordingError> {
        let (mut low, mut high) = (begin, self.clock.samples);
        while high - low > self.clock.grain {
            work::checkpoint();
            let middle = low.midpoint(high);
            let Some(time_s) = self.stamp(middle)? else { return Ok(None) };
            if holds(time_s) { high = middle } else { low = middle + 1 }
        }
        let rest = (self.stamps)(low..high)?;
        if !rest.is_sorted() {
            return Ok(None);
        }
        self.seen.extend([(low, rest.first()), (high.saturating_sub(1), rest.last())].iter().filter_map(note));
        Ok(Some(low + rest.partition_point(|&time_s| !holds(time_s)) as u64))
    }

    fn stamp(&mut self, row: u64) -> Result<Option<f64>, RecordingError> {
        if let Some(time_s) = self.seen.get(&row) {
            return Ok(Some(*time_s));
        }
        let time_s = (self.stamps)(row..row + 1)?.pop().filter(|time_s| !time_s.is_nan());
        self.seen.extend(time_s.map(|time_s| (row, time_s)));
        Ok(time_s)
    }

    fn is_in_order(&self) -> bool {
        self.seen.values().is_sorted()
    }
}

fn note((row, time_s): &(u64, Option<&f64>)) -> Option<(u64, f64)> {
    time_s.map(|time_s| (*row, *time_s))
}
