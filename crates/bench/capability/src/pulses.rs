//! How far firing pulses move what has limits, over speed and torque.
//!
//! At a speed that hardly changes the pulses repeat, so that frequency responses give what the bench makes of them.
//! While a resonance is passed quickly, less comes of them: the result is an upper bound there.

use std::f64::consts::TAU;

use bench_model::model::{BenchModel, mean_over};
use bench_model::simulate::LoopMode;
use design::safety::{SPEED_CHANGE_S, largest_change};
use rig::bench_parameters::{CycleHarmonic, EngineParameters};
use signal::Complex64;

use crate::added::Added;
use crate::extremes::TORQUE_CHANGE_S;

/// Speeds of the table are so far apart, as a part: a resonance with a damping ratio of 0.02 is four times as wide.
const STEP: f64 = 0.01;
/// Speeds of the table at most; below the lowest one pulses act as they do there.
const SPEEDS: usize = 400;
/// The mean torques of the table to each side of none are halves of one another, so that the table is fine where waves
/// of the torque and of the charge without load are of one size.
const HALVES: usize = 10;
/// Mean torques of the table, from the lowest over none to the highest.
const LEVELS: usize = 2 * HALVES + 1;
/// Points of a firing period at the least.
const PHASES: usize = 32;
/// Points of each wave at the least.
const POINTS_OF_WAVE: usize = 4;
/// Standard deviations of a firing that count: one in 740 is stronger.
const VARIES: f64 = 3.0;
/// Torques below this are none, Nm.
const LEAST: f64 = 1e-6;

/// Additions of pulses to each quantity at the mean torques of the table, over the engine's speed. What they add is
/// convex over the torque, so that straight lines between these torques are upper bounds.
pub(crate) struct Pulses {
    lowest_rad_s: f64,
    /// The largest mean torque of the table, Nm.
    highest_nm: f64,
    table: Vec<Levels>,
    /// Addition of a firing that pushes with 1 Nm more than the mean.
    push: Added,
    /// By which part firings are stronger than the mean where they vary from cycle to cycle.
    varies: f64,
}

/// Additions of pulses at each mean torque of the table.
type Levels = [Added; LEVELS];

/// The larger of each.
fn or_more(one: &Levels, other: &Levels) -> Levels {
    std::array::from_fn(|j| one[j].or_more(&other[j]))
}

impl Pulses {
    /// Those of an engine on a bench that is held in this way, from one speed to another and up to a mean torque.
    pub(crate) fn of(
        model: &BenchModel,
        engine: &EngineParameters,
        mode: LoopMode,
        (low, high): (f64, f64),
        most_nm: f64,
    ) -> Self {
        let high = high.max(f64::MIN_POSITIVE);
        let lowest_rad_s = low.clamp(high * (-STEP * (SPEEDS - 1) as f64).exp(), high);
        let count = ((high / lowest_rad_s).ln() / STEP).ceil() as usize + 1;
        let harmonics = engine.harmonics_of_cycle();
        let points = (PHASES * engine.cylinder_factors.len()).max(POINTS_OF_WAVE * harmonics.len());
        let circle: Vec<Complex64> = (0..points).map(|k| Complex64::cis(TAU * k as f64 / points as f64)).collect();
        let varies = VARIES * engine.cycle_variation;
        let highest_nm = (most_nm.abs() * (1.0 + varies)).max(LEAST);
        let at = |k: usize| {
            let speed = lowest_rad_s * (STEP * k as f64).exp();
            let cycle_rad_s = speed * TAU / engine.cycle_rad();
            let answers = OfEngine::of_cycle(model, mode, harmonics.len(), cycle_rad_s);
            let unloaded = Courses::of(&waves(&harmonics, |one| one.at(0.0, speed)), &answers, &circle, cycle_rad_s);
            let of_torque = waves(&harmonics, |one| Complex64::new(one.of_torque[0], one.of_torque[1]));
            let of_torque = Courses::of(&of_torque, &answers, &circle, cycle_rad_s);
            let point_s = TAU / cycle_rad_s / points as f64;
            std::array::from_fn(|j| unloaded.and(&of_torque, highest_nm * share_of_highest(j)).most(point_s))
        };
        Pulses { lowest_rad_s, highest_nm, table: (0..count).map(at).collect(), push: push(model, mode), varies }
    }

    /// Their additions at a mean torque of the engine: at the speed, the more of its two neighbours in the table.
    pub(crate) fn at(&self, engine_nm: f64, speed_rad_s: f64) -> Added {
        let place = self.place(speed_rad_s);
        self.at_torque(&or_more(&self.table[place.floor() as usize], &self.table[place.ceil() as usize]), engine_nm)
    }

