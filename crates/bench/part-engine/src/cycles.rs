//! The engine's torque by cycle and by cylinder.
//!
//! A cylinder's part of the cycle is from one trough of the firing order to the next; a bench without a mark of top
//! dead centre does not show which cylinder it is, only the order in which they fire. The mean torque over such a part
//! is the change of J_d ω_d + J_e ω_e over its length and the mean of T_d, and so is its uncertainty.

use std::f64::consts::{PI, TAU};

use numerics::null::nan_if_null;
use numerics::vector::dot;
use rig::facts::Engine;
use rig::results::Reason;
use serde::{Deserialize, Serialize};
use signal::{Complex64, distributions};

use super::rebuild::{ENCODER_ERROR, Motion, RebuiltEngine};

/// Samples that a firing interval must have.
const FEWEST_SAMPLES: f64 = 6.0;
/// Cycles that are needed.
const FEWEST_CYCLES: usize = 10;
/// Left out at both ends, s, where the smoother knows one side alone.
const EDGE_S: f64 = 0.2;
/// Angles of the mean cycle.
const ANGLES: usize = 180;
/// The highest order that is separated, in firing orders.
const HIGHEST: f64 = 2.0;

/// The engine's torque over the cycles of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Cycles {
    /// All whole cycles.
    pub cycles: Vec<Cycle>,
    /// Standard deviation of the cycles' means beyond what their own uncertainty explains, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub variation_nm: f64,
    /// The cylinders.
    pub cylinders: Cylinders,
    /// Orders of the crankshaft.
    pub orders: Vec<Order>,
    /// The torque over the crank's angle.
    pub profile: Profile,
}

/// The torque over the crank's angle, from a trough of the firing order on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Profile {
    /// Between angles, °.
    #[serde(deserialize_with = "nan_if_null")]
    pub step_deg: f64,
    /// Mean of all cycles, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub mean_nm: Vec<f64>,
    /// Standard deviation from cycle to cycle, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub deviation_nm: Vec<f64>,
}

/// One cycle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Cycle {
    /// Start, s of the clock of N_d.
    #[serde(deserialize_with = "nan_if_null")]
    pub start_s: f64,
    /// Length, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub duration_s: f64,
    /// Mean torque, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub mean_nm: f64,
    /// Its standard deviation by noise, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_deviation_nm: f64,
}

/// The cylinders, in the order in which they fire.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Cylinders {
    /// Each one.
    pub cylinders: Vec<Cylinder>,
    /// How probable it is that they differ so much by chance.
    #[serde(deserialize_with = "nan_if_null")]
    pub alike_probability: f64,
    /// Part of the difference that comes back with every turn.
    pub once_a_turn: CylindersOnceATurn,
}

/// The part of the cylinders' difference that comes back with every turn, as a once-a-turn error of the engine's
/// encoder does.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CylindersOnceATurn {
    /// Its root mean square over the cylinders, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub rms_nm: f64,
    /// The error of the encoder, of the speed, that would make it alone.
    #[serde(deserialize_with = "nan_if_null")]
    pub encoder_error: f64,
    /// How probable it is that cylinders differ as much as they do beyond it by chance; none where nothing is beyond
    /// it.
    pub alike_probability: Option<f64>,
}

/// A cylinder over all cycles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Cylinder {
    /// Mean torque over its part of the cycle less the cycle's, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub apart_nm: f64,
    /// Standard error by how cycles differ, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_error_nm: f64,
    /// Standard deviation that a once-a-turn error of the engine's encoder brings, Nm: as large as what comes back with
    /// every turn, and that of an error of 10⁻⁴ of the speed.
    #[serde(deserialize_with = "nan_if_null")]
    pub encoder_nm: f64,
    /// Standard deviation from cycle to cycle, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub variation_nm: f64,
}

impl Cylinder {
    /// Standard error of noise and encoder together, Nm.
    #[must_use]
    pub fn whole_error_nm(&self) -> f64 {
        self.standard_error_nm.hypot(self.encoder_nm)
    }
}

/// An order of the crankshaft in T_e: a cosine of the crank's angle that every cycle has alike.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Order {
    /// Order.
    #[serde(deserialize_with = "nan_if_null")]
    pub order: f64,
    /// Amplitude, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub amplitude_nm: f64,
    /// Standard error, Nm, from how cycles differ.
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_error_nm: f64,
}

