//! The angle of a shaft end over the last gate.

use std::collections::VecDeque;

use crate::cubic;

/// Part of a step below which a time counts as a whole number of steps.
pub(super) const WHOLE: f64 = 1e-6;

/// Angle and speed of one shaft end over the last gate, on the fine grid of the simulation.
#[derive(Debug, Clone)]
pub(crate) struct Rotation {
    step_s: f64,
    /// (rad, rad/s), the newest last.
    points: VecDeque<(f64, f64)>,
}

impl Rotation {
    /// The shaft end turning at a constant speed up to now.
    pub(crate) fn new(gate_s: f64, step_s: f64, angle_rad: f64, speed_rad_s: f64) -> Self {
        let steps = (gate_s / step_s).ceil() as usize + 2;
        let past = |back: usize| (angle_rad - back as f64 * step_s * speed_rad_s, speed_rad_s);
        Self { step_s, points: (0..=steps).rev().map(past).collect() }
    }

    /// One step on.
    pub(crate) fn advance(&mut self, angle_rad: f64, speed_rad_s: f64) {
        self.points.pop_front();
        self.points.push_back((angle_rad, speed_rad_s));
    }

    /// Speed now, rad/s.
    pub(super) fn speed_rad_s(&self) -> f64 {
        self.points.back().map_or(0.0, |(_, speed_rad_s)| *speed_rad_s)
    }

    /// Angle a while ago, rad, by the cubic through two points and their slopes.
    pub(super) fn angle_before_rad(&self, age_s: f64) -> f64 {
        let newest = self.points.len() - 1;
        let age = (age_s / self.step_s).clamp(0.0, newest as f64);
        let nearest = age.round();
        if (age - nearest).abs() < WHOLE {
            return self.points[newest - nearest as usize].0;
        }
        let left = newest - age.ceil() as usize;
        let u = age.ceil() - age;
        let point = |k: usize| (self.points[k].0, self.points[k].1 * self.step_s);
        cubic::between(point(left), point(left + 1), u)
    }
}
