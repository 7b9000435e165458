//! Numbers on the command line: bare in the unit of the option, or with a unit of their own.

use std::ops::RangeInclusive;

use units::{Quantity, RPM_RAD_S, UnitError, parse_value};

/// Benches that an answer rests on: of 72 that all keep everything, the 95 % interval of the share begins at 95 %.
const BENCHES: RangeInclusive<u32> = 72..=100_000;

/// A number that is finite.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    let number: Result<f64, _> = text.trim().parse();
    number.ok().filter(|number| number.is_finite()).ok_or_else(|| "give a number, such as 1.5".to_owned())
}

/// A number above zero.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|number| *number > 0.0).ok_or_else(|| "give a number above 0".to_owned())
}

/// A share of a whole.
pub(super) fn share(text: &str) -> Result<f64, String> {
    let inside = |number: &f64| *number > 0.0 && *number < 1.0;
    let number = match text.trim().strip_suffix('%') {
        Some(percent) => finite(percent).map(|percent| percent / 100.0),
        None => finite(text),
    };
    number.ok().filter(inside).ok_or_else(|| "give a share between 0 and 1, such as 0.5".to_owned())
}

/// A count, or a number of samples.
pub(super) fn count(text: &str) -> Result<usize, String> {
    text.trim().parse().map_err(|_| "give a whole number, 0 or above".to_owned())
}

/// The seed of a random sequence.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| format!("give a whole number from 0 to {}", u64::MAX))
}

/// How many benches an answer rests on.
pub(super) fn benches(text: &str) -> Result<u32, String> {
    let number = text.trim().parse().ok().filter(|number| BENCHES.contains(number));
    number.ok_or_else(|| {
        format!(
            "give a whole number from {} to {}; with fewer benches, even all of them do not show that 95 % would keep everything",
            BENCHES.start(),
            BENCHES.end()
        )
    })
}

/// A time, s.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    measure(text, Quantity::Time, 1.0)
}

/// A time above zero, s.
pub(super) fn positive_seconds(text: &str) -> Result<f64, String> {
    above_zero(seconds(text)?)
}

/// A time that is zero or above, s.
pub(super) fn seconds_from_zero(text: &str) -> Result<f64, String> {
    Some(seconds(text)?).filter(|number| *number >= 0.0).ok_or_else(|| "give a time that is 0 or above".to_owned())
}

/// A speed, rpm.
pub(super) fn rpm(text: &str) -> Result<f64, String> {
    measure(text, Quantity::AngularSpeed, RPM_RAD_S)
}

/// A speed above zero, rpm.
pub(super) fn positive_rpm(text: &str) -> Result<f64, String> {
    above_zero(rpm(text)?)
}

/// A torque above zero, Nm.
pub(super) fn positive_nm(text: &str) -> Result<f64, String> {
    above_zero(measure(text, Quantity::Torque, 1.0)?)
}

/// A number of per cent above zero.
pub(super) fn percent(text: &str) -> Result<f64, String> {
    positive(text.trim().trim_end_matches('%'))
}

/// A frequency above zero, Hz.
pub(super) fn positive_hertz(text: &str) -> Result<f64, String> {
    let units = [("mHz", 1e-3), ("kHz", 1e3), ("MHz", 1e6), ("Hz", 1.0)];
    let text = text.trim();
    let with_unit = units.iter().find_map(|(unit, factor)| Some((text.strip_suffix(unit)?, factor)));
    above_zero(with_unit.map_or_else(|| finite(text), |(number, factor)| Ok(finite(number)? * factor))?)
}

/// A bare number in the unit of the option, which is so many SI units, or a number with a unit.
fn measure(text: &str, quantity: Quantity, unit_si: f64) -> Result<f64, String> {
    match finite(text) {
        Ok(number) => Ok(number),
        Err(why) if !text.contains(char::is_alphabetic) => Err(why),
        Err(why) => match parse_value(text, quantity) {
            Err(UnitError::NotANumber { .. }) => Err(why),
            value => value.map(|si| si / unit_si).map_err(|error| error.to_string()),
        },
    }
}

fn above_zero(number: f64) -> Result<f64, String> {
    Some(number).filter(|number| *number > 0.0).ok_or_else(|| "give a number above 0".to_owned())
}

#[cfg(test)]
mod tests {
    use super::{percent, positive_hertz, positive_nm, positive_seconds, rpm, seconds, share};

    #[test]
    fn exact_bare_numbers_are_in_the_unit_of_the_option_and_others_are_converted() {
        let close = |found: Result<f64, String>, wanted: f64| {
            let found = found.unwrap();
            assert!((found - wanted).abs() < 1e-9 * wanted.abs(), "{found} for {wanted}");
        };
        close(rpm("1500"), 1500.0);
        close(rpm("1500rpm"), 1500.0);
        close(rpm("1500 1/min"), 1500.0);
        close(rpm("100 rad/s"), 3000.0 / std::f64::consts::PI);
        close(positive_seconds("250ms"), 0.25);
        close(positive_seconds("2 min"), 120.0);
        close(seconds("-3"), -3.0);
        close(positive_nm("0.4 kNm"), 400.0);
        close(positive_hertz("2kHz"), 2000.0);
        close(positive_hertz("0.5"), 0.5);
        close(percent("5 %"), 5.0);
        close(share("95%"), 0.95);
    }

    #[test]
    fn regress_units_of_something_else_are_refused_and_named() {
        let refused = rpm("20 Nm").unwrap_err();
        assert!(refused.contains("Nm") && refused.contains("speed"), "{refused}");
        assert!(rpm("fast").is_err() && positive_seconds("0s").is_err() && positive_hertz("3 rpm").is_err());
    }
}
