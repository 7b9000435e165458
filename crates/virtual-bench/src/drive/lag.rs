//! The drive's closed torque loop as a lag.

use std::collections::VecDeque;

use crate::drive::timed::TimedDemand;

/// T = a/(s + a) T_d*, exact for a demand that is constant between its changes, whenever these come.
#[derive(Debug, Clone)]
pub(super) struct Lag {
    bandwidth_rad_s: f64,
    held_nm: f64,
    torque_nm: f64,
}

impl Lag {
    /// The loop at rest at a torque.
    pub(super) fn new(bandwidth_rad_s: f64, torque_nm: f64) -> Self {
        Self { bandwidth_rad_s, held_nm: torque_nm, torque_nm }
    }

    /// Torque at `end_s`, Nm, where the last call ended at `start_s`; takes the demands that come before.
    pub(super) fn advance(&mut self, on_the_way: &mut VecDeque<TimedDemand>, start_s: f64, end_s: f64) -> f64 {
        let mut now_s = start_s;
        while let Some(&next) = on_the_way.front().filter(|next| next.time_s < end_s) {
            on_the_way.pop_front();
            self.relax((next.time_s - now_s).max(0.0));
            now_s = next.time_s.max(now_s);
            self.held_nm = next.torque_nm;
        }
        self.relax(end_s - now_s);
        self.torque_nm
    }

    fn relax(&mut self, duration_s: f64) {
        let decay = (-self.bandwidth_rad_s * duration_s).exp();
        self.torque_nm = self.held_nm + (self.torque_nm - self.held_nm) * decay;
    }
}
