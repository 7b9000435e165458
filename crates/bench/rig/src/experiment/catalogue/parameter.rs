//! Parameters of experiments.

use std::ops::RangeInclusive;

use serde::Serialize;

/// A number that an experiment can be given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Parameter {
    /// Name on the command line.
    pub name: &'static str,
    /// Its unit; empty for counts.
    pub unit: &'static str,
    /// Value unless given.
    pub default: f64,
    /// Smallest value.
    pub lowest: f64,
    /// Largest value.
    pub highest: f64,
    /// Effect of the parameter.
    pub meaning: &'static str,
}

pub(super) const SPEED: Parameter =
    parameter("speed", "rpm", 1200.0, SPEED_RPM, "speed demanded, or the one from which it changes");

pub(super) const DURATION: Parameter = parameter("duration", "s", 60.0, 0.01..=10_000.0, "length of the recording");

pub(super) const SETTLING: Parameter =
    parameter("settling", "s", 2.0, 0.0..=1000.0, "time at the first demands before the recording starts");

/// One with its default, and the values that are allowed.
pub const fn parameter(
    name: &'static str,
    unit: &'static str,
    default: f64,
    allowed: RangeInclusive<f64>,
    meaning: &'static str,
) -> Parameter {
    Parameter { name, unit, default, lowest: *allowed.start(), highest: *allowed.end(), meaning }
}

/// Torques that a parameter may have, Nm.
pub(super) const TORQUE_NM: RangeInclusive<f64> = -20_000.0..=20_000.0;

/// Times that a parameter may have, s.
pub(super) const TIME_S: RangeInclusive<f64> = 0.01..=1000.0;

/// Speeds that a parameter may have, rpm.
pub(super) const SPEED_RPM: RangeInclusive<f64> = -20_000.0..=20_000.0;
