//! Time stamps that are written as dates and clock times.

use jiff::civil::Date;

use crate::CsvProblem;

const SECOND: i64 = 1_000_000_000;
pub(super) const DAY: i64 = 86_400 * SECOND;

/// Content of a time stamp beside the time of day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Frame {
    /// Nothing: the day is not known.
    Clock,
    /// The date on the local clock.
    Local,
    /// The date and how far the clock is ahead of UTC.
    Zoned,
}

/// A time stamp.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stamp {
    /// Since midnight, or since 1970-01-01 00:00: in UTC where the zone is known, else on the local clock.
    pub(super) nanoseconds: i64,
    pub(super) frame: Frame,
    /// Minutes by which the clock is ahead of UTC.
    pub(super) offset_min: Option<i32>,
    /// True if the fraction of the second follows a comma.
    pub(super) is_comma: bool,
}

impl Stamp {
    /// Reads `12:34:56.789`, `2026-11-21T12:34:56.789+01:00`, `21.11.2026 12:34:56,789` and the like; `None` where the
    /// cell is nothing of this kind.
    pub(super) fn read(cell: &str) -> Result<Option<Self>, CsvProblem> {
        if !cell.as_bytes().first().is_some_and(u8::is_ascii_digit) {
            return Ok(None);
        }
        let parts = cell.split_once([' ', 'T']).and_then(|(date, clock)| Some((day(date)?, clock.trim())));
        match parts {
            Some((day, clock)) => Self::dated(day, clock, cell),
            None => match day(cell) {
                Some(day) => Self::dated(day, "0:00", cell),
                None => Ok(clock_time(cell, false).map(|time| Self::at(time, Frame::Clock, None))),
            },
        }
    }

    /// Reads a date in one cell and a time of day in another.
    pub(super) fn read_pair(date: &str, clock: &str) -> Result<Option<Self>, CsvProblem> {
        day(date).map_or(Ok(None), |day| Self::dated(day, clock, date))
    }

    fn at(time: ClockTime, frame: Frame, offset_min: Option<i32>) -> Self {
        Self { nanoseconds: time.nanoseconds, frame, offset_min, is_comma: time.is_comma }
    }

    fn dated(day: Day, clock: &str, cell: &str) -> Result<Option<Self>, CsvProblem> {
        let (clock, offset_min) = split_zone(clock);
        let Some(time) = clock_time(clock, true) else { return Ok(None) };
        let Day::Known(day) = day else { return Err(CsvProblem::AmbiguousDate { text: cell.into() }) };
        let frame = if offset_min.is_some() { Frame::Zoned } else { Frame::Local };
        let start = day.checked_mul(DAY).and_then(|start| start.checked_add(time.nanoseconds));
        let utc = start.and_then(|start| start.checked_sub(i64::from(offset_min.unwrap_or(0)) * 60 * SECOND));
        Ok(utc.map(|nanoseconds| Self::at(ClockTime { nanoseconds, ..time }, frame, offset_min)))
    }
}

/// A date.
enum Day {
    /// Days since 1970-01-01.
    Known(i64),
    /// Which number is the day is unknown.
    Ambiguous,
}

/// `2026-11-21`, `2026/11/21`, `21.11.2026`, and `21/11/2026` or `11/21/2026` where the numbers show which is meant.
fn day(text: &str) -> Option<Day> {
    let sign = text.chars().find(|c| !c.is_ascii_digit()).filter(|c| matches!(c, '-' | '/' | '.'))?;
    let mut parts = text.split(sign);
    let parts = [parts.next()?, parts.next()?, parts.next()?, parts.next().unwrap_or_default()];
    let number = |i: usize| parts[i].bytes().all(|b| b.is_ascii_digit()).then(|| parts[i].parse::<i64>().ok())?;
    let lengths = [parts[0].len(), parts[1].len(), parts[2].len()];
    let (a, b, c) = (number(0)?, number(1)?, number(2)?);
    match (lengths, sign) {
        _ if !parts[3].is_empty() => None,
        ([4, 1..=2, 1..=2], _) => date(a, b, c).map(Day::Known),
        ([1..=2, 1..=2, 4], '.') => date(c, b, a).map(Day::Known),
        ([1..=2, 1..=2, 4], _) => match (date(c, b, a), date(c, a, b)) {
            (Some(day), Some(other)) if day == other => Some(Day::Known(day)),
            (Some(_), Some(_)) => Some(Day::Ambiguous),
            (day, other) => day.or(other).map(Day::Known),
        },
        _ => None,
    }
}

