//! Helpers that the tests share.

use std::f64::consts::TAU;

use foreign_bench::{Bench, Demand, Mode, draw};

/// One revolution a minute, rad/s.
pub(crate) const RPM: f64 = TAU / 60.0;

/// A drawn bench without noise, ripple, encoder errors and variation of the cycles.
pub(crate) fn quiet(seed: u64) -> Bench {
    let mut bench = draw(seed);
    (bench.drive.added_ripple_nm, bench.drive.multiplied_ripple) = (0.0, 0.0);
    bench.engine.cycle_variation = 0.0;
    bench.engine.torque_error = (1.0, 0.0);
    let sensors = &mut bench.sensors;
    (sensors.slits, sensors.pitch_error_rad) = (None, [0.0; 2]);
    (sensors.speed_noise_rad_s, sensors.torque_noise_nm, sensors.speed_step_rad_s) = (0.0, 0.0, 1e-12);
    bench
}

/// Constant demands.
pub(crate) fn steady(mode: Mode, speed_rad_s: f64, torque_nm: f64, count: usize) -> Demand {
    Demand { mode, speed_rad_s: vec![speed_rad_s; count], torque_nm: vec![torque_nm; count] }
}

pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Seeds of the benches of a slow test: so many from the first one on, unless `DYNOID_BENCHES` and `DYNOID_FIRST_BENCH`
/// say otherwise.
pub(crate) fn drawn(count: u64, first: u64) -> Vec<u64> {
    let of =
        |name: &str, otherwise: u64| std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(otherwise);
    let first = of("DYNOID_FIRST_BENCH", first);
    (first..first + of("DYNOID_BENCHES", count)).collect()
}
