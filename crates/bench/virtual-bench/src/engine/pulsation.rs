//! The engine's torque as harmonics of the firing order or of the working cycle.

use bench_model::pulse_shape::PulseShape;
use numerics::random::Stream;
use rig::bench_parameters::EngineParameters;
use rig::random::Source;

use crate::engine::pulse::Pulse;
use crate::engine::step::{Combustion, EngineStep};
use crate::train::{Jump, Train};

/// The engine's torque, firing by firing.
#[derive(Debug, Clone)]
pub(crate) struct Pulsation {
    parameters: EngineParameters,
    combustion: Combustion,
    random: Stream,
    /// Crank angle from one firing to the next, rad.
    firing_interval_rad: f64,
    next_firing_rad: f64,
    cylinder: usize,
    firing_torque_nm: f64,
    pulse: Pulse,
    /// In place of the pulse, where the engine has harmonics of the working cycle.
    of_cycle: Option<PulseShape>,
}

impl Pulsation {
    /// The engine at a crank angle, running at a torque level.
    pub(super) fn new(
        parameters: &EngineParameters,
        combustion: Combustion,
        seed: u64,
        angle_rad: f64,
        level_nm: f64,
        speed_rad_s: f64,
    ) -> Self {
        let interval_rad = parameters.cycle_rad() / parameters.cylinder_factors.len() as f64;
        let size = if combustion == Combustion::Fired { 1.0 } else { parameters.motored_pulsation };
        Self {
            combustion,
            random: Source::Firing.stream(seed),
            firing_interval_rad: interval_rad,
            next_firing_rad: ((angle_rad / interval_rad).floor() + 1.0) * interval_rad,
            cylinder: parameters.cylinder_at(angle_rad),
            firing_torque_nm: level_nm,
            pulse: Pulse::new(&parameters.firing_harmonics, size, interval_rad),
            of_cycle: of_cycle(parameters, combustion, (level_nm, speed_rad_s)),
            parameters: parameters.clone(),
        }
    }

    /// Torque now, Nm.
    pub(super) fn now_nm(&self, train: &Train) -> f64 {
        self.torque_nm(train.engine_angle_rad())
    }

    /// Torque at a crank angle, Nm.
    fn torque_nm(&self, angle_rad: f64) -> f64 {
        match &self.of_cycle {
            Some(shape) => shape.at(angle_rad),
            None => self.firing_torque_nm * self.pulse.at(angle_rad),
        }
    }

    /// The torque over the next step, with the crank's angle predicted to second order; `level_nm` is used where a
    /// cylinder fires within the step.
    pub(super) fn step(&mut self, train: &Train, step_s: f64, level_nm: f64) -> EngineStep {
        let (angle_rad, speed) = (train.engine_angle_rad(), train.engine_speed_rad_s());
        let start_nm = self.torque_nm(angle_rad);
        let acceleration = train.engine_acceleration_rad_s2(start_nm);
        let turned = |time_s: f64| (speed + 0.5 * acceleration * time_s) * time_s;
        let end_nm = self.torque_nm(angle_rad + turned(step_s));
        let to_firing_rad = self.next_firing_rad - angle_rad;
        let firing = (turned(step_s) >= to_firing_rad && speed > 0.0).then(|| {
            let first_guess_s = (to_firing_rad / speed).clamp(0.0, step_s);
            let mean_speed = speed + 0.5 * acceleration * first_guess_s;
            let time_s = (to_firing_rad / mean_speed).clamp(0.0, step_s);
            Jump { remaining_s: step_s - time_s, jump_nm: self.fire(level_nm, speed) }
        });
        EngineStep { start_nm, end_nm, firing }
    }

    /// The next cylinder takes over; returns the jump of the torque, Nm.
    fn fire(&mut self, level_nm: f64, speed_rad_s: f64) -> f64 {
        let before_nm = self.torque_nm(self.next_firing_rad);
        self.cylinder = (self.cylinder + 1) % self.parameters.cylinder_factors.len();
        self.firing_torque_nm = match self.combustion {
            Combustion::Motored | Combustion::Stopped => level_nm,
            Combustion::Fired => {
                let factor = self.of_cycle.as_ref().map_or(self.parameters.cylinder_factors[self.cylinder], |_| 1.0);
                level_nm * factor * (1.0 + self.parameters.cycle_variation * self.random.normal())
            }
        };
        self.of_cycle = of_cycle(&self.parameters, self.combustion, (self.firing_torque_nm, speed_rad_s));
        let jump_nm = self.torque_nm(self.next_firing_rad) - before_nm;
        self.next_firing_rad += self.firing_interval_rad;
        jump_nm
    }
}

/// The torque of a firing over the angle, of an engine that turns and has harmonics of the working cycle.
fn of_cycle(parameters: &EngineParameters, combustion: Combustion, firing: (f64, f64)) -> Option<PulseShape> {
    let is_of_cycle = combustion != Combustion::Stopped && !parameters.cycle_harmonics.is_empty();
    is_of_cycle.then(|| PulseShape::of(parameters, 1.0, firing))
}
