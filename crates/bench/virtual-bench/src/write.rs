//! From the automation system's registers to a recording: rasters, names, units.

use recording::{Channel, Format, Raster, Recording};
use rig::bench_parameters::{BenchParameters, ClockParameters};
use rig::experiment::{ExperimentPlan, TorqueTarget, UPDATE_S};
use rig::facts::BenchVariant;
use rig::{ControlMode, SIMULATED};
use units::RPM_RAD_S;

use super::sensors::Readings;
use crate::hidden::HiddenTruth;

/// Registers of the automation system at an update. SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Registers {
    pub(super) readings: Readings,
    pub(super) dyno_speed_demand_rad_s: f64,
    pub(super) dyno_torque_demand_nm: f64,
    pub(super) shaft_torque_demand_nm: f64,
    /// Zero where the engine gets a torque.
    pub(super) throttle: f64,
}

/// Records the registers as the bench runs, with channel names of a DTB or a TB bench: speeds in rpm, torques in Nm,
/// throttle in %.
pub(super) struct Recorder {
    rasters: Vec<RecordedRaster>,
    channels: Vec<RecordedChannel>,
    /// To come, and recorded so far.
    updates: usize,
    recorded: usize,
}

/// A clock, and every how many updates it records.
struct RecordedRaster {
    decimation: usize,
    start_s: f64,
    drift: f64,
}

struct RecordedChannel {
    channel: Channel,
    value: fn(&Registers) -> f64,
}

impl Recorder {
    /// Records the updates of a plan.
    pub(super) fn new(parameters: &BenchParameters, plan: &ExperimentPlan) -> Self {
        let clocks = &parameters.clocks;
        let mut recorder = Self { rasters: Vec::new(), channels: Vec::new(), updates: plan.updates(), recorded: 0 };
        recorder.raster(clocks, 1, clocks.fast_skew_s, clocks.fast_drift);
        recorder.channel("DynoSpeed", "rpm", |at| at.readings.dyno_speed_rad_s / RPM_RAD_S);
        recorder.channel("DynoTorqueDemand", "Nm", |at| at.dyno_torque_demand_nm);
        recorder.channel("DynoSpeedDemand", "rpm", |at| at.dyno_speed_demand_rad_s / RPM_RAD_S);
        if plan.label.mode == ControlMode::Tn && plan.torque_target == TorqueTarget::Shaft {
            recorder.channel("ShaftTorqueDemand", "Nm", |at| at.shaft_torque_demand_nm);
        }
        if plan.has_shaft {
            let (decimation, skew_s) = (clocks.engine_speed_decimation, clocks.engine_speed_skew_s);
            recorder.raster(clocks, decimation, skew_s, clocks.engine_speed_drift);
            recorder.channel("EngineSpeed", "rpm", |at| at.readings.engine_speed_rad_s / RPM_RAD_S);
        }
        recorder.raster(clocks, clocks.torque_decimation, clocks.torque_skew_s, clocks.torque_drift);
        recorder.channel("DynoTorqueCalc", "Nm", |at| at.readings.calc_torque_nm);
        match parameters.variant {
            BenchVariant::LoadCell => {
                recorder.channel("DynoTorqueMeas", "Nm", |at| at.readings.cell_torque_nm);
                recorder.channel("ShaftTorqueCalc", "Nm", |at| at.readings.shaft_torque_nm);
            }
            BenchVariant::TorqueFlange => recorder.channel("FlangeTorque", "Nm", |at| at.readings.shaft_torque_nm),
        }
        if plan.throttle.is_some() {
            recorder.channel("Throttle", "%", |at| 100.0 * at.throttle);
        }
        recorder
    }

    fn raster(&mut self, clocks: &ClockParameters, decimation: usize, skew_s: f64, drift: f64) {
        self.rasters.push(RecordedRaster { decimation, start_s: clocks.start_offset_s + skew_s, drift });
    }

    /// A channel on the last raster.
    fn channel(&mut self, name: &str, unit: &str, value: fn(&Registers) -> f64) {
        let decimation = self.rasters.last().map_or(1, |raster| raster.decimation);
        let channel = Channel {
            name: name.to_owned(),
            unit: unit.to_owned(),
            comment: String::new(),
            raster: self.rasters.len().saturating_sub(1),
            samples: Vec::with_capacity(self.updates.div_ceil(decimation)),
        };
        self.channels.push(RecordedChannel { channel, value });
    }

    /// Records an update, each channel where its raster has a sample.
    pub(super) fn record(&mut self, registers: &Registers) {
        for RecordedChannel { channel, value } in &mut self.channels {
            if self.recorded.is_multiple_of(self.rasters[channel.raster].decimation) {
                channel.samples.push(value(registers));
            }
        }
        self.recorded += 1;
    }

    /// The recording of a run.
    pub(super) fn finish(self, plan: &ExperimentPlan) -> Recording {
        let recorded = self.recorded;
        let stamps = |raster: &RecordedRaster| {
            let time_s = |k: usize| raster.start_s + k as f64 * UPDATE_S * (1.0 + raster.drift);
            Raster { time_s: (0..recorded).step_by(raster.decimation).map(time_s).collect(), name: None }
        };
        Recording {
            format: Format::Mdf { version: 410 },
            comment: Some(format!("{}, {SIMULATED}", plan.label)),
            start_time: None,
            rasters: self.rasters.iter().map(stamps).collect(),
            channels: self.channels.into_iter().map(|recorded| recorded.channel).collect(),
            findings: Vec::new(),
        }
    }
}

/// Recording of the true signals.
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

impl HiddenTruth {
    /// The truth as a recording: channels named `true_…`, speeds in rpm, torques in Nm, on one raster from zero on.
    pub fn recording(&self) -> Recording {
        hidden(self)
    }
}
