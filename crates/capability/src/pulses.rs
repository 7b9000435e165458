//! How far firing pulses move the shaft torque, over speed.
//!
//! At a speed that hardly changes the pulses repeat, so that the frequency response gives what the shaft makes of them. While a
//! resonance is passed quickly, less comes of them: the result is an upper bound there.

use std::f64::consts::TAU;

use bench_model::model::{BenchModel, mean_over};
use rig::bench_parameters::EngineParameters;
use rig::facts::Engine;
use signal::Complex64;

/// Speeds of the table.
const SPEEDS: usize = 96;
/// Points of a firing period.
const PHASES: usize = 48;

/// What pulses of 1 Nm mean torque add to T_shaft, over the engine's speed.
pub(crate) struct Pulses {
    lowest_rad_s: f64,
    step_rad_s: f64,
    table: Vec<Extreme>,
    /// How much larger the strongest firing is than the mean.
    strongest: f64,
    motored_share: f64,
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
        let at = |k: usize| extreme(model, engine, (low + k as f64 * step_rad_s) * per_turn);
        let largest = engine.cylinder_factors.iter().copied().fold(1.0, f64::max);
        Pulses {
            lowest_rad_s: low,
            step_rad_s,
            table: (0..SPEEDS).map(at).collect(),
            strongest: largest * (1.0 + 2.0 * engine.cycle_variation),
            motored_share: engine.motored_pulsation,
        }
    }

    /// Highest and lowest T_shaft, and the largest slope of the pulses, at a mean torque of shaft and engine.
    pub(crate) fn around(&self, shaft_nm: f64, engine_nm: f64, speed_rad_s: f64) -> (f64, f64, f64) {
        let place = ((speed_rad_s.abs() - self.lowest_rad_s) / self.step_rad_s).round().clamp(0.0, (SPEEDS - 1) as f64);
        let Extreme { above_nm, below_nm, slew_nm_per_s } = self.table[place as usize];
        let level_nm = if engine_nm >= 0.0 { engine_nm } else { -self.motored_share * engine_nm } * self.strongest;
        (shaft_nm + level_nm * above_nm, shaft_nm - level_nm * below_nm, level_nm * slew_nm_per_s)
    }
}

/// Of firings with the fundamental `firing_rad_s`.
fn extreme(model: &BenchModel, engine: &EngineParameters, firing_rad_s: f64) -> Extreme {
    let waves: Vec<(f64, Complex64)> = engine
        .firing_harmonics
        .iter()
        .zip(1..)
        .map(|(harmonic, n)| {
            let omega = f64::from(n) * firing_rad_s;
            let driven = Complex64::from_polar(harmonic.relative_amplitude, harmonic.phase_rad);
            (f64::from(n), driven * to_shaft(model, omega))
        })
        .collect();
    let mut extreme = Extreme::default();
    for k in 0..PHASES {
        let phase = TAU * k as f64 / PHASES as f64;
        let turned = |n: f64, wave: Complex64| wave * Complex64::cis(n * phase);
        let torque: f64 = waves.iter().map(|(n, wave)| turned(*n, *wave).re).sum();
        let slope: f64 = waves.iter().map(|(n, wave)| -turned(*n, *wave).im * n * firing_rad_s).sum();
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
