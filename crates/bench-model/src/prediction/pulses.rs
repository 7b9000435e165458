//! The firing pulses of an engine beside its mean torque.

use std::f64::consts::TAU;

use rig::bench_parameters::EngineParameters;
use rig::facts::Engine;
use rig::random::Source;

/// T_j (1 + Σ a_n cos(nφ + φ_n)) less the level, T_j the level at the firing times the factor of the cylinder and what varies from cycle
/// to cycle, φ growing by a turn from one firing to the next.
pub(super) fn of(
    (engine, seed): (&EngineParameters, u64),
    level_nm: &[f64],
    speed_rad_s: &[f64],
    sample_time_s: f64,
) -> Vec<f64> {
    let mut fired = usize::MAX;
    let mut fired_nm = 0.0;
    let cylinders = engine.cylinder_factors.len();
    let firings_per_turn = Engine { cylinders: cylinders as u32, strokes: engine.strokes }.firings_per_turn();
    // Nobody knows at which angle the engine is when the first demand comes.
    let mut firings = cylinders as f64 * Source::StartAngle.stream(seed).between(0.0, 1.0);
    let mut random = Source::Firing.stream(seed);
    let pulse = |(level, speed): (&f64, &f64)| {
        let phase = TAU * f64::fract(firings);
        let waves = engine.firing_harmonics.iter().zip(1..);
        let sum: f64 = waves
            .map(|(harmonic, n)| harmonic.relative_amplitude * (f64::from(n) * phase + harmonic.phase_rad).cos())
            .sum();
        // The float-to-integer cast saturates.
        if fired != firings as usize {
            fired = firings as usize;
            let cylinder = engine.cylinder_factors.get(fired % cylinders.max(1)).copied().unwrap_or(1.0);
            // A cylinder gives what is demanded when it fires.
            fired_nm = level * cylinder * (1.0 + engine.cycle_variation * random.normal());
        }
        firings += firings_per_turn * speed.abs() / TAU * sample_time_s;
        fired_nm * (1.0 + sum) - level
    };
    level_nm.iter().zip(speed_rad_s).map(pulse).collect()
}
