//! Where a simulation starts unless its user states another point: where the model is valid.

use bench_model::document::Validity;

/// Speed where the model has no range, rad/s.
const START_RAD_S: f64 = 100.0;

/// The middle of the speeds that the model is valid at, rad/s.
pub(crate) fn start_rad_s(validity: &Validity) -> f64 {
    validity.dyno_speed_rad_s.map_or(START_RAD_S, |(low, high)| 0.5 * (low + high))
}

/// No torque, or where the model is not valid without torque the middle of its range, Nm.
pub(crate) fn start_nm(validity: &Validity) -> f64 {
    let beside = validity.air_gap_torque_nm.filter(|(low, high)| !(*low..=*high).contains(&0.0));
    beside.map_or(0.0, |(low, high)| 0.5 * (low + high))
}
