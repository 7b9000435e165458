//! The firing pulses of an engine beside its mean torque.

use std::f64::consts::TAU;

use rig::bench_parameters::EngineParameters;
use rig::facts::Engine;

/// T_j (1 + Σ a_n cos(nφ + φ_n)) less the level, T_j the level times the factor of the cylinder that fires, φ growing by a turn from
/// one firing to the next.
pub(super) fn of(engine: &EngineParameters, level_nm: &[f64], speed_rad_s: &[f64], sample_time_s: f64) -> Vec<f64> {
    let cylinders = engine.cylinder_factors.len();
    let firings_per_turn = Engine { cylinders: cylinders as u32, strokes: engine.strokes }.firings_per_turn();
    let mut firings = 0.0;
    let pulse = |(level, speed): (&f64, &f64)| {
        let phase = TAU * f64::fract(firings);
        let waves = engine.firing_harmonics.iter().zip(1..);
        let sum: f64 = waves
            .map(|(harmonic, n)| harmonic.relative_amplitude * (f64::from(n) * phase + harmonic.phase_rad).cos())
            .sum();
        // The float-to-integer cast saturates.
        let factor = engine.cylinder_factors.get(firings as usize % cylinders.max(1)).copied().unwrap_or(1.0);
        firings += firings_per_turn * speed.abs() / TAU * sample_time_s;
        level * (factor * (1.0 + sum) - 1.0)
    };
    level_nm.iter().zip(speed_rad_s).map(pulse).collect()
}