    /// Their largest additions at any speed within so many places of the table about a speed; the last one holds all of
    /// the table.
    pub(crate) fn about(&self, speed_rad_s: f64) -> About<'_> {
        let place = self.place(speed_rad_s);
        let (low, high) = (place.floor() as usize, place.ceil() as usize);
        let mut most = or_more(&self.table[low], &self.table[high]);
        let mut within = vec![most];
        for k in 1..self.table.len() {
            let beside = [low.checked_sub(k), Some(high + k)].into_iter().flatten().filter_map(|at| self.table.get(at));
            most = beside.fold(most, |most, one| or_more(&most, one));
            within.push(most);
        }
        About { pulses: self, speed_rad_s, within }
    }

    fn place(&self, speed_rad_s: f64) -> f64 {
        ((speed_rad_s.abs() / self.lowest_rad_s).ln() / STEP).clamp(0.0, (self.table.len() - 1) as f64)
    }

    /// A firing that is stronger than the mean also pushes with more on the average. Where the charge without load and
    /// the torque are opposite, a weaker one makes the larger wave.
    fn at_torque(&self, levels: &Levels, engine_nm: f64) -> Added {
        let [weak, strong] = [-self.varies, self.varies].map(|part| self.between(levels, engine_nm * (1.0 + part)));
        weak.or_more(&strong).with(&self.push, |pulses, of_push| pulses + engine_nm.abs() * self.varies * of_push)
    }

    /// Straight between the torques of the table.
    fn between(&self, levels: &Levels, level_nm: f64) -> Added {
        let share = (level_nm / self.highest_nm).clamp(-1.0, 1.0);
        let octave = (share.abs().log2() + HALVES as f64).clamp(0.0, (HALVES - 1) as f64) as usize;
        let [from, to] = [octave, octave + 1].map(|k| share_of_highest(HALVES + k));
        let part = (share.abs() - from) / (to - from);
        let at = |k: usize| &levels[if share < 0.0 { HALVES - k } else { HALVES + k }];
        at(octave).with(at(octave + 1), |from, to| from + part * (to - from))
    }
}

/// A mean torque of the table over the highest one.
fn share_of_highest(level: usize) -> f64 {
    let from_none = level as i32 - HALVES as i32;
    match from_none {
        0 => 0.0,
        n => f64::from(n.signum()) * 0.5_f64.powi(HALVES as i32 - n.abs()),
    }
}

/// Additions of pulses about a speed.
pub(crate) struct About<'a> {
    pulses: &'a Pulses,
    speed_rad_s: f64,
    within: Vec<Levels>,
}

impl About<'_> {
    /// Their largest additions while the speed moves this far to both sides, and the mean torque of the engine between
    /// two.
    pub(crate) fn within(&self, reach_rad_s: f64, engine_nm: [f64; 2]) -> Added {
        // Downwards a speed goes further on the logarithmic table.
        let part = (reach_rad_s / self.speed_rad_s.max(f64::MIN_POSITIVE)).min(1.0 - f64::EPSILON);
        let places = (-(-part).ln_1p() / STEP).ceil();
        let levels = &self.within[(places as usize).min(self.within.len() - 1)];
        // What is convex is largest at an end.
        let [low, high] = engine_nm.map(|torque_nm| self.pulses.at_torque(levels, torque_nm));
        low.or_more(&high)
    }
}

/// Additions of a push of 1 Nm: it accelerates both ends, and the controller answers to that.
fn push(model: &BenchModel, mode: LoopMode) -> Added {
    let gradient = 1.0 / (model.mechanics.dyno_inertia_kg_m2 + model.mechanics.engine_inertia_kg_m2);
    let gain =
        model.speed_controller.filter(|_| mode == LoopMode::Speed).map_or(0.0, |pi| pi.proportional_nm_s_per_rad);
    Added {
        shaft_above_nm: 1.0,
        shaft_below_nm: 1.0,
        speed_gradient_rad_s2: gradient,
        demand_slew_nm_per_s: gain.abs() * gradient,
        ..Added::default()
    }
}

/// Waves of a cycle: harmonic of the cycle, and a part of its complex amplitude.
fn waves(harmonics: &[CycleHarmonic], of: impl Fn(&CycleHarmonic) -> Complex64) -> Vec<(usize, Complex64)> {
    (1..).zip(harmonics.iter().map(of)).filter(|(_, amplitude)| amplitude.norm() > 0.0).collect()
}

/// Response of a cycle to waves of the engine's torque, at each point of it.
struct Courses {
    shaft_nm: Vec<f64>,
    shaft_slope_nm_per_s: Vec<f64>,
    demand_nm: Vec<f64>,
    dyno_speed_rad_s: Vec<f64>,
    engine_speed_rad_s: Vec<f64>,
}

impl Courses {
    /// Of cycles with this frequency.
    fn of(waves: &[(usize, Complex64)], answers: &[OfEngine], circle: &[Complex64], cycle_rad_s: f64) -> Self {
        let course = |of: &dyn Fn(f64, &OfEngine) -> Complex64| {
            let part = |(m, wave): &(usize, Complex64)| (*m, wave * of(*m as f64 * cycle_rad_s, &answers[m - 1]));
            course(&waves.iter().map(part).collect::<Vec<_>>(), circle)
        };
        Courses {
            shaft_nm: course(&|_, answer| answer.shaft),
            shaft_slope_nm_per_s: course(&|omega, answer| answer.shaft * Complex64::new(0.0, omega)),
            demand_nm: course(&|_, answer| answer.demand),
            dyno_speed_rad_s: course(&|_, answer| answer.dyno_speed),
            engine_speed_rad_s: course(&|_, answer| answer.engine_speed),
        }
    }