/// The torque by cycle and cylinder.
///
/// # Errors
/// Firings too fast for the rate of N_d, or too few cycles.
pub(super) fn of(engine: &RebuiltEngine, motion: &Motion, kind: Engine) -> Result<Cycles, Reason> {
    let crank = Crank::new(engine, motion);
    let turns_a_cycle = 0.5 * f64::from(kind.strokes);
    let turn_s = TAU / crank.mean_speed_rad_s().max(f64::MIN_POSITIVE);
    let firing_s = turn_s / kind.firings_per_turn();
    if firing_s < FEWEST_SAMPLES * engine.sample_time_s {
        return Err(Reason::FiringsTooFast {
            firing_s,
            needed_hz: FEWEST_SAMPLES / firing_s,
            rate_hz: 1.0 / engine.sample_time_s,
        });
    }
    let parts = crank.parts(kind.firings_per_turn());
    let cylinders = kind.cylinders as usize;
    let whole = parts.chunks_exact(cylinders);
    if whole.len() < FEWEST_CYCLES {
        let needed_s = FEWEST_CYCLES as f64 * turns_a_cycle * turn_s + 2.0 * EDGE_S;
        return Err(Reason::TooFewCycles { found: whole.len(), needed: FEWEST_CYCLES, needed_s });
    }
    let cycles: Vec<Cycle> = whole.clone().map(|parts| crank.cycle(parts)).collect();
    let apart: Vec<Vec<f64>> = whole.clone().zip(&cycles).map(|(parts, cycle)| crank.apart(parts, cycle)).collect();
    let orders = (1..=(HIGHEST * f64::from(kind.cylinders)) as usize).map(|k| k as f64 / turns_a_cycle);
    Ok(Cycles {
        variation_nm: variation(&cycles),
        cylinders: compared(&apart, 1.0 / kind.firings_per_turn(), engine.once_a_turn_nm),
        orders: orders.map(|order| crank.order(order, whole.clone())).collect(),
        profile: crank.profile(360.0 * turns_a_cycle, whole.clone()),
        cycles,
    })
}

/// Torque and motion over the crank's angle.
struct Crank<'a> {
    engine: &'a RebuiltEngine,
    motion: &'a Motion,
    /// How far the crank has turned at every instant, either way, rad.
    angle_rad: Vec<f64>,
}

/// From one instant to another, in samples.
type Part = (f64, f64);

impl<'a> Crank<'a> {
    fn new(engine: &'a RebuiltEngine, motion: &'a Motion) -> Self {
        let mut turned = 0.0;
        let steps = motion.engine_speed_rad_s.windows(2).map(|pair| {
            turned += 0.5 * (pair[0] + pair[1]).abs() * engine.sample_time_s;
            turned
        });
        let angle_rad = std::iter::once(0.0).chain(steps).collect();
        Crank { engine, motion, angle_rad }
    }

    fn mean_speed_rad_s(&self) -> f64 {
        let duration = (self.angle_rad.len() - 1) as f64 * self.engine.sample_time_s;
        self.angle_rad[self.angle_rad.len() - 1] / duration
    }

    /// The instants from one trough of an order to the next.
    fn parts(&self, order: f64) -> Vec<Part> {
        let turn = |k: usize| Complex64::from_polar(1.0, -order * self.angle_rad[k]);
        let phase = (0..self.angle_rad.len()).map(|k| turn(k) * self.engine.smoothed_nm[k]).sum::<Complex64>().arg();
        // order · angle + phase is an odd multiple of π at a trough.
        let place = |k: usize| (order * self.angle_rad[k] + phase) / TAU - 0.5;
        let edge = (EDGE_S / self.engine.sample_time_s) as usize;
        let mut troughs = Vec::new();
        for k in edge..self.angle_rad.len().saturating_sub(edge + 1) {
            let (before, after) = (place(k), place(k + 1));
            if after.floor() > before.floor() {
                troughs.push(k as f64 + (after.floor() - before) / (after - before));
            }
        }
        troughs.windows(2).map(|pair| (pair[0], pair[1])).collect()
    }

    fn mean_nm(&self, (from, to): Part) -> f64 {
        (self.impulse(to) - self.impulse(from)) / ((to - from) * self.engine.sample_time_s)
    }

