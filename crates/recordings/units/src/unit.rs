//! A unit of a known quantity.

use std::f64::consts::TAU;

use super::quantity::Quantity;

/// One revolution a minute in rad/s, 2π/60.
pub const RPM_RAD_S: f64 = TAU / 60.0;

/// A unit of a known quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Quantity that it measures.
    pub quantity: Quantity,
    /// SI value of one of it: value in SI = factor · value in the unit + offset.
    pub factor: f64,
    /// SI value of the unit's zero: other than zero for °C and °F only.
    pub offset: f64,
    /// Its usual spelling, e.g. `kg m²`.
    pub spelling: &'static str,
}

impl Unit {
    /// A value in this unit, converted to SI.
    pub fn to_si(self, value: f64) -> f64 {
        value * self.factor + self.offset
    }

    /// An SI value, converted to this unit.
    pub fn from_si(self, value: f64) -> f64 {
        (value - self.offset) / self.factor
    }
}