    /// These and those of each Nm of a mean torque.
    fn and(&self, of_torque: &Courses, torque_nm: f64) -> Courses {
        let sum = |own: &[f64], of_torque: &[f64]| own.iter().zip(of_torque).map(|(a, b)| a + torque_nm * b).collect();
        Courses {
            shaft_nm: sum(&self.shaft_nm, &of_torque.shaft_nm),
            shaft_slope_nm_per_s: sum(&self.shaft_slope_nm_per_s, &of_torque.shaft_slope_nm_per_s),
            demand_nm: sum(&self.demand_nm, &of_torque.demand_nm),
            dyno_speed_rad_s: sum(&self.dyno_speed_rad_s, &of_torque.dyno_speed_rad_s),
            engine_speed_rad_s: sum(&self.engine_speed_rad_s, &of_torque.engine_speed_rad_s),
        }
    }

    /// The most that they add; their points are so far apart.
    fn most(&self, point_s: f64) -> Added {
        let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let mean_square = self.demand_nm.iter().map(|x| x * x).sum::<f64>() / self.demand_nm.len().max(1) as f64;
        Added {
            shaft_above_nm: self.shaft_nm.iter().copied().fold(0.0, f64::max),
            shaft_below_nm: -self.shaft_nm.iter().copied().fold(0.0, f64::min),
            shaft_slew_nm_per_s: most(&self.shaft_slope_nm_per_s),
            demand_nm: most(&self.demand_nm),
            demand_rms_nm: mean_square.sqrt(),
            demand_slew_nm_per_s: change(&self.demand_nm, TORQUE_CHANGE_S, point_s),
            dyno_speed_rad_s: most(&self.dyno_speed_rad_s),
            engine_speed_rad_s: most(&self.engine_speed_rad_s),
            speed_gradient_rad_s2: change(&self.dyno_speed_rad_s, SPEED_CHANGE_S, point_s),
        }
    }
}

/// The largest change within a time of what repeats each cycle, over that time.
fn change(values: &[f64], within_s: f64, point_s: f64) -> f64 {
    let apart = ((within_s / point_s).ceil() as usize).max(1);
    // Half a cycle holds the way from the lowest value to the highest, or back.
    let largest = if 2 * apart >= values.len() {
        values.iter().copied().fold(f64::MIN, f64::max) - values.iter().copied().fold(f64::MAX, f64::min)
    } else {
        largest_change(&[values, &values[..apart]].concat(), apart).0
    };
    largest / within_s.max(point_s)
}

/// The sum of some waves over a cycle.
fn course(waves: &[(usize, Complex64)], circle: &[Complex64]) -> Vec<f64> {
    let at = |k: usize| waves.iter().map(|(m, wave)| (wave * circle[m * k % circle.len()]).re).sum();
    (0..circle.len()).map(at).collect()
}

/// Frequency responses of a bench to T_e.
#[derive(Debug, Clone, Copy)]
struct OfEngine {
    shaft: Complex64,
    demand: Complex64,
    dyno_speed: Complex64,
    engine_speed: Complex64,
}

impl OfEngine {
    /// At so many harmonics of a cycle, the first first.
    fn of_cycle(model: &BenchModel, mode: LoopMode, harmonics: usize, cycle_rad_s: f64) -> Vec<Self> {
        (1..=harmonics).map(|m| OfEngine::at(model, mode, m as f64 * cycle_rad_s)).collect()
    }

    /// In speed control; in torque control, or where the model has no controller, T_d stays.
    fn at(model: &BenchModel, mode: LoopMode, omega_rad_s: f64) -> Self {
        let mechanics = &model.mechanics;
        let controlled = || {
            let (pi, control) = (model.speed_controller?, model.torque_control?);
            let speed = model.engine_to_speed_controlled(omega_rad_s)?;
            let demand = speed * mean_over(model.encoder_gate_s, omega_rad_s) * pi.response(omega_rad_s);
            let braking = demand * pi.hold(omega_rad_s) * control.response(omega_rad_s);
            Some((speed, demand, braking * mechanics.torque_to_shaft(omega_rad_s)))
        };
        let free = (mechanics.engine_to_speed(omega_rad_s), Complex64::default(), Complex64::default());
        let (dyno_speed, demand, braked) = if mode == LoopMode::Speed { controlled().unwrap_or(free) } else { free };
        let shaft = mechanics.engine_to_shaft(omega_rad_s) + braked;
        let turned = Complex64::new(0.0, omega_rad_s * mechanics.engine_inertia_kg_m2);
        OfEngine { shaft, demand, dyno_speed, engine_speed: (1.0 - shaft) / turned }
    }
}
