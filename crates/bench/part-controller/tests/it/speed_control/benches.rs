//! Virtual benches, recorded and drawn at random.

use std::sync::atomic::{AtomicU64, Ordering};

use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use rig::{Experiment, prepare};
use signal::excitation::Random;
use units::RPM_RAD_S;
use virtual_bench::simulate;

use super::hidden::Hidden;
use bench_testkit::recordings::bench_file;

pub(super) fn recorded(parameters: &BenchParameters, plan: &ExperimentPlan, seed: u64) -> Experiment {
    let recording = simulate(parameters, plan, seed).unwrap();
    let bench = bench_file("torque = \"400 Nm\"", &[]);
    prepare(&format!("{}.mf4", plan.label), &recording, &bench, plan.label.clone()).unwrap().0
}

/// A bench, its speed, and for every second one a controller that does not read the speed that is logged.
pub(super) fn drawn(seed: u64) -> (BenchParameters, f64, Option<Hidden>) {
    let mut random = Random::new(seed + 500);
    let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
    let mut parameters = BenchParameters::default();
    let (k_p, k_i) = (between(0.6, 1.3), between(1.0, 4.0));
    let delay_updates = between(0.0, 3.0).round();
    let controller = &mut parameters.controller;
    controller.proportional_nm_s_per_rad = k_p / RPM_RAD_S;
    controller.integral_nm_per_rad = k_i / RPM_RAD_S;
    controller.delay_s = 1e-3 * delay_updates;
    controller.speed_feed_forward_nm_s_per_rad = between(0.0, 0.02) / RPM_RAD_S;
    controller.acceleration_feed_forward_nm_s2_per_rad = between(-0.1, 0.0) / RPM_RAD_S;
    parameters.sensors.dyno_eccentricity = between(0.0, 4e-4);
    let hidden = Hidden {
        k_p,
        k_i,
        delay_updates: delay_updates as usize,
        noise_rad_s: between(0.001, 0.01),
        ..Hidden::default()
    };
    (parameters, between(1000.0, 4000.0), seed.is_multiple_of(2).then_some(hidden))
}

/// Results by seed, two threads at a time.
pub(super) fn on_both_processors<R: Send>(count: u64, work: impl Fn(u64) -> R + Sync) -> Vec<R> {
    let next = AtomicU64::new(0);
    let mine = || {
        std::iter::from_fn(|| Some(next.fetch_add(1, Ordering::Relaxed)).filter(|seed| *seed < count))
            .map(|seed| (seed, work(seed)))
            .collect::<Vec<_>>()
    };
    let mut all: Vec<(u64, R)> = std::thread::scope(|scope| {
        let other = scope.spawn(mine);
        let own = mine();
        own.into_iter().chain(other.join().unwrap()).collect()
    });
    all.sort_by_key(|(seed, _)| *seed);
    all.into_iter().map(|(_, result)| result).collect()
}
