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

/// A row of it; without an uncertainty the value is fixed.
pub(super) fn estimate(of: &str, value: f64, uncertainty: Option<(f64, (f64, f64))>) -> [Cell; 4] {
    let (error, interval) = match uncertainty {
        None => ("fixed".to_owned(), String::new()),
        Some((error, (low, high))) => (significant(error), format!("{} … {}", significant(low), significant(high))),
    };
    [name(of), significant(value).into(), error.into(), interval.into()]
}
