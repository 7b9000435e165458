//! Tables of estimates.

use page::decimal::significant;
use page::{Align, Cell, Table};

use crate::blocks::name;

/// Confidence of the intervals shown.
pub(super) const INTERVAL: f64 = 0.95;

/// A table of estimates of what the first heading says.
pub(super) fn estimates(what: &str) -> Table {
    Table::new(&[
        (what, Align::Left),
        ("value", Align::Right),
        ("± (standard error)", Align::Right),
        ("95 % interval", Align::Left),
    ])
}

/// How well a value is known.
pub(super) enum Known {
    /// It was not estimated.
    Fixed,
    /// It ended at a bound, so the data do not show how well.
    AtBound,
    /// Standard error and interval.
    Within(f64, (f64, f64)),
}

/// A row of it.
pub(super) fn estimate(of: &str, value: f64, known: &Known) -> [Cell; 4] {
    let (error, interval) = match known {
        Known::Fixed => ("fixed".to_owned(), String::new()),
        Known::AtBound => ("at its bound".to_owned(), String::new()),
        Known::Within(error, (low, high)) => {
            (significant(*error), format!("{} … {}", significant(*low), significant(*high)))
        }
    };
    [name(of), significant(value).into(), error.into(), interval.into()]
}
