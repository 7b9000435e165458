//! The roles a channel can play at a bench.

use serde::{Deserialize, Serialize};
use units::{Quantity, Unit, UnitError, parse_unit, parse_unit_of};

/// Quantity that a channel measures, whatever its name in the recording. Inside the crate every role is in SI: speeds
/// in rad/s, torques in Nm, throttle as a fraction of one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// N_d, measured speed of the dynamometer.
    DynoSpeed,
    /// N_e, measured speed of the engine.
    EngineSpeed,
    /// N_d*, speed demand to the dynamometer's speed controller.
    DynoSpeedDemand,
    /// T_d*, air-gap torque demand to the drive. Positive brakes the dynamometer.
    DynoTorqueDemand,
    /// T_d,calc, air-gap torque as the drive computes it. Positive brakes the dynamometer.
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

    /// Torques at the dynamometer, measured or computed, in the same order.
    pub const TORQUES: [Role; 4] =
        [Role::AirGapTorque, Role::LoadCellTorque, Role::SystemShaftTorque, Role::FlangeTorque];

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

    /// Tells whether the role may be recorded as the angle turned, of which it is the rate: the measured speeds.
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

    /// Tells whether the signal is computed by a controller and held until its next update, rather than measured.
    pub fn is_demand(self) -> bool {
        matches!(self, Role::DynoSpeedDemand | Role::DynoTorqueDemand)
    }
}

/// Finds the unit of a role's channel: one of the role's quantity, or for a measured speed one of the angle turned.
///
/// # Errors
///
/// [`UnitError`] as [`parse_unit_of`].
pub fn parse_unit_of_role(text: &str, role: Role) -> Result<Unit, UnitError> {
    let turned = |unit: &Unit| role.may_be_angle() && unit.quantity == Quantity::Angle;
    parse_unit(text).ok().filter(turned).map_or_else(|| parse_unit_of(text, role.quantity()), Ok)
}