    /// The integral of T_e up to a place between samples: the cubic that has its values and T_e as its slope there.
    fn impulse(&self, place: f64) -> f64 {
        let at = (place.floor() as usize).min(self.angle_rad.len() - 2);
        let (t, step) = (place - at as f64, self.engine.sample_time_s);
        let (before, after) = (self.motion.impulse[at], self.motion.impulse[at + 1]);
        let (rising, to) = (step * self.engine.smoothed_nm[at], step * self.engine.smoothed_nm[at + 1]);
        let bend = 3.0 * (after - before) - 2.0 * rising - to;
        before + t * (rising + t * (bend + t * (rising + to - 2.0 * (after - before))))
    }

    fn variance(&self, (from, to): Part) -> f64 {
        let duration_s = (to - from) * self.engine.sample_time_s;
        let ends = between(&self.motion.momentum_variance, from) + between(&self.motion.momentum_variance, to);
        ends / (duration_s * duration_s) + self.motion.torque_density / duration_s
    }

    fn cycle(&self, parts: &[Part]) -> Cycle {
        let whole = (parts[0].0, parts[parts.len() - 1].1);
        Cycle {
            start_s: self.engine.start_s + whole.0 * self.engine.sample_time_s,
            duration_s: (whole.1 - whole.0) * self.engine.sample_time_s,
            mean_nm: self.mean_nm(whole),
            standard_deviation_nm: self.variance(whole).sqrt(),
        }
    }

    /// Each cylinder's mean less the cycle's.
    fn apart(&self, parts: &[Part], cycle: &Cycle) -> Vec<f64> {
        parts.iter().map(|part| self.mean_nm(*part) - cycle.mean_nm).collect()
    }

    /// The order's amplitude, as the mean over cycles of 2/Δ ∫ T_e e^{−i order angle} dangle.
    fn order<'b>(&self, order: f64, cycles: impl Iterator<Item = &'b [Part]>) -> Order {
        let of_cycle = |parts: &[Part]| {
            let (from, to) = (parts[0].0.ceil() as usize, parts[parts.len() - 1].1.floor() as usize);
            let (mut sum, mut turned) = (Complex64::default(), 0.0);
            for k in from..to {
                let angle = 0.5 * (self.angle_rad[k] + self.angle_rad[k + 1]);
                let step = self.angle_rad[k + 1] - self.angle_rad[k];
                let torque = 0.5 * (self.engine.smoothed_nm[k] + self.engine.smoothed_nm[k + 1]);
                sum += Complex64::from_polar(torque * step, -order * angle);
                turned += step;
            }
            2.0 * sum / turned
        };
        let all: Vec<Complex64> = cycles.map(of_cycle).collect();
        let count = all.len() as f64;
        let mean = all.iter().sum::<Complex64>() / count;
        // Of the part along the mean: amplitudes do not care for the phase.
        let along = |z: &Complex64| (z * mean.conj()).re / mean.norm().max(f64::MIN_POSITIVE) - mean.norm();
        let variance = all.iter().map(|z| along(z).powi(2)).sum::<f64>() / (count - 1.0);
        Order { order, amplitude_nm: mean.norm(), standard_error_nm: (variance / count).sqrt() }
    }

    /// The torque at equal angles of every cycle.
    fn profile<'b>(&self, cycle_deg: f64, cycles: impl Iterator<Item = &'b [Part]>) -> Profile {
        let (mut sums, mut squares, mut count) = (vec![0.0; ANGLES], vec![0.0; ANGLES], 0.0);
        for parts in cycles {
            let ends = (parts[0].0, parts[parts.len() - 1].1);
            let (from, to) = (between(&self.angle_rad, ends.0), between(&self.angle_rad, ends.1));
            let mut at = ends.0 as usize;
            for k in 0..ANGLES {
                let angle = from + (to - from) * k as f64 / ANGLES as f64;
                while self.angle_rad[at + 1] < angle {
                    at += 1;
                }
                let part = (angle - self.angle_rad[at]) / (self.angle_rad[at + 1] - self.angle_rad[at]);
                let torque = between(&self.engine.smoothed_nm, at as f64 + part);
                sums[k] += torque;
                squares[k] += torque * torque;
            }
            count += 1.0;
        }
        let mean_nm: Vec<f64> = sums.iter().map(|sum| sum / count).collect();
        let spread = |(square, mean): (&f64, &f64)| (square / count - mean * mean).max(0.0).sqrt();
        let deviation_nm = squares.iter().zip(&mean_nm).map(spread).collect();
        Profile { step_deg: cycle_deg / ANGLES as f64, mean_nm, deviation_nm }
    }
}

