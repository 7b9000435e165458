//! Clocks that count milliseconds, microseconds or nanoseconds since 1970, as loggers and databases write them.
//!
//! Nothing states that unit as a rule. The numbers do: from 2001 to 2049 there are 1.0 to 2.5 · 10⁹ seconds, 10¹²
//! milliseconds, and so on, and no record in seconds is so long.

use crate::{Finding, Raster, Recording, StartTime};

/// Seconds since 1970 of 2001 and of 2049.
const SECONDS: std::ops::Range<f64> = 1.0e9..2.5e9;

/// The unit of an instant, and how many of it are a second; none of one that may be in seconds.
pub(crate) fn unit(instant: f64) -> Option<(&'static str, f64)> {
    let units = [("ms", 1e3), ("µs", 1e6), ("ns", 1e9)];
    units.into_iter().find(|(_, per_second)| SECONDS.contains(&(instant / per_second)))
}

/// The first instant of clocks of which some count from 1970.
pub(crate) struct Origin {
    /// For each clock its unit, and how many of it are a second; none where it does not count from 1970.
    clocks: Vec<Option<(&'static str, f64)>>,
    start_s: f64,
}

impl Origin {
    /// That of clocks with these first stamps that are finite; none where no clock counts from 1970.
    pub(crate) fn of(firsts: impl Iterator<Item = Option<f64>>) -> Option<Self> {
        let (mut clocks, mut start_s) = (Vec::new(), f64::INFINITY);
        for first in firsts {
            let clock = first.and_then(|first| unit(first).map(|clock| (first, clock)));
            if let Some((first, (_, per_second))) = clock {
                start_s = start_s.min(first / per_second);
            }
            clocks.push(clock.map(|(_, clock)| clock));
        }
        start_s.is_finite().then_some(Self { clocks, start_s })
    }

    /// Counts stamps of a clock from the origin, in seconds.
    pub(crate) fn count(&self, clock: usize, time_s: &mut [f64]) {
        let Some(Some((_, per_second))) = self.clocks.get(clock) else { return };
        let origin = self.start_s * per_second;
        time_s.iter_mut().for_each(|t| *t = (*t - origin) / per_second);
    }

    /// Notes the units on a recording, and its start.
    pub(crate) fn note(&self, recording: &mut Recording) {
        let mut units: Vec<&str> = self.clocks.iter().flatten().map(|(unit, _)| *unit).collect();
        units.dedup();
        let unit = units.join(", ");
        recording.findings.push(Finding::CountsSince1970 { unit });
        let nanoseconds = (self.start_s * 1e9).round() as i64;
        let start = StartTime { nanoseconds, is_local: false, utc_offset_min: None };
        recording.start_time = recording.start_time.or(Some(start));
    }
}

/// The same with clocks that count from 1970 in seconds from the first of their stamps, whose instant is the start.
pub(crate) fn counted_from_first(mut recording: Recording) -> Recording {
    let first = |raster: &Raster| raster.time_s.iter().copied().find(|t| t.is_finite());
    let Some(origin) = Origin::of(recording.rasters.iter().map(first)) else { return recording };
    for (clock, raster) in recording.rasters.iter_mut().enumerate() {
        origin.count(clock, &mut raster.time_s);
    }
    origin.note(&mut recording);
    recording
}
