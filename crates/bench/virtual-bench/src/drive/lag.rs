//! The drive's closed torque loop as a lag.

use std::collections::VecDeque;

use crate::drive::timed::TimedDemand;

/// T = a/(s + a) T_d*, exact for a demand that is constant between its changes, whenever these come.
#[derive(Debug, Clone)]
pub(super) struct Lag {
    bandwidth_rad_s: f64,
    /// Part of a difference that is left after a step in which the demand stays.
    left_of_a_step: f64,
    held_nm: f64,
    torque_nm: f64,
}

impl Lag {
    /// The loop at rest at a torque, for steps of a length.
    pub(super) fn new(bandwidth_rad_s: f64, torque_nm: f64, step_s: f64) -> Self {
        let left_of_a_step = (-bandwidth_rad_s * step_s).exp();
        Self { bandwidth_rad_s, left_of_a_step, held_nm: torque_nm, torque_nm }
    }

    /// Torque at `end_s`, Nm, a step after the last call, which ended at `start_s`; takes the demands that come before.
    pub(super) fn advance(&mut self, on_the_way: &mut VecDeque<TimedDemand>, start_s: f64, end_s: f64) -> f64 {
        let (mut now_s, mut left) = (start_s, self.left_of_a_step);
        while let Some(&next) = on_the_way.front().filter(|next| next.time_s < end_s) {
            on_the_way.pop_front();
            self.relax(self.left_after((next.time_s - now_s).max(0.0)));
            now_s = next.time_s.max(now_s);
            self.held_nm = next.torque_nm;
            left = self.left_after(end_s - now_s);
        }
        self.relax(left);
        self.torque_nm
    }

    /// Part of a difference that is left after a time.
    fn left_after(&self, duration_s: f64) -> f64 {
        (-self.bandwidth_rad_s * duration_s).exp()
    }

    fn relax(&mut self, left: f64) {
        self.torque_nm = self.held_nm + (self.torque_nm - self.held_nm) * left;
    }
}
