//! Trace of one bench in a test.

use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};

/// Demands and what came of them, on one clock.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Trace {
    /// Time of the first value on the clock of the test, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub start_s: f64,
    /// Time between values, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub step_s: f64,
    /// True where a demand holds from its time to the next. Otherwise it changes in between.
    pub is_demand_held: bool,
    /// Speed demanded, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_demand_rad_s: Vec<f64>,
    /// Speed that should follow it: of the engine in a cycle and in TN, of the dynamometer in other tests in NT, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_rad_s: Vec<f64>,
    /// Torque demanded, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub torque_demand_nm: Vec<f64>,
    /// Torque that should follow it: T_shaft in NT, T_d in TN, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub torque_nm: Vec<f64>,
    /// ω_d, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub dyno_speed_rad_s: Vec<f64>,
    /// ω_e, rad/s; empty without a shaft.
    #[serde(deserialize_with = "nan_if_null")]
    pub engine_speed_rad_s: Vec<f64>,
    /// T_shaft, Nm; empty without a shaft.
    #[serde(deserialize_with = "nan_if_null")]
    pub shaft_torque_nm: Vec<f64>,
    /// T_d*, Nm, limited.
    #[serde(deserialize_with = "nan_if_null")]
    pub dyno_demand_nm: Vec<f64>,
}

impl Trace {
    /// Time of a value, s.
    pub fn time_s(&self, place: usize) -> f64 {
        self.start_s + place as f64 * self.step_s
    }

    /// From one value to another.
    pub(crate) fn part(&self, from: usize, to: usize) -> Trace {
        let part = |values: &[f64]| values.get(from..=to).unwrap_or_default().to_vec();
        Trace {
            start_s: self.time_s(from),
            speed_demand_rad_s: part(&self.speed_demand_rad_s),
            speed_rad_s: part(&self.speed_rad_s),
            torque_demand_nm: part(&self.torque_demand_nm),
            torque_nm: part(&self.torque_nm),
            dyno_speed_rad_s: part(&self.dyno_speed_rad_s),
            engine_speed_rad_s: part(&self.engine_speed_rad_s),
            shaft_torque_nm: part(&self.shaft_torque_nm),
            dyno_demand_nm: part(&self.dyno_demand_nm),
            ..*self
        }
    }

    /// Tells whether every value is finite and of a size that a bench can have.
    pub(crate) fn is_bounded(&self) -> bool {
        let is_bounded = |values: &[f64]| values.iter().all(|value| value.abs() < 1e6);
        is_bounded(&self.dyno_speed_rad_s) && is_bounded(&self.shaft_torque_nm)
    }
}
