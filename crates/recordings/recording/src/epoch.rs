//! Clocks that count milliseconds, microseconds or nanoseconds since 1970, as loggers and databases write them.
//!
//! Nothing states that unit as a rule. The numbers do: from 2001 to 2049 there are 1.0 to 2.5 · 10⁹ seconds, 10¹²
//! milliseconds, and so on, and no record in seconds is so long.

use crate::{Finding, Recording, StartTime};

/// Seconds since 1970 of 2001 and of 2049.
const SECONDS: std::ops::Range<f64> = 1.0e9..2.5e9;

/// The unit of an instant, and how many of it are a second; none of one that may be in seconds.
pub(crate) fn unit(instant: f64) -> Option<(&'static str, f64)> {
    let units = [("ms", 1e3), ("µs", 1e6), ("ns", 1e9)];
    units.into_iter().find(|(_, per_second)| SECONDS.contains(&(instant / per_second)))
}

/// The same with clocks that count from 1970 in seconds from the first of their stamps, whose instant is the start.
pub(crate) fn counted_from_first(mut recording: Recording) -> Recording {
    let of = |time_s: &[f64]| unit(*time_s.iter().find(|t| t.is_finite())?);
    let clocks: Vec<Option<(&str, f64)>> = recording.rasters.iter().map(|raster| of(&raster.time_s)).collect();
    let firsts = recording.rasters.iter().zip(&clocks).filter_map(|(raster, clock)| {
        let first = raster.time_s.iter().find(|t| t.is_finite())?;
        clock.map(|(_, per_second)| first / per_second)
    });
    let start_s = firsts.fold(f64::INFINITY, f64::min);
    if !start_s.is_finite() {
        return recording;
    }
    for (raster, clock) in recording.rasters.iter_mut().zip(&clocks) {
        let Some((_, per_second)) = clock else { continue };
        let origin = start_s * per_second;
        raster.time_s.iter_mut().for_each(|t| *t = (*t - origin) / per_second);
    }
    let mut units: Vec<&str> = clocks.iter().flatten().map(|(unit, _)| *unit).collect();
    units.dedup();
    let unit = units.join(", ");
    recording.findings.push(Finding::CountsSince1970 { unit });
    let start = StartTime { nanoseconds: (start_s * 1e9).round() as i64, is_local: false, utc_offset_min: None };
    recording.start_time = recording.start_time.or(Some(start));
    recording
}
