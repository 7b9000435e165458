//! The system's own shaft torque.

use std::collections::VecDeque;

/// The system's own shaft torque: J_d times the difference quotient of the moving average of N_d, plus T_d,calc.
#[derive(Debug, Clone)]
pub(crate) struct SystemShaftTorque {
    dyno_inertia_kg_m2: f64,
    update_s: f64,
    length: usize,
    /// Measured speeds of the last N updates before now, the newest last.
    speeds_rad_s: VecDeque<f64>,
}

impl SystemShaftTorque {
    pub(crate) fn new(dyno_inertia_kg_m2: f64, update_s: f64, length: usize, speed_rad_s: f64) -> Self {
        Self { dyno_inertia_kg_m2, update_s, length, speeds_rad_s: VecDeque::from(vec![speed_rad_s; length]) }
    }

    /// One update with the measured speed and T_d,calc; returns the shaft torque, Nm. The average changes by
    /// (N_d,k − N_d,k−N)/N from one update to the next.
    pub(crate) fn update(&mut self, speed_rad_s: f64, calc_torque_nm: f64) -> f64 {
        let oldest_rad_s = self.speeds_rad_s.pop_front().unwrap_or(speed_rad_s);
        self.speeds_rad_s.push_back(speed_rad_s);
        let acceleration_rad_s2 = (speed_rad_s - oldest_rad_s) / (self.length as f64 * self.update_s);
        self.dyno_inertia_kg_m2 * acceleration_rad_s2 + calc_torque_nm
    }
}
