//! Counts of values and of pairs.

use signal::SignalError;
use signal::excitation::Random;
use signal::histogram::{Cells, Histogram};

#[test]
fn exact_each_value_is_in_its_bin() {
    let mut histogram = Histogram::over(-1.0..=1.0, 4).unwrap();
    histogram.add(&[-1.0, -0.5, -0.4, 0.0, 0.49]);
    histogram.add(&[1.0, f64::NAN, 1.1, -1.1, f64::INFINITY]);
    assert_eq!((histogram.low(), histogram.width(), histogram.counts()), (-1.0, 0.5, &[1, 2, 2, 1][..]));
}

#[test]
fn exact_equal_values_are_in_the_middle() {
    let mut histogram = Histogram::over(3.0..=3.0, 3).unwrap();
    histogram.add(&[3.0, 3.0]);
    assert_eq!((histogram.low(), histogram.counts()), (1.5, &[0, 2, 0][..]));
    assert_eq!(histogram.quantile(0.5), Some(3.0));
    assert!(Histogram::over(0.0..=f64::INFINITY, 3).is_err() && Histogram::over(1.0..=0.0, 3).is_err());
}

/// Of n standard normal values the quartiles are 1.349 apart, and the part beyond one deviation is 0.3173.
#[test]
fn stat_normal_values_have_their_width_and_shares() {
    let mut random = Random::new(4);
    let values: Vec<f64> = (0..100_000).map(|_| random.normal()).collect();
    let mut fine = Histogram::fine(-5.0..=5.0).unwrap();
    values.chunks(999).for_each(|some| fine.add(some));
    let joined = fine.joined();
    let wanted = 2.0 * 1.349 / 100_000_f64.cbrt();
    assert!((joined.width() / wanted - 1.0).abs() < 0.03, "{}", joined.width());
    assert_eq!(joined.counts().iter().sum::<u64>(), fine.counts().iter().sum::<u64>());
    let middle = |k: usize| joined.low() + (k as f64 + 0.5) * joined.width();
    let within: u64 = joined.counts().iter().enumerate().filter(|(k, _)| middle(*k).abs() < 1.0).map(|(_, c)| c).sum();
    assert!((within as f64 / 1e5 - 0.6827).abs() < 0.02, "{within}");
}

#[test]
fn exact_each_pair_is_in_its_cell() {
    let cells = Cells::of(&[0.0, 1.0, 1.0, f64::NAN, 0.4], &[0.0, 8.0, 7.0, 1.0, f64::NAN], 2, 4).unwrap();
    assert_eq!(cells.counts, [[1, 0, 0, 0], [0, 0, 0, 2]]);
    assert_eq!((cells.along_x(), cells.along_y()), ([0.0, 0.5], [0.0, 2.0]));
    assert_eq!(Cells::of(&[f64::NAN], &[1.0], 2, 2), Err(SignalError::TooShort { needed: 1, got: 0 }));
}
