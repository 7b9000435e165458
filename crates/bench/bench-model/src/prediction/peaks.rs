//! The largest values of a prediction.

use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};

use crate::prediction::inputs::PredictionInputs;
use crate::simulate::Response;

/// Of what a peak is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum PeakOf {
    /// |N_d|, rad/s.
    DynoSpeed,
    /// |T_d*|, Nm, held by the limit.
    TorqueDemand,
    /// |T_d|, Nm.
    AirGapTorque,
    /// |T_shaft|, Nm.
    ShaftTorque,
}

/// The largest magnitude of a signal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// The signal.
    pub of: PeakOf,
    /// Its value there, with its sign, SI.
    #[serde(deserialize_with = "nan_if_null")]
    pub value: f64,
    /// When, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub time_s: f64,
    /// The limit stated, SI.
    pub limit: Option<f64>,
}

impl Peak {
    /// Tells whether the limit is reached.
    pub fn is_beyond_limit(&self) -> bool {
        self.limit.is_some_and(|limit| self.value.abs() >= limit)
    }
}

/// The peaks of a response.
pub(super) fn all(response: &Response, sample_time_s: f64, inputs: &PredictionInputs<'_>) -> Vec<Peak> {
    let limits = inputs.limits;
    let peak = |of, values: &[f64], limit| {
        let (place, value) = values
            .iter()
            .copied()
            .enumerate()
            .fold((0, 0.0_f64), |most, (k, value)| if value.abs() > most.1.abs() { (k, value) } else { most });
        Peak { of, value, time_s: place as f64 * sample_time_s, limit }
    };
    let mut peaks = vec![
        peak(PeakOf::DynoSpeed, &response.dyno_speed_rad_s, limits.speed_rad_s),
        peak(PeakOf::TorqueDemand, &response.torque_demand_nm, limits.torque_nm),
        peak(PeakOf::AirGapTorque, &response.air_gap_torque_nm, None),
    ];
    if inputs.plan.has_shaft {
        peaks.push(peak(PeakOf::ShaftTorque, &response.shaft_torque_nm, limits.shaft_torque_nm));
    }
    peaks
}
