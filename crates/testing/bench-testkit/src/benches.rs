//! Bench files of simulated benches, and work on several of them at once.

use rig::BenchFile;

use crate::recordings::BENCH_A;

/// Keys of the channels in the order of [`BENCH_A`].
const KEYS: [&str; 7] = [
    "dyno_speed",
    "engine_speed",
    "dyno_speed_demand",
    "dyno_torque_demand",
    "air_gap_torque",
    "load_cell_torque",
    "system_shaft_torque",
];

/// A load-cell bench with four cylinders.
pub fn bench_file(dyno_inertia: &str, engine_inertia: &str, limit: &str, names: [&str; 7]) -> BenchFile {
    let mut text = format!(
        "[bench]\nname = \"x\"\nvariant = \"load-cell\"\ncylinders = 4\ndynamometer_inertia = {dyno_inertia}\n\
         engine_inertia = {engine_inertia}\n[limits]\ntorque = \"{limit}\"\n[channels]\n"
    );
    for (key, name) in KEYS.iter().zip(names) {
        text.push_str(&format!("{key} = \"{name}\"\n"));
    }
    text.parse().unwrap()
}

pub fn default_bench() -> BenchFile {
    bench_file("0.6", "0.28", "400 Nm", BENCH_A)
}

/// Returns the results of `work` on 0, 1, … on all processors, in order.
pub fn in_parallel<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    numerics::parallel::map(&(0..count).collect::<Vec<_>>(), |i| work(*i))
}
