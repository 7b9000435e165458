//! The course of the engine's torque between two firings.

use std::f64::consts::TAU;

use rig::bench_parameters::Harmonic;

use crate::cubic;

/// Points of the table: a power of two, so that the place in it is a part of the bits.
const POINTS: usize = 2048;

/// 1 + p Σ a_n cos(2π n θ/θ_f + φ_n) over the crank angle θ, θ_f being that between firings: from a table of values and
/// slopes, the cubic between two points. Of the fourth harmonic the error is 6·10⁻¹¹ of its amplitude.
#[derive(Debug, Clone)]
pub(super) struct Pulse {
    /// Values, and slopes a point; the first once more at the end.
    points: Vec<(f64, f64)>,
    points_a_rad: f64,
}

impl Pulse {
    /// Of harmonics times `size`, p.
    pub(super) fn new(harmonics: &[Harmonic], size: f64, interval_rad: f64) -> Self {
        let point = |k: usize| {
            let (mut value, mut slope) = (1.0, 0.0);
            for (n, harmonic) in (1..).zip(harmonics) {
                let turns = f64::from(n) * TAU / POINTS as f64;
                let (sine, cosine) = (turns * k as f64 + harmonic.phase_rad).sin_cos();
                value += size * harmonic.relative_amplitude * cosine;
                slope -= size * harmonic.relative_amplitude * sine * turns;
            }
            (value, slope)
        };
        Self { points: (0..=POINTS).map(point).collect(), points_a_rad: POINTS as f64 / interval_rad }
    }

    /// At a crank angle, rad.
    pub(super) fn at(&self, angle_rad: f64) -> f64 {
        let place = angle_rad * self.points_a_rad;
        let towards_zero = place as i64;
        let below = towards_zero - i64::from(towards_zero as f64 > place);
        let index = (below & (POINTS as i64 - 1)) as usize;
        cubic::between(self.points[index], self.points[index + 1], place - below as f64)
    }
}
