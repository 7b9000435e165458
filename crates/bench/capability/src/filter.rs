//! A low-pass of the demands.

use std::f64::consts::TAU;

use rig::experiment::{DEMAND_HOLD_S, Demands, UPDATE_S};

/// Output of a low-pass of first order on a series, from rest at its first value.
pub(crate) fn low_pass(values: &[f64], step_s: f64, corner_hz: f64) -> Vec<f64> {
    let stays = (-TAU * corner_hz * step_s).exp();
    let mut held = values.first().copied().unwrap_or(0.0);
    let next = |value: &f64| {
        held = value + (held - value) * stays;
        held
    };
    values.iter().map(next).collect()
}

/// The demands of a plan through such a filter; torques still change as often as an automation system changes them.
pub(crate) fn demands(demands: &Demands, corner_hz: f64) -> Demands {
    let held_updates = (DEMAND_HOLD_S / UPDATE_S).round() as usize;
    let smooth = |values: &[f64]| low_pass(values, UPDATE_S, corner_hz);
    let held = |values: &[f64]| {
        let smooth = smooth(values);
        (0..smooth.len()).map(|k| smooth[k - k % held_updates]).collect()
    };
    Demands {
        speed_rad_s: smooth(&demands.speed_rad_s),
        dyno_torque_nm: held(&demands.dyno_torque_nm),
        engine_torque_nm: held(&demands.engine_torque_nm),
        throttle: held(&demands.throttle),
        ignition_efficiency: held(&demands.ignition_efficiency),
    }
}
