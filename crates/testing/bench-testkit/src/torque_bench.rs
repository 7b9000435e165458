//! A torque control of known parameters, computed by a route of its own: small steps of the exact first-order solution.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rig::{Experiment, Role};
use signal::Signal;

pub struct Noise(ChaCha8Rng);

impl Noise {
    pub fn new(seed: u64) -> Self {
        Noise(ChaCha8Rng::seed_from_u64(seed))
    }

    fn uniform(&mut self) -> f64 {
        self.0.random::<f64>()
    }

    /// Standard normal, by Box and Muller.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }
}

#[derive(Clone, Copy)]
pub struct Truth {
    pub delay_s: f64,
    pub lag_rad_s: f64,
    pub ripple_hz: Option<f64>,
    pub noise_nm: f64,
    pub start_s: f64,
    /// Start of T_d,calc after T_d*, s.
    pub shift_s: f64,
    pub duration_s: f64,
}

pub const TRUTH: Truth = Truth {
    delay_s: 1.25e-3,
    lag_rad_s: 565.5,
    ripple_hz: Some(100.0),
    noise_nm: 0.0,
    start_s: 2.5,
    shift_s: 0.0,
    duration_s: 12.0,
};

/// White demand about 60 Nm, held for 10 ms, on a 1 kHz raster.
pub fn white_demand(truth: Truth, noise: &mut Noise) -> Signal {
    let count = (truth.duration_s * 1e3) as usize;
    let levels: Vec<f64> = (0..=count / 10).map(|_| 60.0 + 10.0 * noise.normal()).collect();
    Signal::new(truth.start_s, 1e-3, (0..count).map(|i| levels[i / 10]).collect()).unwrap()
}

/// T_d without ripple at any instant: e^{−sd} a/(s + a) on the held demand, by stepping through its switchings.
pub fn lagged(demand: &Signal, delay_s: f64, rate: f64, times_s: &[f64]) -> Vec<f64> {
    let mut out = Vec::new();
    let (mut x, mut n) = (demand.samples[0], 0);
    for t in times_s {
        let local = t - delay_s;
        while n + 1 < demand.len() && demand.time_s(n + 1) <= local {
            x = demand.samples[n] + (x - demand.samples[n]) * (-rate * demand.sample_time_s).exp();
            n += 1;
        }
        let since = (local - demand.time_s(n)).max(0.0);
        out.push(demand.samples[n] + (x - demand.samples[n]) * (-rate * since).exp());
    }
    out
}

/// The drive's ripple upon a torque.
pub fn rippled(torque_nm: f64, ripple_hz: Option<f64>, time_s: f64) -> f64 {
    let Some(f) = ripple_hz else { return torque_nm };
    let phase = TAU * f * time_s + 0.4;
    torque_nm * (1.0 + 0.03 * phase.sin()) + 1.2 * phase.sin()
}

/// T_d,calc at 250 Hz.
pub fn calculated(truth: Truth, demand: &Signal, noise: &mut Noise) -> Signal {
    let count = ((truth.duration_s - truth.shift_s) * 250.0) as usize;
    let times: Vec<f64> = (0..count).map(|i| truth.start_s + truth.shift_s + 0.004 * i as f64).collect();
    let torque = lagged(demand, truth.delay_s, truth.lag_rad_s, &times);
    let one = |(t, m): (&f64, &f64)| rippled(*m, truth.ripple_hz, *t) + truth.noise_nm * noise.normal();
    Signal::new(times[0], 0.004, times.iter().zip(&torque).map(one).collect()).unwrap()
}

pub fn experiment(label: &str, signals: impl IntoIterator<Item = (Role, Signal)>) -> Experiment {
    let signals: BTreeMap<Role, Signal> = signals.into_iter().collect();
    Experiment { file: "made.mf4".to_owned(), label: label.parse().unwrap(), signals }
}

pub fn white_noise(truth: Truth, seed: u64) -> Experiment {
    let mut noise = Noise::new(seed);
    let demand = white_demand(truth, &mut noise);
    let torque = calculated(truth, &demand, &mut noise);
    experiment("WhiteNoise_T_TN", [(Role::DynoTorqueDemand, demand), (Role::AirGapTorque, torque)])
}
