//! Today's date.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use recording::StartTime;

/// Today in UTC, as in 2026-05-03.
pub fn today() -> String {
    written(SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or(Duration::ZERO).as_secs())
}

/// The day of a time, s since 1970, in UTC.
fn written(seconds: u64) -> String {
    let nanoseconds = i64::try_from(seconds).unwrap_or(i64::MAX).saturating_mul(1_000_000_000);
    StartTime { nanoseconds, is_local: false, utc_offset_min: None }.day()
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
