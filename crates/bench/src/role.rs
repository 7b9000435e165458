//! The roles a channel can play at a bench.

use std::fmt;

use serde::{Deserialize, Serialize};

/// What a channel measures, whatever its name in the recording. Inside the crate every role is in SI: speeds in rad/s,
/// torques in Nm, throttle as a fraction of one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// N_d, measured speed of the dynamometer.
    DynoSpeed,
    /// N_e, measured speed of the engine.
    EngineSpeed,
    /// N_d*, speed demand to the dynamometer's speed controller.
    DynoSpeedDemand,
    /// T_d*, air-gap torque demand to the inverter. Positive brakes the dynamometer.
    DynoTorqueDemand,
    /// T_d,calc, air-gap torque as the inverter computes it. Positive brakes the dynamometer.
    AirGapTorque,
    /// T_d,meas, air-gap torque as the load cell reads it: late, and with dynamics of its own.
    LoadCellTorque,
    /// T_d,shaft,calc, the automation system's own, delayed, estimate of the shaft torque.
    SystemShaftTorque,
    /// T_shaft as a torque flange measures it (bench variant TB).
    FlangeTorque,
    /// α_e, engine throttle.
    Throttle,
}

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

    /// The largest magnitude that a channel of this quantity reaches at a bench, in SI; `None` for quantities that no role
    /// has.
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

impl Role {
    /// Every role, in the order people list them.
    pub const ALL: [Role; 9] = [
        Role::DynoSpeed,
        Role::EngineSpeed,
        Role::DynoSpeedDemand,
        Role::DynoTorqueDemand,
        Role::AirGapTorque,
        Role::LoadCellTorque,
        Role::SystemShaftTorque,
        Role::FlangeTorque,
        Role::Throttle,
    ];

    /// The key of the role in a bench file, e.g. `dyno_speed`.
    pub fn key(self) -> &'static str {
        match self {
            Role::DynoSpeed => "dyno_speed",
            Role::EngineSpeed => "engine_speed",
            Role::DynoSpeedDemand => "dyno_speed_demand",
            Role::DynoTorqueDemand => "dyno_torque_demand",
            Role::AirGapTorque => "air_gap_torque",
            Role::LoadCellTorque => "load_cell_torque",
            Role::SystemShaftTorque => "system_shaft_torque",
            Role::FlangeTorque => "flange_torque",
            Role::Throttle => "throttle",
        }
    }

    /// The role with this key in a bench file.
    pub fn from_key(key: &str) -> Option<Role> {
        Role::ALL.into_iter().find(|role| role.key() == key)
    }

    /// The symbol of the thesis, e.g. `N_d`.
    pub fn symbol(self) -> &'static str {
        match self {
            Role::DynoSpeed => "N_d",
            Role::EngineSpeed => "N_e",
            Role::DynoSpeedDemand => "N_d*",
            Role::DynoTorqueDemand => "T_d*",
            Role::AirGapTorque => "T_d,calc",
            Role::LoadCellTorque => "T_d,meas",
            Role::SystemShaftTorque => "T_d,shaft,calc",
            Role::FlangeTorque => "T_shaft,meas",
            Role::Throttle => "α_e",
        }
    }

    /// Whether the role may be recorded as the angle turned, of which it is the rate: the measured speeds.
    pub fn may_be_angle(self) -> bool {
        matches!(self, Role::DynoSpeed | Role::EngineSpeed)
    }

    /// The quantity the role's unit must belong to.
    pub fn quantity(self) -> Quantity {
        match self {
            Role::DynoSpeed | Role::EngineSpeed | Role::DynoSpeedDemand => Quantity::AngularSpeed,
            Role::Throttle => Quantity::Ratio,
            _ => Quantity::Torque,
        }
    }

    /// Whether the signal is computed by a controller and held until its next update, rather than measured.
    pub fn is_demand(self) -> bool {
        matches!(self, Role::DynoSpeedDemand | Role::DynoTorqueDemand)
    }
}
