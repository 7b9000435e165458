//! How far firing pulses move the shaft torque, over speed.
//!
//! At a speed that hardly changes the pulses repeat, so that the frequency response gives what the shaft makes of them. While a
//! resonance is passed quickly, less comes of them: the result is an upper bound there.

use std::f64::consts::TAU;

use bench_model::model::{BenchModel, mean_over};
use rig::bench_parameters::EngineParameters;
use signal::Complex64;

/// Speeds of the table.
const SPEEDS: usize = 96;
/// Mean torques of the table, from the lowest over none to the highest.
const LEVELS: usize = 7;
/// Points of a firing period.
const PHASES: usize = 32;
/// Standard deviations of a firing that count: one in 740 is stronger.
const VARIES: f64 = 3.0;
/// Waves below this are left out, and torques below it are none, Nm.
const LEAST: f64 = 1e-6;

/// What pulses add to T_shaft, over the engine's speed and mean torque. What they add is convex over the torque, so that straight lines
/// between the torques of the table are upper bounds.
pub(crate) struct Pulses {
    lowest_rad_s: f64,
    step_rad_s: f64,
    /// The largest mean torque of the table, Nm.
    highest_nm: f64,
    /// Speed by speed, torque by torque.
    table: Vec<[Extreme; LEVELS]>,
    /// By which part firings are stronger than the mean where they vary from cycle to cycle.
    varies: f64,
}

/// Extremes of the torque and of its slope.
#[derive(Debug, Clone, Copy, Default)]
struct Extreme {
    above_nm: f64,
    below_nm: f64,
    slew_nm_per_s: f64,
}

impl Pulses {
    /// Those of an engine on a bench, from one speed to another and up to a mean torque.
    pub(crate) fn of(model: &BenchModel, engine: &EngineParameters, (low, high): (f64, f64), most_nm: f64) -> Self {
        let step_rad_s = ((high - low) / (SPEEDS - 1) as f64).max(1e-9);
        let cylinders = engine.cylinder_factors.len();
        let varies = VARIES * engine.cycle_variation;
        let highest_nm = (most_nm.abs() * (1.0 + varies)).max(LEAST);
        let at = |k: usize| {
            let speed = low + k as f64 * step_rad_s;
            let cycle_rad_s = speed * TAU / engine.cycle_rad();
            let level = |j: usize| highest_nm * (2.0 * j as f64 / (LEVELS - 1) as f64 - 1.0);
            let waves = |j: usize| engine.waves(level(j), speed);
            std::array::from_fn(|j| extreme(model, &waves(j), PHASES * cylinders, cycle_rad_s))
        };
        Pulses { lowest_rad_s: low, step_rad_s, highest_nm, table: (0..SPEEDS).map(at).collect(), varies }
    }

    /// Highest and lowest T_shaft, and the largest slope of the pulses, at a mean torque of shaft and engine.
    pub(crate) fn around(&self, shaft_nm: f64, engine_nm: f64, speed_rad_s: f64) -> (f64, f64, f64) {
        let place = ((speed_rad_s.abs() - self.lowest_rad_s) / self.step_rad_s).clamp(0.0, (SPEEDS - 1) as f64) + 0.5;
        let level_nm = engine_nm * (1.0 + self.varies);
        let Extreme { above_nm, below_nm, slew_nm_per_s } = self.at(&self.table[place as usize], level_nm);
        // A firing that is stronger also pushes with more on the average.
        let pushed_nm = engine_nm.abs() * self.varies;
        (shaft_nm + above_nm + pushed_nm, shaft_nm - below_nm - pushed_nm, slew_nm_per_s)
    }

    /// Straight between the torques of the table.
    fn at(&self, table: &[Extreme; LEVELS], level_nm: f64) -> Extreme {
        let last = (LEVELS - 1) as f64;
        let place = (0.5 * (level_nm / self.highest_nm + 1.0)).clamp(0.0, 1.0) * last;
        let before = (place as usize).min(LEVELS - 2);
        let between = |of: fn(&Extreme) -> f64| {
            let (from, to) = (of(&table[before]), of(&table[before + 1]));
            from + (place - before as f64) * (to - from)
        };
        Extreme {
            above_nm: between(|one| one.above_nm),
            below_nm: between(|one| one.below_nm),
            slew_nm_per_s: between(|one| one.slew_nm_per_s),
        }
    }
}

/// Of cycles with this frequency.
fn extreme(model: &BenchModel, waves: &[Complex64], points: usize, cycle_rad_s: f64) -> Extreme {
    let mut waves: Vec<(f64, Complex64, Complex64)> = (1..)
        .zip(waves)
        .filter(|(_, wave)| wave.norm() > LEAST)
        .map(|(m, wave)| {
            let m = f64::from(m);
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
