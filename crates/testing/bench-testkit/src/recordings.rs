//! Recordings made in memory.

use std::f64::consts::TAU;
use std::path::PathBuf;

use recording::{Channel, Format, Raster, Recording};

/// A recording of channels (name, unit, sample time, values), all starting at `start_s`.
pub fn recording(start_s: f64, channels: &[(&str, &str, f64, Vec<f64>)]) -> Recording {
    let mut rasters = Vec::new();
    let mut list = Vec::new();
    for (index, (name, unit, sample_time_s, samples)) in channels.iter().enumerate() {
        let time_s = (0..samples.len()).map(|i| start_s + i as f64 * sample_time_s).collect();
        rasters.push(Raster { time_s, name: None });
        list.push(Channel {
            name: (*name).to_owned(),
            unit: (*unit).to_owned(),
            comment: String::new(),
            raster: index,
            samples: samples.clone(),
        });
    }
    Recording {
        format: Format::Mdf { version: 410 },
        comment: None,
        start_time: None,
        rasters,
        channels: list,
        findings: Vec::new(),
    }
}

/// Noise without a generator's state: uniform in ±1, by the finaliser of SplitMix64.
pub fn noise(i: usize, seed: usize) -> f64 {
    let mut z = (i as u64 + ((seed as u64) << 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A simulated torque-controlled test: held random demand, stiff train, firing ripple on the engine's side.
pub struct Bench {
    pub dyno_rpm: Vec<f64>,
    pub engine_rpm: Vec<f64>,
    pub speed_demand_rpm: Vec<f64>,
    pub torque_demand: Vec<f64>,
    pub air_gap: Vec<f64>,
    pub load_cell: Vec<f64>,
    pub shaft: Vec<f64>,
}

/// 8 s of it: speeds and demands at 1 kHz (engine 500 Hz), torques at 250 Hz.
pub fn bench() -> Bench {
    let count = 8000;
    let inertia = 0.8;
    let demand: Vec<f64> = (0..count).map(|i| 60.0 + 15.0 * noise(i / 10, 1)).collect();
    let at = |i: usize, delay: usize| demand[i.saturating_sub(delay)];
    let (mut speed, mut speeds) = (TAU * 20.0, Vec::new());
    for i in 0..count {
        let engine = 60.0 + 0.5 * (TAU * 20.0 - speed);
        speed += 1e-3 * (engine - at(i, 2)) / inertia;
        speeds.push(speed);
    }
    let rpm = |i: usize, ripple: f64, seed| {
        let firing = ripple * (TAU * 40.0 * i as f64 * 1e-3).sin();
        speeds[i] * 60.0 / TAU + firing + 0.3 * noise(i, seed)
    };
    let smooth = |i: usize, n: usize| (0..n).map(|k| at(i, k + 6)).sum::<f64>() / n as f64;
    let slow = |f: &dyn Fn(usize) -> f64| (0..count / 4).map(|i| f(4 * i)).collect::<Vec<f64>>();
    Bench {
        dyno_rpm: (0..count).map(|i| rpm(i, 0.5, 2)).collect(),
        engine_rpm: (0..count / 2).map(|i| rpm(2 * i, 6.0, 3)).collect(),
        speed_demand_rpm: vec![1200.0; count],
        air_gap: slow(&|i| at(i, 2) + 0.5 * noise(i, 4)),
        load_cell: slow(&|i| smooth(i, 6) + 0.5 * noise(i, 5)),
        shaft: slow(&|i| 60.0 + 0.5 * (smooth(i, 40) - 60.0) + 2.0 * noise(i, 6)),
        torque_demand: demand,
    }
}

/// The simulated test with the channel names and units of a bench, in the order N_d, N_e, N_d*, T_d*, T_d,calc,
/// T_d,meas, T_shaft.
pub fn named(names: [&str; 7], speed_unit: &str, torque_unit: &str) -> Recording {
    let b = bench();
    recording(
        0.0,
        &[
            (names[4], torque_unit, 4e-3, b.air_gap),
            (names[0], speed_unit, 1e-3, b.dyno_rpm),
            (names[3], torque_unit, 1e-3, b.torque_demand),
            (names[1], speed_unit, 2e-3, b.engine_rpm),
            (names[6], torque_unit, 4e-3, b.shaft),
            (names[2], speed_unit, 1e-3, b.speed_demand_rpm),
            (names[5], torque_unit, 4e-3, b.load_cell),
        ],
    )
}

/// Names of bench A.
pub const BENCH_A: [&str; 7] = [
    "DynoSpeed",
    "EngineSpeed",
    "DynoSpeedDemand",
    "DynoTorqueDemand",
    "DynoTorqueCalc",
    "DynoTorqueMeas",
    "ShaftTorqueCalc",
];

/// A bench file for [`BENCH_A`], with other lines in its channel table replaced.
pub fn bench_file(limits: &str, replaced: &[(&str, &str)]) -> rig::BenchFile {
    let keys = [
        "dyno_speed",
        "engine_speed",
        "dyno_speed_demand",
        "dyno_torque_demand",
        "air_gap_torque",
        "load_cell_torque",
        "system_shaft_torque",
    ];
    let mut text = format!(
        "[bench]\nname = \"A\"\nvariant = \"load-cell\"\ncylinders = 4\ndynamometer_inertia = 0.6\nengine_inertia = 0.2\n\
         [limits]\n{limits}\n[channels]\n"
    );
    for (key, name) in keys.iter().zip(BENCH_A) {
        let other = replaced.iter().find(|(replaced, _)| replaced == key);
        let value = other.map_or_else(|| format!("\"{name}\""), |(_, value)| (*value).to_owned());
        text.push_str(&format!("{key} = {value}\n"));
    }
    text.parse().unwrap()
}

/// Names and contents of a simulated bench's recordings; none, and the test counts as skipped, where they are absent.
pub fn recordings(bench: &str) -> Vec<(String, Recording)> {
    let Some(folder) = testdata::shared(&format!("recordings/{bench}")) else { return Vec::new() };
    let entries = std::fs::read_dir(&folder).unwrap();
    let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    files.retain(|path| path.extension().is_some_and(|ending| ending == "mf4" || ending == "mdf"));
    files.sort();
    let read = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let recording = recording::decode(&name, &std::fs::read(path).unwrap(), &recording::Selection::All).unwrap();
        (name, recording)
    };
    files.iter().map(read).collect()
}
