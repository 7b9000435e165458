//! How far firing pulses move the shaft torque, over speed.
//!
//! At a speed that hardly changes the pulses repeat, so that the frequency response gives what the shaft makes of them. While a
//! resonance is passed quickly, less comes of them: the result is an upper bound there.

use std::f64::consts::TAU;

use bench_model::model::{BenchModel, mean_over};
use rig::bench_parameters::{EngineParameters, Harmonic};
use rig::facts::Engine;
use signal::Complex64;

/// Speeds of the table.
const SPEEDS: usize = 96;
/// Points of a firing period.
const PHASES: usize = 32;
/// Standard deviations of a firing that count: one in 740 is stronger.
const VARIES: f64 = 3.0;
/// Waves below this part of the mean torque are left out.
const LEAST: f64 = 1e-6;

/// What pulses of 1 Nm mean torque add to T_shaft, over the engine's speed.
pub(crate) struct Pulses {
    lowest_rad_s: f64,
    step_rad_s: f64,
    table: Vec<Extreme>,
    /// By which part firings are stronger than the mean where they vary from cycle to cycle.
    varies: f64,
}

/// Extremes of the torque and of its slope, for 1 Nm.
#[derive(Debug, Clone, Copy, Default)]
struct Extreme {
    above_nm: f64,
    below_nm: f64,
    slew_nm_per_s: f64,
}

impl Pulses {
    /// Those of an engine on a bench, from one speed to another.
    pub(crate) fn of(model: &BenchModel, engine: &EngineParameters, (low, high): (f64, f64)) -> Self {
        let step_rad_s = ((high - low) / (SPEEDS - 1) as f64).max(1e-9);
        let cylinders = engine.cylinder_factors.len();
        let per_turn = Engine { cylinders: cylinders as u32, strokes: engine.strokes }.firings_per_turn();
        let waves = waves(engine);
        let of_cycle = per_turn / cylinders.max(1) as f64;
        let at = |k: usize| extreme(model, &waves, PHASES * cylinders, (low + k as f64 * step_rad_s) * of_cycle);
        Pulses {
            lowest_rad_s: low,
            step_rad_s,
            table: (0..SPEEDS).map(at).collect(),
            varies: VARIES * engine.cycle_variation,
        }
    }

    /// Highest and lowest T_shaft, and the largest slope of the pulses, at a mean torque of shaft and engine.
    pub(crate) fn around(&self, shaft_nm: f64, engine_nm: f64, speed_rad_s: f64) -> (f64, f64, f64) {
        let place = ((speed_rad_s.abs() - self.lowest_rad_s) / self.step_rad_s).clamp(0.0, (SPEEDS - 1) as f64) + 0.5;
        let Extreme { above_nm, below_nm, slew_nm_per_s } = self.table[place as usize];
        let level_nm = engine_nm.abs() * (1.0 + self.varies);
        // A firing that is stronger also pushes with more on the average.
        let pushed_nm = engine_nm.abs() * self.varies;
        (
            shaft_nm + level_nm * above_nm + pushed_nm,
            shaft_nm - level_nm * below_nm - pushed_nm,
            level_nm * slew_nm_per_s,
        )
    }
}

/// The Fourier series of all firings of a cycle for 1 Nm: harmonic of the cycle, and its complex amplitude. Unequal cylinders give
/// orders below that of the firing, which a resonance can enlarge at speeds where no firing does.
fn waves(engine: &EngineParameters) -> Vec<(f64, Complex64)> {
    let cylinders = engine.cylinder_factors.len();
    let points = PHASES * cylinders;
    let torque = |k: usize| {
        let phase = TAU * k as f64 / PHASES as f64;
        let pulse = |(harmonic, n): (&Harmonic, i32)| {
            harmonic.relative_amplitude * (f64::from(n) * phase + harmonic.phase_rad).cos()
        };
        engine.cylinder_factors[k / PHASES] * (1.0 + engine.firing_harmonics.iter().zip(1..).map(pulse).sum::<f64>())
    };
    let torques: Vec<f64> = (0..points).map(torque).collect();
    let wave = |m: usize| {
        let part = |(k, torque): (usize, &f64)| torque * Complex64::cis(-TAU * (m * k % points) as f64 / points as f64);
        let sum: Complex64 = torques.iter().enumerate().map(part).sum();
        (m as f64, sum * 2.0 / points as f64)
    };
    let highest = cylinders * engine.firing_harmonics.len();
    (1..=highest).map(wave).filter(|(_, amplitude)| amplitude.norm() > LEAST).collect()
}

/// Of cycles with this frequency.
fn extreme(model: &BenchModel, waves: &[(f64, Complex64)], points: usize, cycle_rad_s: f64) -> Extreme {
    let mut waves: Vec<(f64, Complex64, Complex64)> = waves
        .iter()
        .map(|(m, wave)| {
            let omega = m * cycle_rad_s;
            (omega, wave * to_shaft(model, omega), Complex64::cis(TAU * m / points as f64))
        })
        .collect();
    let mut extreme = Extreme::default();
    for _ in 0..points {
        let (mut torque, mut slope) = (0.0, 0.0);
        for (omega, wave, turn) in &mut waves {
            torque += wave.re;
            slope -= wave.im * *omega;
            *wave *= *turn;
        }
        extreme.above_nm = extreme.above_nm.max(torque);
        extreme.below_nm = extreme.below_nm.max(-torque);
        extreme.slew_nm_per_s = extreme.slew_nm_per_s.max(slope.abs());
    }
    extreme
}

/// T_e → T_shaft in speed control; with both sides free where the model has no controller.
pub(crate) fn to_shaft(model: &BenchModel, omega_rad_s: f64) -> Complex64 {
    let free = model.mechanics.engine_to_shaft(omega_rad_s);
    let controlled = || {
        let (pi, control) = (model.speed_controller?, model.torque_control?);
        let speed = model.engine_to_speed_controlled(omega_rad_s)? * mean_over(model.encoder_gate_s, omega_rad_s);
        let braking = speed * pi.response(omega_rad_s) * pi.hold(omega_rad_s) * control.response(omega_rad_s);
        Some(braking * model.mechanics.torque_to_shaft(omega_rad_s))
    };
    free + controlled().unwrap_or_default()
}
