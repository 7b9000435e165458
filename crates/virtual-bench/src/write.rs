//! From the automation system's registers to a recording: rasters, names, units.

use recording::{Channel, Format, Raster, Recording};
use rig::bench_parameters::{BenchParameters, ClockParameters};
use rig::experiment::{ExperimentPlan, TorqueTarget, UPDATE_S};
use rig::facts::BenchVariant;
use rig::{ControlMode, SIMULATED};
use units::RPM_RAD_S;

use super::run::Registers;
use crate::hidden::HiddenTruth;

/// The recording of a run, with channel names of a DTB or a TB bench: speeds in rpm, torques in Nm, throttle in %.
pub(super) fn recording(parameters: &BenchParameters, plan: &ExperimentPlan, registers: &Registers) -> Recording {
    let clocks = &parameters.clocks;
    let updates = registers.readings.len();
    let mut writer = Writer { rasters: Vec::new(), channels: Vec::new(), updates, decimation: 1 };
    writer.fast(plan, registers, clocks);
    if plan.has_shaft {
        writer.raster(clocks, clocks.engine_speed_decimation, clocks.engine_speed_skew_s, clocks.engine_speed_drift);
        writer.channel("EngineSpeed", "rpm", |k| registers.readings[k].engine_speed_rad_s / RPM_RAD_S);
    }
    writer.raster(clocks, clocks.torque_decimation, clocks.torque_skew_s, clocks.torque_drift);
    let readings = &registers.readings;
    writer.channel("DynoTorqueCalc", "Nm", |k| readings[k].calc_torque_nm);
    match parameters.variant {
        BenchVariant::LoadCell => {
            writer.channel("DynoTorqueMeas", "Nm", |k| readings[k].cell_torque_nm);
            writer.channel("ShaftTorqueCalc", "Nm", |k| readings[k].shaft_torque_nm);
        }
        BenchVariant::TorqueFlange => writer.channel("FlangeTorque", "Nm", |k| readings[k].shaft_torque_nm),
    }
    if !registers.throttle.is_empty() {
        writer.channel("Throttle", "%", |k| 100.0 * registers.throttle[k]);
    }
    Recording {
        format: Format::Mdf { version: 410 },
        comment: Some(format!("{}, {SIMULATED}", plan.label)),
        start_time: None,
        rasters: writer.rasters,
        channels: writer.channels,
        findings: Vec::new(),
    }
}

/// What really happened.
pub(super) fn hidden(truth: &HiddenTruth) -> Recording {
    let time_s = (0..truth.dyno_speed_rad_s.len()).map(|k| k as f64 * truth.sample_time_s).collect();
    let channel = |name: &str, unit: &str, factor: f64, samples: &[f64]| Channel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        comment: String::new(),
        raster: 0,
        samples: samples.iter().map(|value| value / factor).collect(),
    };
    Recording {
        format: Format::Mdf { version: 410 },
        comment: Some("hidden truth of a virtual bench".to_owned()),
        start_time: None,
        rasters: vec![Raster { time_s, name: None }],
        channels: vec![
            channel("true_dyno_speed", "rpm", RPM_RAD_S, &truth.dyno_speed_rad_s),
            channel("true_engine_speed", "rpm", RPM_RAD_S, &truth.engine_speed_rad_s),
            channel("true_shaft_torque", "Nm", 1.0, &truth.shaft_torque_nm),
            channel("true_engine_torque", "Nm", 1.0, &truth.engine_torque_nm),
            channel("true_air_gap_torque", "Nm", 1.0, &truth.air_gap_torque_nm),
            channel("true_friction_torque", "Nm", 1.0, &truth.friction_torque_nm),
        ],
        findings: Vec::new(),
    }
}

struct Writer {
    rasters: Vec<Raster>,
    channels: Vec<Channel>,
    updates: usize,
    /// Of the last raster.
    decimation: usize,
}

impl Writer {
    /// The controllers' own raster.
    fn fast(&mut self, plan: &ExperimentPlan, registers: &Registers, clocks: &ClockParameters) {
        self.raster(clocks, 1, clocks.fast_skew_s, clocks.fast_drift);
        self.channel("DynoSpeed", "rpm", |k| registers.readings[k].dyno_speed_rad_s / RPM_RAD_S);
        self.channel("DynoTorqueDemand", "Nm", |k| registers.dyno_torque_demand_nm[k]);
        self.channel("DynoSpeedDemand", "rpm", |k| registers.dyno_speed_demand_rad_s[k] / RPM_RAD_S);
        if plan.label.mode == ControlMode::Tn && plan.torque_target == TorqueTarget::Shaft {
            self.channel("ShaftTorqueDemand", "Nm", |k| registers.shaft_torque_demand_nm[k]);
        }
    }

    fn raster(&mut self, clocks: &ClockParameters, decimation: usize, skew_s: f64, drift: f64) {
        let start_s = clocks.start_offset_s + skew_s;
        let stamps = (0..self.updates).step_by(decimation).map(|k| start_s + k as f64 * UPDATE_S * (1.0 + drift));
        self.decimation = decimation;
        self.rasters.push(Raster { time_s: stamps.collect(), name: None });
    }

    /// A channel on the last raster, of values at each update.
    fn channel(&mut self, name: &str, unit: &str, value: impl Fn(usize) -> f64) {
        self.channels.push(Channel {
            name: name.to_owned(),
            unit: unit.to_owned(),
            comment: String::new(),
            raster: self.rasters.len().saturating_sub(1),
            samples: (0..self.updates).step_by(self.decimation).map(value).collect(),
        });
    }
}

impl HiddenTruth {
    /// The truth as a recording: channels named `true_…`, speeds in rpm, torques in Nm, on one raster from zero on.
    pub fn recording(&self) -> Recording {
        hidden(self)
    }
}
