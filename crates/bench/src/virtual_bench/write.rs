//! From the automation system's registers to a recording: rasters, names, units.

use recording::{Channel, Format, Raster, Recording};

use super::UPDATE_S;
use super::parameters::{BenchParameters, ClockParameters};
use super::plan::ExperimentPlan;
use super::run::Registers;
use crate::units::RPM_RAD_S;

/// The recording of a run, with the channel names of a DTB bench: speeds in rpm, torques in Nm.
pub(super) fn recording(parameters: &BenchParameters, plan: &ExperimentPlan, registers: &Registers) -> Recording {
    let clocks = &parameters.clocks;
    let mut writer = Writer { rasters: Vec::new(), channels: Vec::new(), updates: registers.dyno_speed_rad_s.len() };
    writer.raster(clocks, 1, clocks.fast_skew_s);
    writer.speed("DynoSpeed", &registers.dyno_speed_rad_s, 1);
    writer.torque("DynoTorqueDemand", &registers.dyno_torque_demand_nm, 1);
    writer.speed("DynoSpeedDemand", &registers.dyno_speed_demand_rad_s, 1);
    if plan.has_shaft {
        let decimation = clocks.engine_speed_decimation;
        writer.raster(clocks, decimation, clocks.engine_speed_skew_s);
        writer.speed("EngineSpeed", &registers.engine_speed_rad_s, decimation);
    }
    let decimation = clocks.torque_decimation;
    writer.raster(clocks, decimation, clocks.torque_skew_s);
    writer.torque("DynoTorqueCalc", &registers.dyno_torque_calc_nm, decimation);
    writer.torque("DynoTorqueMeas", &registers.dyno_torque_meas_nm, decimation);
    writer.torque("ShaftTorqueCalc", &registers.shaft_torque_calc_nm, decimation);
    Recording {
        format: Format::Mdf { version: 410 },
        comment: Some(format!("{}, virtual bench", plan.label)),
        start_time: None,
        rasters: writer.rasters,
        channels: writer.channels,
        findings: Vec::new(),
    }
}

struct Writer {
    rasters: Vec<Raster>,
    channels: Vec<Channel>,
    updates: usize,
}

impl Writer {
    fn raster(&mut self, clocks: &ClockParameters, decimation: usize, skew_s: f64) {
        let start_s = clocks.start_offset_s + skew_s;
        let stamps = (0..self.updates).step_by(decimation).map(|k| start_s + k as f64 * UPDATE_S);
        self.rasters.push(Raster { time_s: stamps.collect(), name: None });
    }

    fn speed(&mut self, name: &str, values_rad_s: &[f64], decimation: usize) {
        let samples = values_rad_s.iter().step_by(decimation).map(|v| v / RPM_RAD_S);
        self.channel(name, "rpm", samples.collect());
    }

    fn torque(&mut self, name: &str, values_nm: &[f64], decimation: usize) {
        self.channel(name, "Nm", values_nm.iter().step_by(decimation).copied().collect());
    }

    fn channel(&mut self, name: &str, unit: &str, samples: Vec<f64>) {
        self.channels.push(Channel {
            name: name.to_owned(),
            unit: unit.to_owned(),
            comment: String::new(),
            raster: self.rasters.len().saturating_sub(1),
            samples,
        });
    }
}
