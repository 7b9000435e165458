//! Clocks without a unit whose numbers can hardly be seconds.

use crate::{Finding, epoch};

/// Steps of whole numbers from which on they are hardly seconds: of milliseconds, of microseconds and of nanoseconds.
const MILLISECONDS: f64 = 2.0;
const MICROSECONDS: f64 = 2e3;
const NANOSECONDS: f64 = 2e6;

/// Days since 1899-12-30 of 1982 and of 2064, as spreadsheets count, and those since the year zero, as MATLAB does.
const SPREADSHEET: std::ops::Range<f64> = 3.0e4..6.0e4;
const MATLAB: std::ops::Range<f64> = 7.24e5..7.54e5;
/// Days rise by less from sample to sample, which is a quarter of an hour.
const DAYS: f64 = 0.01;
/// A part of the first stamp below which a step is rounding.
const ROUNDING: f64 = 1e-12;

/// Finding on a clock that no unit is stated for.
pub(crate) fn finding(clock: &str, time_s: &[f64]) -> Option<Finding> {
    let likely = likely_unit(time_s)?.to_owned();
    Some(Finding::DoubtfulSeconds { clock: clock.to_owned(), likely })
}

/// The unit that the numbers suggest; none where they may be seconds.
fn likely_unit(time_s: &[f64]) -> Option<&'static str> {
    let first = *time_s.first()?;
    // Those that count from 1970 say so themselves.
    if epoch::unit(first).is_some() {
        return None;
    }
    let mut steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    if steps.is_empty() {
        return None;
    }
    let middle = steps.len() / 2;
    let step = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    if step < DAYS {
        let is_finer = step > ROUNDING * first;
        return match first {
            first if SPREADSHEET.contains(&first) && is_finer => Some("days, as spreadsheets count"),
            first if MATLAB.contains(&first) && is_finer => Some("days, as MATLAB counts"),
            _ => None,
        };
    }
    let are_whole = time_s.iter().all(|t| t.fract() == 0.0);
    let units = [(NANOSECONDS, "ns"), (MICROSECONDS, "us"), (MILLISECONDS, "ms")];
    units.into_iter().find(|(least, _)| are_whole && step >= *least).map(|(_, unit)| unit)
}
