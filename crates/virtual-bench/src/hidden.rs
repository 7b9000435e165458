//! The bench as it is, without any sensor.

use serde::Serialize;

/// The bench as it really is, without any sensor, at uniform instants from the recording's start on. SI.
///
/// J_d dω_d/dt = T_shaft − T_d − T_fric and J_e dω_e/dt = T_e − T_shaft hold between these signals where there are two
/// masses. Without a shaft the engine does not run: T_e is zero and ω_e stays where it was.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HiddenTruth {
    /// Time between samples, s.
    pub sample_time_s: f64,
    /// ω_d, rad/s.
    pub dyno_speed_rad_s: Vec<f64>,
    /// ω_e, rad/s.
    pub engine_speed_rad_s: Vec<f64>,
    /// T_shaft, Nm.
    pub shaft_torque_nm: Vec<f64>,
    /// T_e, Nm.
    pub engine_torque_nm: Vec<f64>,
    /// T_d with its ripple, Nm.
    pub air_gap_torque_nm: Vec<f64>,
    /// T_fric, bearing friction of the dynamometer, Nm.
    pub friction_torque_nm: Vec<f64>,
}

impl HiddenTruth {
    pub(super) fn new(sample_time_s: f64) -> Self {
        Self {
            sample_time_s,
            dyno_speed_rad_s: Vec::new(),
            engine_speed_rad_s: Vec::new(),
            shaft_torque_nm: Vec::new(),
            engine_torque_nm: Vec::new(),
            air_gap_torque_nm: Vec::new(),
            friction_torque_nm: Vec::new(),
        }
    }

    /// Makes room for samples.
    pub(super) fn reserve(&mut self, samples: usize) {
        for signal in [
            &mut self.dyno_speed_rad_s,
            &mut self.engine_speed_rad_s,
            &mut self.shaft_torque_nm,
            &mut self.engine_torque_nm,
            &mut self.air_gap_torque_nm,
            &mut self.friction_torque_nm,
        ] {
            signal.reserve_exact(samples);
        }
    }
}
