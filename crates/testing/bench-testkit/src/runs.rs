//! Virtual benches without errors, and what their recordings hold.

use std::f64::consts::TAU;

use recording::Recording;
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use virtual_bench::{Numerics, VirtualRun, simulate_hidden};

/// The default bench with ideal sensors and no ripple.
pub fn clean() -> BenchParameters {
    let mut parameters = BenchParameters::default();
    parameters.sensors = parameters.sensors.without_errors();
    parameters.drive.additive_ripple_nm = 0.0;
    parameters.drive.multiplicative_ripple = 0.0;
    parameters
}

/// A clean bench whose engine torque has no pulsation.
pub fn smooth() -> BenchParameters {
    let mut parameters = clean();
    parameters.engine.firing_harmonics.clear();
    parameters.engine.cylinder_factors.fill(1.0);
    parameters.engine.cycle_variation = 0.0;
    parameters
}

pub fn run(parameters: &BenchParameters, plan: &ExperimentPlan, numerics: Numerics) -> VirtualRun {
    simulate_hidden(parameters, plan, 7, numerics).expect("a possible bench")
}

pub fn samples<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    &recording.channel(name).expect("a channel of this name").samples
}

pub fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

/// Amplitude of a line by correlation with a Hann-weighted sine.
pub fn amplitude(x: &[f64], sample_time_s: f64, frequency_hz: f64) -> f64 {
    let (average, n) = (mean(x), x.len() as f64);
    let (mut real, mut imaginary, mut weight) = (0.0, 0.0, 0.0);
    for (k, x) in x.iter().enumerate() {
        let window = 0.5 - 0.5 * (TAU * (k as f64 + 0.5) / n).cos();
        let (sine, cosine) = (TAU * frequency_hz * sample_time_s * k as f64).sin_cos();
        real += window * (x - average) * cosine;
        imaginary += window * (x - average) * sine;
        weight += window;
    }
    2.0 * real.hypot(imaginary) / weight
}
