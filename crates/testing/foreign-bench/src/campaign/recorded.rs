//! A run as a recording.

use recording::{Channel, Format, Raster, Recording};

use crate::bench::Bench;
use crate::bench::RPM;
use crate::demand::Demand;
use crate::run::Run;

/// Roles of a bench file and the names of their channels.
pub const NAMES: [(&str, &str); 6] = [
    ("dyno_speed", "SpeedDyno"),
    ("dyno_speed_demand", "SpeedDynoSet"),
    ("dyno_torque_demand", "TorqueDynoSet"),
    ("engine_speed", "SpeedEngine"),
    ("air_gap_torque", "TorqueInverter"),
    ("load_cell_torque", "TorqueCell"),
];

/// A run as the bench records it: three clocks, in rpm and Nm.
pub fn recorded(bench: &Bench, demand: &Demand, run: &Run) -> Recording {
    let clocks = &bench.clocks;
    let steps = [1, clocks.engine_speed_ms, clocks.torque_ms];
    let skews_s = [0.0, clocks.engine_speed_skew_s, clocks.torque_skew_s];
    let count = run.torque_demand_nm.len();
    let raster = |clock: usize| Raster {
        time_s: (0..count).step_by(steps[clock]).map(|k| 1e-3 * k as f64 + skews_s[clock]).collect(),
        name: None,
    };
    let channel = |(place, clock, values, is_speed): (usize, usize, &[f64], bool)| Channel {
        name: NAMES[place].1.to_owned(),
        unit: if is_speed { "rpm" } else { "Nm" }.to_owned(),
        comment: String::new(),
        raster: clock,
        samples: values.iter().step_by(steps[clock]).map(|value| value / if is_speed { RPM } else { 1.0 }).collect(),
    };
    let step_nm = bench.sensors.demand_step_nm;
    let demanded_nm: Vec<f64> =
        run.torque_demand_nm.iter().map(|torque| (torque / step_nm).round() * step_nm).collect();
    let channels: [(usize, usize, &[f64], bool); 6] = [
        (0, 0, &run.dyno_speed_rad_s, true),
        (1, 0, &demand.speed_rad_s, true),
        (2, 0, &demanded_nm, false),
        (3, 1, &run.engine_speed_rad_s, true),
        (4, 2, &run.computed_torque_nm, false),
        (5, 2, &run.cell_torque_nm, false),
    ];
    Recording {
        format: Format::Mdf { version: 410 },
        comment: None,
        start_time: None,
        rasters: (0..3).map(raster).collect(),
        channels: channels.into_iter().map(channel).collect(),
        findings: Vec::new(),
    }
}
