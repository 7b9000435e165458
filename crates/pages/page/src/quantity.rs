//! Values with their uncertainty and unit.

use serde::Serialize;

use crate::number;

/// A unit as it is typed: `Nm/rad`, `ms`; empty or `1` for none.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Unit(String);

impl Unit {
    /// A unit.
    pub fn new(typed: impl Into<String>) -> Self {
        Unit(typed.into())
    }

    /// The unit as it is typed.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// Knowledge of how far a value may be from the truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Uncertainty {
    /// The truth lies between these, with the confidence that the page states.
    Interval(f64, f64),
    /// The value is exact, or was given.
    Exact,
    /// The value is as small as it can be, so that the data bound it no further.
    AtLimit,
    /// Nothing is known of it.
    Unknown,
}

/// A value with its uncertainty and unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quantity {
    /// The value.
    pub value: f64,
    /// How far it may be from the truth.
    pub uncertainty: Uncertainty,
    /// The unit of both.
    pub unit: Unit,
}

/// A quantity in pieces, all with the same unit and the digits that the uncertainty allows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Digits {
    /// The value.
    pub value: String,
    /// Half of the interval: `± 12`; where the interval is lopsided, its two arms: `+28 −12`.
    pub spread: String,
    /// The bounds of the interval, `2426 … 2450`.
    pub interval: String,
    /// Power of ten, if there is one, and unit: `Nm/rad`, `·10⁻⁵ Nm`.
    pub unit: String,
}

/// Arms of an interval that differ by more than this part of half its width are both shown.
const LOPSIDED: f64 = 0.2;
/// Significant digits of a number that is read at a glance.
const MOST_DIGITS: i32 = 4;

impl Quantity {
    /// A value between two bounds.
    pub fn within(value: f64, (low, high): (f64, f64), unit: &str) -> Self {
        Quantity { value, uncertainty: Uncertainty::Interval(low, high), unit: Unit::new(unit) }
    }

    /// A value that has no uncertainty.
    pub fn exact(value: f64, unit: &str) -> Self {
        Quantity { value, uncertainty: Uncertainty::Exact, unit: Unit::new(unit) }
    }

    /// The value with half of its interval, e.g. `2438 ± 12 Nm/rad`; with both arms where the interval is lopsided,
    /// e.g. `2438 +52 −28 Nm/rad`.
    pub fn text(&self) -> String {
        match self.digits() {
            Some(Digits { value, spread, unit, .. }) => number::with_unit(format!("{value} {spread}"), &unit),
            None if self.is_exact() => format!("{}, exact", number::measure(self.value, self.unit.as_str())),
            None if self.is_at_limit() => {
                format!("{}, the least possible", number::measure(self.value, self.unit.as_str()))
            }
            None => number::plus_minus(self.value, f64::NAN, self.unit.as_str()),
        }
    }

    /// The bounds of the interval with their unit, e.g. `2426 … 2450 Nm/rad`.
    pub fn interval(&self) -> String {
        match self.digits() {
            Some(Digits { interval, unit, .. }) => number::with_unit(interval, &unit),
            None if self.is_exact() || self.is_at_limit() => "–".to_owned(),
            None => number::NOT_KNOWN.to_owned(),
        }
    }

    /// The quantity in pieces; `None` where it or its interval is not a finite number.
    pub fn digits(&self) -> Option<Digits> {
        let Uncertainty::Interval(low, high) = self.uncertainty else { return None };
        let half_width = (high - low) / 2.0;
        if !(self.value.is_finite() && half_width.is_finite() && half_width > 0.0) {
            return None;
        }
        let scale = number::Scale::fitting(self.value.abs().max(half_width), self.unit.as_str());
        let decimals = number::decimals_for(half_width / scale.divisor);
        let digits = |value: f64| number::fixed(value / scale.divisor, decimals);
        let (below, above) = (self.value - low, high - self.value);
        let spread = match (above - below).abs() > LOPSIDED * half_width {
            true => format!("+{} −{}", digits(above), digits(below)),
            false => format!("± {}", digits(half_width)),
        };
        let interval = format!("{} … {}", digits(low), digits(high));
        Some(Digits { value: digits(self.value), spread, interval, unit: scale.suffix() })
    }

    /// The quantity in pieces for a glance: at most four significant digits, and half of the interval in per cent of
    /// the value.
    pub fn short(&self) -> Option<Digits> {
        let Uncertainty::Interval(low, high) = self.uncertainty else { return None };
        let full = self.digits()?;
        let scale = number::Scale::fitting(self.value.abs().max((high - low) / 2.0), self.unit.as_str());
        let shown = self.value / scale.divisor;
        let whole = if shown == 0.0 { 0 } else { shown.abs().log10().floor() as i32 };
        let decimals = number::decimals_for((high - low) / 2.0 / scale.divisor).min((MOST_DIGITS - 1 - whole).max(0));
        let digits = |value: f64| number::fixed(value / scale.divisor, decimals);
        let percent = |width: f64| number::significant(100.0 * width / self.value.abs(), 2);
        let (below, above) = (self.value - low, high - self.value);
        let spread = match (above - below).abs() > LOPSIDED * (high - low) / 2.0 {
            _ if self.value == 0.0 => full.spread,
            true => format!("+{} −{} %", percent(above), percent(below)),
            false => format!("± {} %", percent((high - low) / 2.0)),
        };
        let interval = format!("{} … {}", digits(low), digits(high));
        Some(Digits { value: digits(self.value), spread, interval, unit: full.unit })
    }

    fn is_exact(&self) -> bool {
        self.value.is_finite() && self.uncertainty == Uncertainty::Exact
    }

    fn is_at_limit(&self) -> bool {
        self.value.is_finite() && self.uncertainty == Uncertainty::AtLimit
    }
}
