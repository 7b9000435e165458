//! The torque of an engine over the angle of its crank.

use std::f64::consts::TAU;

use rig::bench_parameters::{EngineParameters, Harmonic};
use signal::Complex64;

/// The torque over the crank's angle while one firing lasts: T_j + Σ Re(A_n e^{inφ}). φ grows by a turn from one firing
/// to the next and A_n is p T_j a_n e^{iφ_n}, p = 1 but for a motored engine. Where harmonics of the working cycle take
/// their place, φ grows by a turn in a cycle, and A_n is what they are at T_j and the speed of the firing.
#[derive(Debug, Clone)]
pub struct PulseShape {
    mean_nm: f64,
    waves_nm: Vec<Complex64>,
    phase_per_rad: f64,
}

impl PulseShape {
    /// Of an engine whose pulses have the share p, with a torque level at a firing and the speed there.
    #[must_use]
    pub fn of(engine: &EngineParameters, share: f64, (level_nm, speed_rad_s): (f64, f64)) -> Self {
        if !engine.cycle_harmonics.is_empty() {
            let waves_nm = engine.waves(level_nm, speed_rad_s);
            return PulseShape { mean_nm: level_nm, waves_nm, phase_per_rad: TAU / engine.cycle_rad() };
        }
        let wave = |h: &Harmonic| Complex64::from_polar(share * h.relative_amplitude * level_nm, h.phase_rad);
        PulseShape {
            mean_nm: level_nm,
            waves_nm: engine.firing_harmonics.iter().map(wave).collect(),
            phase_per_rad: TAU * engine.cylinder_factors.len().max(1) as f64 / engine.cycle_rad(),
        }
    }

    /// At a crank angle, Nm.
    #[must_use]
    pub fn at(&self, angle_rad: f64) -> f64 {
        let once = Complex64::cis(self.phase_per_rad * angle_rad);
        let (mut turn, mut sum) = (once, self.mean_nm);
        for wave in &self.waves_nm {
            sum += wave.re * turn.re - wave.im * turn.im;
            turn *= once;
        }
        sum
    }
}
