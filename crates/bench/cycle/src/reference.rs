//! A cycle in speeds and torques.

use serde::{Deserialize, Serialize};

/// Demand of a cycle, straight between its points.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Time of the first value, s.
    pub start_s: f64,
    /// Time between values, s: that of the regulations is 1 s.
    pub step_s: f64,
    /// Speed, rad/s.
    pub speed_rad_s: Vec<f64>,
    /// Torque at the engine's flywheel, Nm; negative where the engine is motored.
    pub torque_nm: Vec<f64>,
    /// Values that limits in per cent refer to.
    pub scales: Scales,
}

/// Values that limits in per cent refer to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Scales {
    /// Warm idle speed, rad/s.
    pub idle_rad_s: f64,
    /// Maximum test speed, rad/s.
    pub maximum_test_speed_rad_s: f64,
    /// Largest torque of the map, Nm.
    pub maximum_torque_nm: f64,
    /// Largest power of the map, W.
    pub maximum_power_w: f64,
}

impl Reference {
    /// A reference with a value each second, whose scales are its own extremes: the lowest speed counts as idle.
    pub fn of_itself(start_s: f64, speed_rad_s: Vec<f64>, torque_nm: Vec<f64>) -> Self {
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let power: Vec<f64> = speed_rad_s.iter().zip(&torque_nm).map(|(n, t)| n * t).collect();
        let scales = Scales {
            idle_rad_s: speed_rad_s.iter().fold(f64::INFINITY, |least, value| least.min(value.abs())),
            maximum_test_speed_rad_s: largest(&speed_rad_s),
            maximum_torque_nm: largest(&torque_nm),
            maximum_power_w: largest(&power),
        };
        Reference { start_s, step_s: 1.0, speed_rad_s, torque_nm, scales }
    }

    /// Time of the last value, s.
    pub fn end_s(&self) -> f64 {
        self.start_s + self.speed_rad_s.len().saturating_sub(1) as f64 * self.step_s
    }

    /// Times from the first value on, second by second, s.
    pub fn seconds(&self) -> impl Iterator<Item = f64> + '_ {
        let count =
            if self.speed_rad_s.is_empty() { 0 } else { (self.end_s() - self.start_s + 1e-6).floor() as usize + 1 };
        (0..count).map(|second| self.start_s + second as f64)
    }

    /// Speed at any time, rad/s: straight between the points, as 40 CFR 1065.512 asks of commands at 5 Hz or more.
    pub fn speed_at(&self, time_s: f64) -> f64 {
        self.between(&self.speed_rad_s, time_s)
    }

    /// Torque at any time, Nm, straight between the points.
    pub fn torque_at(&self, time_s: f64) -> f64 {
        self.between(&self.torque_nm, time_s)
    }

    /// Work of the positive power, J.
    pub fn work_j(&self) -> f64 {
        self.step_s * self.speed_rad_s.iter().zip(&self.torque_nm).map(|(n, t)| (n * t).max(0.0)).sum::<f64>()
    }

    /// A time in values from the first one on, within the cycle.
    pub(crate) fn place(&self, time_s: f64) -> f64 {
        ((time_s - self.start_s) / self.step_s).clamp(0.0, self.speed_rad_s.len().saturating_sub(1) as f64)
    }

    fn between(&self, values: &[f64], time_s: f64) -> f64 {
        let place = self.place(time_s);
        let (low, share) = (place.floor() as usize, place.fract());
        let Some(value) = values.get(low) else { return 0.0 };
        value + share * (values.get(low + 1).unwrap_or(value) - value)
    }
}
