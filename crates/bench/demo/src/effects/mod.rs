//! Effects that a bench shows before any model is made of it: those of the thesis, run and measured.

mod error;
mod gains;
mod sampled;
mod zeros;

use part_lines::lines::amplitudes;
use recording::Recording;
use rig::bench_parameters::BenchParameters;
use rig::experiment::{ExperimentPlan, UPDATE_S, Waveform};
use rig::facts::BenchVariant;
use serde::Serialize;
use virtual_bench::{Numerics, simulate, simulate_hidden};

pub use error::EffectsError;
pub use gains::Gains;
use sampled::sampled;
pub use zeros::{NaiveZeros, ShaftZeros};

/// Length of the runs whose spectra are taken, s.
const SPECTRUM_S: f64 = 10.0;
/// Spectra are given up to this frequency, Hz.
const HIGHEST_HZ: f64 = 200.0;
/// Time shown before a step, s.
const BEFORE_STEP_S: f64 = 0.02;
/// Time shown after a step, s.
const AFTER_STEP_S: f64 = 0.1;
const STEP_S: f64 = 2.0;

/// Amplitudes of a signal over frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spectrum {
    /// Which signal, and of which run.
    pub name: String,
    /// Hz.
    pub frequency_hz: Vec<f64>,
    /// Amplitude of a sine there, in the signal's unit.
    pub amplitude: Vec<f64>,
}

/// A signal over time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShownTrace {
    /// Which signal.
    pub name: String,
    /// Time of the first sample, s after the step.
    pub start_s: f64,
    /// Time between samples, s.
    pub sample_time_s: f64,
    /// The samples, Nm.
    pub values: Vec<f64>,
}

/// The effects, each the figure of a finding of the thesis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Effects {
    /// N_e in rpm at 1200, 3000 and 4500 rpm: the firing frequency follows the speed (§5.2).
    pub firing: Vec<Spectrum>,
    /// T_d,shaft,calc in Nm at 4500 rpm, recorded at 1 kHz and at 250 Hz: 150 Hz folds to 100 Hz (§5.3.1).
    pub folding: Vec<Spectrum>,
    /// T_d* and T_d,calc in Nm with an 8 Hz sine: lines at 100 ± 8 Hz by the demand's hold, and by the ripple (§5.3.2).
    pub side_lines: Vec<Spectrum>,
    /// From T_d to T_shaft at sines of 1 to 22 Hz: a resonance at 18 Hz, a gain below one far under it (§5.1, §7.2).
    pub gains: Gains,
    /// T_d*, T_d,calc and T_d,meas about a step: the load cell is late (§6.1).
    pub step: Vec<ShownTrace>,
    /// T_shaft as it is and as the system computes it, about the same step: late by its moving average (§3.4.3).
    pub shaft_torque: Vec<ShownTrace>,
}

impl Effects {
    /// Runs what shows the effects on a bench, with a load cell whatever its variant.
    ///
    /// # Errors
    ///
    /// As [`simulate`].
    ///
    /// # Example
    ///
    /// ```
    /// let found = demo::effects::Effects::of(&Default::default(), 1)?;
    /// let firing = &found.firing[0];
    /// let largest = firing.amplitude.iter().copied().fold(0.0, f64::max);
    /// let strongest = firing.amplitude.iter().position(|a| *a == largest).unwrap_or(0);
    /// assert!((firing.frequency_hz[strongest] - 40.0).abs() < 0.2);
    /// # Ok::<(), demo::effects::EffectsError>(())
    /// ```
    pub fn of(parameters: &BenchParameters, seed: u64) -> Result<Self, EffectsError> {
        let bench = BenchParameters { variant: BenchVariant::LoadCell, ..parameters.clone() };
        let (step, shaft_torque) = step(&bench, seed)?;
        Ok(Self {
            firing: firing(&bench, seed)?,
            folding: folding(&bench, seed)?,
            side_lines: side_lines(&bench, seed)?,
            gains: Gains::of(&bench, seed)?,
            step,
            shaft_torque,
        })
    }
}

fn firing(bench: &BenchParameters, seed: u64) -> Result<Vec<Spectrum>, EffectsError> {
    let at = |speed_rpm: f64| {
        let recording = simulate(bench, &constant(speed_rpm), seed)?;
        Ok(spectrum(format!("N_e at {speed_rpm} rpm"), &recording, "EngineSpeed"))
    };
    [1200.0, 3000.0, 4500.0].into_iter().map(at).collect()
}

