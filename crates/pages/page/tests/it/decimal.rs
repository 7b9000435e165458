//! Numbers that can be copied into other programs.

use page::decimal::{coefficients, digits, percent, probability, range, scientific, significant, with_range};

#[test]
fn exact_digits_are_those_that_say_something() {
    assert_eq!(significant(2.5), "2.5");
    assert_eq!(significant(-0.000_123_456_78), "-0.000123457");
    assert_eq!(digits(12_345.6, 3), "12346");
    assert_eq!(digits(1.25e-5, 3), "1.25e-5");
    assert_eq!(scientific(123_456.0, 1), "1.2e5");
    assert_eq!(coefficients(&[1.0, 1e-17, -0.5]), "1, 0, -0.5");
}

#[test]
fn exact_shares_and_probabilities() {
    assert_eq!(
        (percent(97.456), percent(f64::NAN), percent(-2.5e7)),
        ("97.46 %".into(), "–".into(), "-2.5e7 %".into())
    );
    assert_eq!((probability(0.0004), probability(0.25)), ("p < 0.001".into(), "p = 0.250".into()));
}

#[test]
fn exact_intervals_have_two_digits_of_their_width() {
    assert_eq!(range(Some((0.9912, 0.9968))), "0.9912 … 0.9968");
    assert_eq!(range(Some((f64::NEG_INFINITY, 2.0))), "below 2");
    assert_eq!(range(None), "");
    assert_eq!(with_range(8.0123, "Hz", Some((7.9, 8.1))), "8.012 Hz (7.90 … 8.10)");
}
