//! Numbers of a study as engineers write them.

use page::{Quantity, Uncertainty, Unit};
use rig::results::WrittenParameter;
use signal::proportion::Proportion;

pub use page::number::*;

/// An estimated number with its interval and unit.
pub fn quantity(parameter: impl Into<WrittenParameter>) -> Quantity {
    let parameter = parameter.into();
    let (low, high) = parameter.interval;
    let is_exact = parameter.value.is_finite() && parameter.standard_error == 0.0 && low == high;
    let uncertainty = match is_exact {
        // A search that wants to go below zero ends there.
        true if parameter.value == 0.0 => Uncertainty::AtLimit,
        true => Uncertainty::Exact,
        false => Uncertainty::Interval(low, high),
    };
    Quantity { value: parameter.value, uncertainty, unit: Unit::new(parameter.notation.unit) }
}

/// The estimate with half of its 95 % interval, e.g. `2438 ± 12 Nm/rad`; with both arms where the interval is lopsided,
/// e.g. `2438 +52 −28 Nm/rad`.
pub fn parameter(parameter: impl Into<WrittenParameter>) -> String {
    quantity(parameter).text()
}

/// The bounds of the 95 % interval with their unit, e.g. `2426 … 2450 Nm/rad`.
pub fn interval(parameter: impl Into<WrittenParameter>) -> String {
    quantity(parameter).interval()
}

/// A share with its 95 % interval, e.g. `94 % (89 … 97 %)`.
pub fn proportion(of: &Proportion) -> String {
    share_within(of.estimate, (of.lower, of.upper))
}

/// A number with its unit, to four digits; one that grows on unstable benches may be infinite.
pub fn bounded(value: f64, unit: &str) -> String {
    if value.is_infinite() { "without bound".to_owned() } else { format!("{} {unit}", significant(value, 4)) }
}
