//! The moment a measurement started, as a date.

use recording::StartTime;

/// The moment as `2018-05-03 14:07:09 UTC`, or on the clock it is known on.
pub(super) fn words(start: &StartTime) -> String {
    let offset_min = if start.is_local { 0 } else { start.utc_offset_min.unwrap_or(0) };
    let seconds = start.nanoseconds.div_euclid(1_000_000_000) + i64::from(offset_min) * 60;
    let second = seconds.rem_euclid(86_400);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    let clock = match (start.is_local, start.utc_offset_min) {
        (true, _) => "local time".to_owned(),
        (false, None | Some(0)) => "UTC".to_owned(),
        (false, Some(offset)) => {
            let sign = if offset < 0 { '−' } else { '+' };
            format!("UTC{sign}{:02}:{:02}", offset.abs() / 60, offset.abs() % 60)
        }
    };
    format!("{} {hour:02}:{minute:02}:{second:02} {clock}", start.day())
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
