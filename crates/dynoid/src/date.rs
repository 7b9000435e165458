//! Today's date.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

const SECONDS_A_DAY: u64 = 86_400;

/// Today in UTC, as in 2026-05-03.
pub(crate) fn today() -> String {
    written(SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or(Duration::ZERO).as_secs())
}

/// The day of a time, s since 1970, in the Gregorian calendar.
fn written(seconds: u64) -> String {
    let is_leap = |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let (mut year, mut day) = (1970, seconds / SECONDS_A_DAY);
    while day >= 365 + u64::from(is_leap(year)) {
        day -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let lengths = [31, 28 + u64::from(is_leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 1;
    for length in lengths {
        if day < length {
            break;
        }
        day -= length;
        month += 1;
    }
    format!("{year}-{month:02}-{:02}", day + 1)
}

#[cfg(test)]
mod tests {
    use super::written;

    #[test]
    fn exact_days_of_the_calendar() {
        assert_eq!(written(0), "1970-01-01");
        assert_eq!(written(951_782_399), "2000-02-28");
        assert_eq!(written(951_782_400), "2000-02-29");
        assert_eq!(written(1_767_225_599), "2025-12-31");
        assert_eq!(written(4_107_542_400), "2100-03-01");
    }
}
