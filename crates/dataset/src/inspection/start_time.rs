//! The moment a measurement started, as a date.

use recording::StartTime;

/// The moment as `2018-05-03 14:07:09 UTC`, or on the clock it is known on.
pub(super) fn words(start: &StartTime) -> String {
    let offset_min = if start.is_local { 0 } else { start.utc_offset_min.unwrap_or(0) };
    let seconds = start.nanoseconds.div_euclid(1_000_000_000) + i64::from(offset_min) * 60;
    let (days, second) = (seconds.div_euclid(86_400), seconds.rem_euclid(86_400));
    let (year, month, day) = civil(days);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    let clock = match (start.is_local, start.utc_offset_min) {
        (true, _) => "local time".to_owned(),
        (false, None | Some(0)) => "UTC".to_owned(),
        (false, Some(offset)) => {
            let sign = if offset < 0 { '−' } else { '+' };
            format!("UTC{sign}{:02}:{:02}", offset.abs() / 60, offset.abs() % 60)
        }
    };
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} {clock}")
}

/// Year, month and day of a day counted from 1970-01-01 in the Gregorian calendar (H. Hinnant, "chrono-compatible
/// low-level date algorithms", 2013: the year is taken to begin in March, so that the leap day is its last).
fn civil(days: i64) -> (i64, i64, i64) {
    let shifted = days + 719_468;
    let era = shifted.div_euclid(146_097);
    let day_of_era = shifted.rem_euclid(146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    (year_of_era + era * 400 + i64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_known_moments() {
        let at = |seconds: i64, is_local, utc_offset_min| {
            words(&StartTime { nanoseconds: seconds * 1_000_000_000, is_local, utc_offset_min })
        };
        assert_eq!(at(0, false, None), "1970-01-01 00:00:00 UTC");
        assert_eq!(at(951_782_400, true, None), "2000-02-29 00:00:00 local time");
        assert_eq!(at(1_525_349_229, false, Some(120)), "2018-05-03 14:07:09 UTC+02:00");
        assert_eq!(at(-1, false, Some(0)), "1969-12-31 23:59:59 UTC");
    }
}
