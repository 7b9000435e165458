//! The firing pulses of an engine, at the angle that its crank has.

use numerics::random::Stream;
use rig::bench_parameters::EngineParameters;
use rig::random::Source;

use super::plant::Plant;
use crate::pulse_shape::PulseShape;

/// An engine whose torque comes in pulses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FiringEngine<'a> {
    /// Its cylinders and pulses, see [`EngineParameters`].
    pub engine: &'a EngineParameters,
    /// Seed of the angle at the start, which nobody knows, and of what varies from cycle to cycle.
    pub seed: u64,
    /// True where the dynamometer drags it: every pulse is then the same, with the share of a motored engine.
    pub is_motored: bool,
}

/// The engine, firing by firing: the torque that each [`PulseShape`] has, its level T_j the level at the firing times
/// the factor of the cylinder and what varies from cycle to cycle.
///
/// The angle must be that of the crank which the pulses themselves move. At the angle of a crank without pulses, a
/// shaft near its resonance would get pulses of another phase: on the default virtual bench up to 10 Nm too much at 600
/// rpm, and mean torques up to 3 Nm too high.
pub(super) struct Firings<'a> {
    engine: &'a EngineParameters,
    is_motored: bool,
    random: Stream,
    step_s: f64,
    interval_rad: f64,
    start_rad: f64,
    next_rad: f64,
    cylinder: usize,
    shape: PulseShape,
}

impl<'a> Firings<'a> {
    /// The engine running at a torque level and a speed.
    pub(super) fn new(
        FiringEngine { engine, seed, is_motored }: &FiringEngine<'a>,
        level_nm: f64,
        speed_rad_s: f64,
        step_s: f64,
    ) -> Self {
        let interval_rad = engine.cycle_rad() / engine.cylinder_factors.len().max(1) as f64;
        let start_rad = engine.cycle_rad() * Source::StartAngle.stream(*seed).between(0.0, 1.0);
        Firings {
            engine,
            is_motored: *is_motored,
            random: Source::Firing.stream(*seed),
            step_s,
            interval_rad,
            start_rad,
            next_rad: ((start_rad / interval_rad).floor() + 1.0) * interval_rad,
            cylinder: engine.cylinder_at(start_rad),
            shape: PulseShape::of(engine, share(engine, *is_motored), (level_nm, speed_rad_s)),
        }
    }

    /// T_e at both ends of the next interval, Nm: the straight line with the impulse of the pulses, which bend within a
    /// sample and jump where a cylinder fires. The angle is that of the acceleration now; the impulse of the bend by
    /// Simpson's rule.
    pub(super) fn over(&mut self, plant: &Plant<'_>, level_nm: f64) -> [f64; 2] {
        let motion = plant.state();
        let from = self.start_rad + motion.engine_angle_rad;
        let now_nm = self.shape.at(from);
        let acceleration = plant.engine_acceleration_rad_s2(now_nm);
        let after = |time_s: f64| from + (motion.engine_speed_rad_s + 0.5 * acceleration * time_s) * time_s;
        let to = after(self.step_s);
        let half_nm = self.shape.at(after(0.5 * self.step_s));
        let end_nm = self.shape.at(to);
        let mut added_nm = (2.0 * half_nm - now_nm - end_nm) / 3.0;
        while to >= self.next_rad && to > from {
            let remaining = (to - self.next_rad) / (to - from);
            let middle = 0.5 * (self.next_rad + to);
            let before_nm = self.shape.at(middle);
            self.fire(level_nm, motion.engine_speed_rad_s);
            added_nm += (self.shape.at(middle) - before_nm) * remaining;
        }
        [now_nm + added_nm, end_nm + added_nm]
    }

    /// The next cylinder takes over.
    fn fire(&mut self, level_nm: f64, speed_rad_s: f64) {
        self.cylinder = (self.cylinder + 1) % self.engine.cylinder_factors.len().max(1);
        self.next_rad += self.interval_rad;
        let strength = if self.is_motored { 1.0 } else { self.strength() };
        self.shape =
            PulseShape::of(self.engine, share(self.engine, self.is_motored), (level_nm * strength, speed_rad_s));
    }

    /// How strong a firing is: the cylinder, which harmonics of the working cycle have in them, and what varies from
    /// cycle to cycle.
    fn strength(&mut self) -> f64 {
        let is_of_cycle = !self.engine.cycle_harmonics.is_empty();
        let factor = self.engine.cylinder_factors.get(self.cylinder).filter(|_| !is_of_cycle).copied().unwrap_or(1.0);
        factor * (1.0 + self.engine.cycle_variation * self.random.normal())
    }
}

/// p of an engine.
fn share(engine: &EngineParameters, is_motored: bool) -> f64 {
    if is_motored { engine.motored_pulsation } else { 1.0 }
}
