//! From demand or throttle to the torque level that the next firing takes up.

use rig::bench_parameters::{EngineParameters, ThrottleMap};
use rig::experiment::{Demands, UPDATE_S};

/// T_b = demand or T(α, ω_e) through 1/(1 + sτ), exact for an input held between updates;
/// level = T_b − (1 − η)(T_b − T_motored).
#[derive(Debug, Clone)]
pub struct Air {
    /// e^{−T/τ} of an update, zero without lag.
    stays: f64,
    best_nm: f64,
    motored_nm: f64,
    map: ThrottleMap,
}

impl Air {
    /// The intake at rest at a torque.
    pub fn new(parameters: &EngineParameters, torque_nm: f64, update_s: f64) -> Self {
        let lag_s = parameters.intake_lag_s;
        Self {
            stays: if lag_s > 0.0 { (-update_s / lag_s).exp() } else { 0.0 },
            best_nm: torque_nm,
            motored_nm: parameters.motored_torque_nm,
            map: parameters.throttle_map.clone(),
        }
    }

    /// One update with the torque that the charge tends to; returns the level, Nm, of an ignition efficiency.
    pub fn update(&mut self, towards_nm: f64, efficiency: f64) -> f64 {
        self.best_nm = towards_nm + (self.best_nm - towards_nm) * self.stays;
        self.best_nm - (1.0 - efficiency) * (self.best_nm - self.motored_nm)
    }

    /// T(α, ω_e), Nm.
    pub fn mapped_nm(&self, throttle: f64, speed_rad_s: f64) -> f64 {
        torque_at_rest_nm(&self.map, throttle, speed_rad_s)
    }
}

/// The engine's mean torque under the demands of NT mode, Nm, at every update; with a throttle, at the speed demanded.
pub(crate) fn demanded_torque_nm(parameters: &EngineParameters, demands: &Demands) -> Vec<f64> {
    let map = &parameters.throttle_map;
    let best_nm = |k: usize| match demands.throttle.get(k) {
        Some(throttle) => torque_at_rest_nm(map, *throttle, demands.speed_rad_s[k]),
        None => demands.engine_torque_nm[k],
    };
    let mut air = Air::new(parameters, best_nm(0), UPDATE_S);
    (0..demands.speed_rad_s.len()).map(|k| air.update(best_nm(k), demands.ignition_efficiency[k])).collect()
}

/// The map at a throttle and a speed, Nm.
pub(crate) fn torque_at_rest_nm(map: &ThrottleMap, throttle: f64, speed_rad_s: f64) -> f64 {
    let (row, down) = place(&map.throttle, throttle);
    let (column, right) = place(&map.speed_rad_s, speed_rad_s);
    let along = |row: usize| {
        let line = &map.torque_nm[row];
        line[column] + right * (line[(column + 1).min(line.len() - 1)] - line[column])
    };
    along(row) + down * (along((row + 1).min(map.torque_nm.len() - 1)) - along(row))
}

/// The point of an axis at or below a value, and how far, 0 … 1, it is to the next one.
fn place(axis: &[f64], value: f64) -> (usize, f64) {
    let above = axis.partition_point(|point| *point <= value);
    match (above, axis.get(above)) {
        (0, _) => (0, 0.0),
        (_, None) => (axis.len() - 1, 0.0),
        (_, Some(next)) => (above - 1, (value - axis[above - 1]) / (next - axis[above - 1])),
    }
}
