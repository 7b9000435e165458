//! Physical quantities.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A physical quantity. The unit of a role's channel must be one of the role's quantity; the others are known so that a
/// channel of theirs is not taken for one with an unknown unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Angular speed, SI unit rad/s.
    AngularSpeed,
    /// Torque, SI unit Nm.
    Torque,
    /// A dimensionless ratio, SI unit 1.
    Ratio,
    /// Moment of inertia, SI unit kg m².
    Inertia,
    /// Torsional stiffness, SI unit Nm/rad.
    Stiffness,
    /// Torsional damping, SI unit Nm s/rad.
    Damping,
    /// Angle, SI unit rad.
    Angle,
    /// Angular acceleration, SI unit rad/s².
    AngularAcceleration,
    /// Change of torque in time, SI unit Nm/s.
    TorqueRate,
    /// Time, SI unit s.
    Time,
    /// Power, SI unit W.
    Power,
    /// Temperature, SI unit K.
    Temperature,
    /// Pressure, SI unit Pa.
    Pressure,
    /// Force, SI unit N.
    Force,
    /// Electric current, SI unit A.
    Current,
    /// Electric voltage, SI unit V.
    Voltage,
    /// Mass flow, SI unit kg/s.
    MassFlow,
    /// Length, SI unit m.
    Length,
    /// Speed along a line, SI unit m/s.
    Speed,
}

impl Quantity {
    /// Every quantity.
    pub const ALL: [Quantity; 19] = [
        Quantity::AngularSpeed,
        Quantity::Torque,
        Quantity::Ratio,
        Quantity::Inertia,
        Quantity::Stiffness,
        Quantity::Damping,
        Quantity::Angle,
        Quantity::AngularAcceleration,
        Quantity::TorqueRate,
        Quantity::Time,
        Quantity::Power,
        Quantity::Temperature,
        Quantity::Pressure,
        Quantity::Force,
        Quantity::Current,
        Quantity::Voltage,
        Quantity::MassFlow,
        Quantity::Length,
        Quantity::Speed,
    ];

    /// The largest magnitude that a channel of this quantity reaches at a bench, in SI; `None` for quantities that no
    /// role has.
    pub fn largest_at_a_bench(self) -> Option<f64> {
        match self {
            Quantity::AngularSpeed => Some(3000.0),
            Quantity::Torque => Some(20_000.0),
            Quantity::Ratio => Some(1.5),
            _ => None,
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Quantity::AngularSpeed => "speed",
            Quantity::Torque => "torque",
            Quantity::Ratio => "ratio",
            Quantity::Inertia => "inertia",
            Quantity::Stiffness => "stiffness",
            Quantity::Damping => "damping",
            Quantity::Angle => "angle",
            Quantity::AngularAcceleration => "angular acceleration",
            Quantity::TorqueRate => "torque slew",
            Quantity::Time => "time",
            Quantity::Power => "power",
            Quantity::Temperature => "temperature",
            Quantity::Pressure => "pressure",
            Quantity::Force => "force",
            Quantity::Current => "current",
            Quantity::Voltage => "voltage",
            Quantity::MassFlow => "mass flow",
            Quantity::Length => "length",
            Quantity::Speed => "speed of travel",
        })
    }
}
