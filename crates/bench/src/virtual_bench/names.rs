//! A virtual bench's channels under the names that a bench file gives them.

use std::collections::BTreeMap;

use recording::Recording;

use crate::bench_file::ChannelMapping;
use crate::role::Role;
use crate::units::parse_unit;

/// What the channels of a virtual bench are called.
pub const CHANNELS: [(Role, &str); 9] = [
    (Role::DynoSpeed, "DynoSpeed"),
    (Role::EngineSpeed, "EngineSpeed"),
    (Role::DynoSpeedDemand, "DynoSpeedDemand"),
    (Role::DynoTorqueDemand, "DynoTorqueDemand"),
    (Role::AirGapTorque, "DynoTorqueCalc"),
    (Role::LoadCellTorque, "DynoTorqueMeas"),
    (Role::SystemShaftTorque, "ShaftTorqueCalc"),
    (Role::FlangeTorque, "FlangeTorque"),
    (Role::Throttle, "Throttle"),
];

/// Gives the channels of a virtual bench the names that a bench file states, and the units and signs that it says they are
/// recorded in, so that it reads them as those of the bench. A channel whose role is not stated keeps its name, unless a
/// stated one has it: then it is called after its role.
pub fn rename(recording: &mut Recording, stated: &BTreeMap<Role, ChannelMapping>) {
    let is_taken = |name: &str| stated.values().any(|mapping| mapping.name == name);
    for channel in &mut recording.channels {
        let role = CHANNELS.iter().find(|(_, name)| *name == channel.name).map(|(role, _)| *role);
        let Some(mapping) = role.and_then(|role| stated.get(&role)) else {
            if is_taken(&channel.name) {
                channel.name = format!("virtual_{}", role.map_or("shaft_torque_demand", Role::key));
            }
            continue;
        };
        mapping.name.clone_into(&mut channel.name);
        if let (Some(unit), Ok(own)) = (mapping.unit, parse_unit(&channel.unit))
            && unit != own
        {
            channel.samples.iter_mut().for_each(|value| *value = unit.from_si(own.to_si(*value)));
            unit.spelling.clone_into(&mut channel.unit);
        }
        if mapping.inverted {
            channel.samples.iter_mut().for_each(|value| *value = -*value);
        }
    }
}
