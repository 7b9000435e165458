//! The bench as it is, without any sensor.

use numerics::null::nan_if_null;
use rig::experiment::UPDATE_S;
use serde::{Deserialize, Serialize};

use crate::numerics::Numerics;

/// The bench as it really is, without any sensor, at uniform instants from the recording's start on. SI.
///
/// J_d dω_d/dt = T_shaft − T_d − T_fric and J_e dω_e/dt = T_e − T_shaft hold between these signals where there are two
/// masses. Without a shaft the engine does not run: T_e is zero and ω_e stays where it was.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HiddenTruth {
    /// Time between samples, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub sample_time_s: f64,
    /// ω_d, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub dyno_speed_rad_s: Vec<f64>,
    /// ω_e, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub engine_speed_rad_s: Vec<f64>,
    /// T_shaft, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub shaft_torque_nm: Vec<f64>,
    /// T_e, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub engine_torque_nm: Vec<f64>,
    /// T_d with its ripple, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub air_gap_torque_nm: Vec<f64>,
    /// T_fric, bearing friction of the dynamometer, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub friction_torque_nm: Vec<f64>,
}

impl HiddenTruth {
    /// Empty, with room for so many updates.
    pub(super) fn new(updates: usize, numerics: &Numerics) -> Self {
        let (steps, every) = (numerics.steps_per_update, numerics.steps_per_hidden_sample);
        let room = || Vec::with_capacity(every.map_or(0, |every| (updates * steps).div_ceil(every)));
        Self {
            sample_time_s: every.unwrap_or(steps) as f64 * (UPDATE_S / steps as f64),
            dyno_speed_rad_s: room(),
            engine_speed_rad_s: room(),
            shaft_torque_nm: room(),
            engine_torque_nm: room(),
            air_gap_torque_nm: room(),
            friction_torque_nm: room(),
        }
    }
}