/// Days since 1970-01-01 of a date of the Gregorian calendar.
fn date(year: i64, month: i64, day: i64) -> Option<i64> {
    let date = Date::new(year.try_into().ok()?, month.try_into().ok()?, day.try_into().ok()?).ok()?;
    Some(date.duration_since(Date::constant(1970, 1, 1)).as_hours() / 24)
}

/// Takes the zone off: `Z`, `UTC`, `+01:00`, `+0100`, `-05`. In minutes ahead of UTC.
fn split_zone(clock: &str) -> (&str, Option<i32>) {
    for utc in ["Z", "z", "UTC", "GMT"] {
        if let Some(clock) = clock.strip_suffix(utc) {
            return (clock.trim_end(), Some(0));
        }
    }
    let Some(at) = clock.rfind(['+', '-']) else { return (clock, None) };
    let digits = clock[at + 1..].replace(':', "");
    let is_zone = matches!(digits.len(), 2 | 4) && digits.bytes().all(|b| b.is_ascii_digit());
    let number = |range: std::ops::Range<usize>| digits.get(range).and_then(|d| d.parse::<i32>().ok());
    match number(0..2).filter(|_| is_zone) {
        None => (clock, None),
        Some(hours) => {
            let minutes = hours * 60 + number(2..4).unwrap_or(0);
            (clock[..at].trim_end(), Some(if clock[at..].starts_with('-') { -minutes } else { minutes }))
        }
    }
}

#[derive(Clone, Copy)]
struct ClockTime {
    nanoseconds: i64,
    is_comma: bool,
}

/// `h:mm:ss`, with a fraction or without, and `AM` or `PM`; beside a date also `h:mm`.
fn clock_time(text: &str, has_date: bool) -> Option<ClockTime> {
    let upper = text.to_ascii_uppercase();
    let half = ["AM", "PM"].into_iter().find(|half| upper.ends_with(half));
    let text = if half.is_some() { text[..text.len() - 2].trim_end() } else { text };
    let mut parts = text.split(':');
    let (hours, minutes) = (digits(parts.next()?)?, digits(parts.next()?)?);
    let seconds = parts.next();
    if parts.next().is_some() || (seconds.is_none() && !has_date) {
        return None;
    }
    let (whole, fraction) = match seconds.unwrap_or("0").split_once(['.', ',']) {
        Some((whole, fraction)) => (digits(whole)?, nanoseconds(fraction)?),
        None => (digits(seconds.unwrap_or("0"))?, 0),
    };
    let most = if has_date || half.is_some() { 24 } else { 100_000 };
    let hours = match (half, hours) {
        (None, hours) => hours,
        (Some(half), 1..=12) => hours % 12 + if half == "PM" { 12 } else { 0 },
        _ => return None,
    };
    let is_comma = seconds.is_some_and(|s| s.contains(','));
    let valid = hours < most && minutes < 60 && whole <= 60;
    valid.then_some(ClockTime { nanoseconds: ((hours * 60 + minutes) * 60 + whole) * SECOND + fraction, is_comma })
}

fn digits(text: &str) -> Option<i64> {
    let valid = (1..=6).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit());
    if valid { text.parse().ok() } else { None }
}

/// A fraction of a second; digits beyond nanoseconds are dropped.
fn nanoseconds(fraction: &str) -> Option<i64> {
    let valid = !fraction.is_empty() && fraction.bytes().all(|b| b.is_ascii_digit());
    let kept = fraction.get(..fraction.len().min(9)).filter(|_| valid)?;
    Some(kept.parse::<i64>().ok()? * 10_i64.pow(9 - kept.len() as u32))
}
