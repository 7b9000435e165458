//! Bench files of simulated benches, and work on several of them at once.

use std::sync::atomic::{AtomicUsize, Ordering};

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

/// What `work` makes of 0, 1, … on two threads, in order.
pub fn in_parallel<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let worker = || {
        let indices = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed)).take_while(|i| *i < count);
        indices.map(|i| (i, work(i))).collect::<Vec<_>>()
    };
    let mut done: Vec<(usize, T)> = std::thread::scope(|scope| {
        let handles = [scope.spawn(worker), scope.spawn(worker)];
        handles.into_iter().flat_map(|handle| handle.join().unwrap()).collect()
    });
    done.sort_by_key(|(i, _)| *i);
    done.into_iter().map(|(_, value)| value).collect()
}