/// A value between samples.
fn between(values: &[f64], place: f64) -> f64 {
    let at = (place.floor() as usize).min(values.len() - 2);
    values[at] + (place - at as f64) * (values[at + 1] - values[at])
}

/// Scatter of the cycles' means that is left when their own uncertainty is taken out. Neighbours are compared, since
/// the level may change over the recording: the variance is half that of the difference.
fn variation(cycles: &[Cycle]) -> f64 {
    let pairs = (cycles.len() - 1) as f64;
    let squares = cycles.windows(2).map(|pair| (pair[1].mean_nm - pair[0].mean_nm).powi(2)).sum::<f64>();
    let own = cycles.iter().map(|cycle| cycle.standard_deviation_nm.powi(2)).sum::<f64>() / cycles.len() as f64;
    (0.5 * squares / pairs - own).max(0.0).sqrt()
}

/// Cylinders over cycles: two-way analysis of variance without interaction, cycles as blocks; once with all that
/// differs, once without what comes back with every turn. `turns` is from one firing to the next, `once_a_turn_nm` what
/// an error of the encoder of 10⁻⁴ makes.
fn compared(rows: &[Vec<f64>], turns: f64, once_a_turn_nm: f64) -> Cylinders {
    let (count, cylinders) = (rows.len() as f64, rows[0].len());
    let of_cylinder = |c: usize| {
        let mean = rows.iter().map(|row| row[c]).sum::<f64>() / count;
        let variance = rows.iter().map(|row| (row[c] - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let standard_error_nm = (variance / count).sqrt();
        Cylinder { apart_nm: mean, standard_error_nm, encoder_nm: 0.0, variation_nm: variance.sqrt() }
    };
    let mut all: Vec<Cylinder> = (0..cylinders).map(of_cylinder).collect();
    let apart: Vec<f64> = all.iter().map(|c| c.apart_nm).collect();
    let freedom = cylinders as f64 - 1.0;
    let within = (count - 1.0) * all.iter().map(|c| c.variation_nm.powi(2)).sum::<f64>() / (freedom * (count - 1.0));
    let alike = |squares: f64, degrees: f64| {
        (degrees > 0.0)
            .then(|| distributions::f_tail(count * squares / degrees / within, degrees, freedom * (count - 1.0)))
    };
    let patterns = once_a_turn(cylinders, turns);
    let whole: f64 = apart.iter().map(|a| a * a).sum();
    let of_turn: f64 = patterns.iter().map(|pattern| dot(pattern, &apart).powi(2)).sum();
    let rms_nm = (of_turn / cylinders as f64).sqrt();
    // A cosine of amplitude A over a cylinder's part has the mean A sinc(turns) at its middle.
    let part = (PI * turns).sin().abs() / (PI * turns);
    if !patterns.is_empty() {
        let least = part * once_a_turn_nm / 2f64.sqrt();
        all.iter_mut().for_each(|cylinder| cylinder.encoder_nm = rms_nm.hypot(least));
    }
    Cylinders {
        cylinders: all,
        alike_probability: alike(whole, freedom).unwrap_or(1.0),
        once_a_turn: CylindersOnceATurn {
            rms_nm,
            encoder_error: ENCODER_ERROR * 2f64.sqrt() * rms_nm / (part * once_a_turn_nm).max(f64::MIN_POSITIVE),
            alike_probability: alike((whole - of_turn).max(0.0), freedom - patterns.len() as f64),
        },
    }
}

/// Orthonormal patterns over the cylinders that come back with every turn, without their mean: two, one, or none.
fn once_a_turn(cylinders: usize, turns: f64) -> Vec<Vec<f64>> {
    let mut patterns: Vec<Vec<f64>> = Vec::new();
    for quarter in [0.0, 0.25] {
        let mut pattern: Vec<f64> = (0..cylinders).map(|c| (TAU * (c as f64 * turns + quarter)).cos()).collect();
        let mean = pattern.iter().sum::<f64>() / cylinders as f64;
        pattern.iter_mut().for_each(|p| *p -= mean);
        for other in &patterns {
            let along = dot(&pattern, other);
            pattern.iter_mut().zip(other).for_each(|(p, o)| *p -= along * o);
        }
        let length = dot(&pattern, &pattern).sqrt();
        if length > 1e-6 {
            pattern.iter_mut().for_each(|p| *p /= length);
            patterns.push(pattern);
        }
    }
    patterns
}
