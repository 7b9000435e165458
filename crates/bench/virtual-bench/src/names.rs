//! A virtual bench's channels under the names that a bench file gives them.

use std::collections::BTreeMap;

use recording::Recording;
use rig::bench_file::ChannelMapping;
use rig::role::Role;
use units::{Quantity, parse_unit};

/// Channel names of a virtual bench.
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

/// Gives the channels of a virtual bench the names that a bench file states, and the units and signs that it says they
/// are recorded in, so that it reads them as those of the bench. A channel whose role is not stated keeps its name,
/// unless a stated one has it: then it is called after its role.
pub fn rename(recording: &mut Recording, stated: &BTreeMap<Role, ChannelMapping>) {
    let is_taken = |name: &str| stated.values().any(|mapping| mapping.name == name);
    let rasters = &recording.rasters;
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
            if unit.quantity == Quantity::Angle {
                integrate(&mut channel.samples, rasters.get(channel.raster).map_or(&[], |raster| &raster.time_s));
            }
        }
        channel.samples.iter_mut().for_each(|value| *value /= mapping.signed_factor());
    }
}

/// The angle of a speed, which is the mean since the sample before.
fn integrate(samples: &mut [f64], time_s: &[f64]) {
    let mut angle = 0.0;
    let mut before_s = time_s.first().copied().unwrap_or_default();
    for (value, time_s) in samples.iter_mut().zip(time_s) {
        angle += *value * (time_s - before_s);
        before_s = *time_s;
        *value = angle;
    }
}