fn folding(bench: &BenchParameters, seed: u64) -> Result<Vec<Spectrum>, EffectsError> {
    let mut bench = bench.clone();
    // The drive's own line is where the folded one comes to lie.
    (bench.drive.additive_ripple_nm, bench.drive.multiplicative_ripple) = (0.0, 0.0);
    let at = |(decimation, rate): (usize, &str)| {
        let mut bench = bench.clone();
        bench.clocks.torque_decimation = decimation;
        let recording = simulate(&bench, &constant(4500.0), seed)?;
        Ok(spectrum(format!("T_d,shaft,calc at {rate}"), &recording, "ShaftTorqueCalc"))
    };
    [(1, "1 kHz"), (4, "250 Hz")].into_iter().map(at).collect()
}

fn side_lines(bench: &BenchParameters, seed: u64) -> Result<Vec<Spectrum>, EffectsError> {
    let mut plan = ExperimentPlan::sine_t_tn(1200.0, SPECTRUM_S);
    plan.dyno_torque_nm =
        Waveform::SineLadder { mean: 60.0, amplitude: 8.0, frequencies_hz: vec![8.0], dwell_s: SPECTRUM_S };
    let mut spectra = Vec::new();
    for (cause, is_held) in [("held demand", true), ("ripple", false)] {
        let mut bench = bench.clone();
        bench.clocks.torque_decimation = 1;
        if is_held {
            (bench.drive.additive_ripple_nm, bench.drive.multiplicative_ripple) = (0.0, 0.0);
        } else {
            bench.controller.demand_hold_s = UPDATE_S;
        }
        let recording = simulate(&bench, &plan, seed)?;
        for (signal, channel) in [("T_d*", "DynoTorqueDemand"), ("T_d,calc", "DynoTorqueCalc")] {
            spectra.push(spectrum(format!("{signal}, {cause}"), &recording, channel));
        }
    }
    Ok(spectra)
}

/// Traces about a step of T_d*: of the air-gap torques, and of the shaft's.
fn step(bench: &BenchParameters, seed: u64) -> Result<(Vec<ShownTrace>, Vec<ShownTrace>), EffectsError> {
    let run = simulate_hidden(bench, &ExperimentPlan::step_t_tn(1200.0, 2.0 * STEP_S), seed, Numerics::default())?;
    let recorded = |name: &str, channel: &str| {
        let (samples, sample_time_s) = sampled(&run.recording, channel);
        around_step(name, samples, sample_time_s)
    };
    let torques = [("T_d*", "DynoTorqueDemand"), ("T_d,calc", "DynoTorqueCalc"), ("T_d,meas", "DynoTorqueMeas")];
    let shaft = vec![
        around_step("T_shaft", &run.hidden.shaft_torque_nm, run.hidden.sample_time_s),
        recorded("T_d,shaft,calc", "ShaftTorqueCalc"),
    ];
    Ok((torques.into_iter().map(|(name, channel)| recorded(name, channel)).collect(), shaft))
}

fn around_step(name: &str, samples: &[f64], sample_time_s: f64) -> ShownTrace {
    let index = |time_s: f64| ((time_s / sample_time_s).round() as usize).min(samples.len());
    let (from, to) = (index(STEP_S - BEFORE_STEP_S), index(STEP_S + AFTER_STEP_S));
    let start_s = from as f64 * sample_time_s - STEP_S;
    ShownTrace { name: name.to_owned(), start_s, sample_time_s, values: samples[from..to].to_vec() }
}

/// A fired engine at a constant speed and torque.
fn constant(speed_rpm: f64) -> ExperimentPlan {
    let mut plan = ExperimentPlan::bs_t_nt(speed_rpm, SPECTRUM_S);
    plan.engine_torque_nm = Waveform::Constant { value: 45.0 };
    plan
}

/// Amplitudes of a channel, its mean taken out, seen through a Hann window.
fn spectrum(name: String, recording: &Recording, channel: &str) -> Spectrum {
    let (samples, sample_time_s) = sampled(recording, channel);
    let (mut frequency_hz, mut amplitude) = amplitudes(samples, sample_time_s);
    let shown = frequency_hz.iter().take_while(|f| **f <= HIGHEST_HZ).count();
    frequency_hz.truncate(shown);
    amplitude.truncate(shown);
    Spectrum { name, frequency_hz, amplitude }
}
