//! The gain from the dynamometer's torque to the shaft's, sine by sine.

use std::f64::consts::TAU;

use faer::c64;
use recording::Recording;
use rig::bench_parameters::BenchParameters;
use rig::experiment::{ExperimentPlan, Waveform};
use serde::Serialize;
use units::RPM_RAD_S;
use virtual_bench::{Truth, simulate};

use super::error::EffectsError;

/// Where the engine's orders, 0.5 the lowest, lie above the sines, rpm.
const SPEED_RPM: f64 = 3000.0;
/// The highest of the sines, Hz; there is one at every whole frequency below.
const HIGHEST_HZ: u32 = 22;
/// Time at each of them, and what of it is left to the transient, s.
const DWELL_S: f64 = 6.0;
const TRANSIENT_S: f64 = 1.0;
/// The torque they swing about and their amplitude, Nm.
const MEAN_NM: f64 = 60.0;
const AMPLITUDE_NM: f64 = 8.0;

/// Gains from T_d to T_shaft.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gains {
    /// Hz.
    pub frequency_hz: Vec<f64>,
    /// |T_shaft/T_d|, T_shaft = J_d dω_d/dt + T_d.
    pub gain: Vec<f64>,
    /// J_e/(J_d + J_e), the gain of free masses far below the resonance.
    pub at_rest: f64,
    /// Resonance by the parameters, Hz.
    pub resonance_hz: f64,
}

impl Gains {
    /// From the recording of a sine test, as the method has it (thesis §5.1).
    pub fn of(bench: &BenchParameters, seed: u64) -> Result<Self, EffectsError> {
        let frequency_hz: Vec<f64> = (1..=HIGHEST_HZ).map(f64::from).collect();
        let mut plan = ExperimentPlan::sine_t_tn(SPEED_RPM, DWELL_S * f64::from(HIGHEST_HZ));
        plan.dyno_torque_nm = Waveform::SineLadder {
            mean: MEAN_NM,
            amplitude: AMPLITUDE_NM,
            frequencies_hz: frequency_hz.clone(),
            dwell_s: DWELL_S,
        };
        let recording = simulate(bench, &plan, seed)?;
        let mechanics = &bench.mechanics;
        let (dyno, engine) = (mechanics.dyno_inertia_kg_m2, mechanics.engine_inertia_kg_m2);
        // Each speed is the mean of the gate before its instant.
        let speed = Sampled::of(&recording, "DynoSpeed", -0.5 * bench.sensors.gate_s);
        let torque = Sampled::of(&recording, "DynoTorqueCalc", 0.0);
        let gain = |(rung, hz): (usize, &f64)| {
            let from_s = DWELL_S * rung as f64 + TRANSIENT_S;
            let until_s = DWELL_S * (rung + 1) as f64;
            let acceleration = speed.line(from_s, until_s, *hz) * RPM_RAD_S * c64::new(0.0, TAU * hz);
            let torque = torque.line(from_s, until_s, *hz);
            (acceleration * dyno + torque).norm() / torque.norm()
        };
        let gain = frequency_hz.iter().enumerate().map(gain).collect();
        Ok(Gains { frequency_hz, gain, at_rest: engine / (dyno + engine), resonance_hz: Truth::of(bench).resonance_hz })
    }
}

/// A channel on an even clock.
struct Sampled<'a> {
    samples: &'a [f64],
    sample_time_s: f64,
    /// Addition to its stamps, s.
    shift_s: f64,
}

impl<'a> Sampled<'a> {
    fn of(recording: &'a Recording, name: &str, shift_s: f64) -> Self {
        let (samples, sample_time_s) = super::sampled::sampled(recording, name);
        Sampled { samples, sample_time_s, shift_s }
    }

    /// The line at a frequency, by correlation with a Hann-weighted rotation.
    fn line(&self, from_s: f64, until_s: f64, frequency_hz: f64) -> c64 {
        let index = |time_s: f64| ((time_s / self.sample_time_s).round() as usize).min(self.samples.len());
        let (from, until) = (index(from_s), index(until_s));
        let x = &self.samples[from.min(until)..until];
        let count = x.len() as f64;
        let mean = x.iter().sum::<f64>() / count;
        let term = |(k, x): (usize, &f64)| {
            let window = 1.0 - (TAU * (k as f64 + 0.5) / count).cos();
            let time_s = (from + k) as f64 * self.sample_time_s + self.shift_s;
            c64::cis(-TAU * frequency_hz * time_s) * (2.0 * window / count * (x - mean))
        };
        x.iter().enumerate().map(term).sum()
    }
}
