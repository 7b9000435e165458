//! Demands on a bench.

/// Who controls what.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// The dynamometer controls its speed; the engine gives a torque by its charge.
    Speed,
    /// As [`Mode::Speed`], with the engine's torque set by the ignition angle, so that the air path has no part in it.
    SpeedByIgnition,
    /// The dynamometer controls T_d; the engine controls its speed.
    Torque,
}

/// Demands at each millisecond. Before the first the bench settles at it.
#[derive(Debug, Clone, PartialEq)]
pub struct Demand {
    /// Who controls what.
    pub mode: Mode,
    /// Speed of the dynamometer or, in [`Mode::Torque`], of the engine, rad/s.
    pub speed_rad_s: Vec<f64>,
    /// Torque of the engine or, in [`Mode::Torque`], T_d*, Nm.
    pub torque_nm: Vec<f64>,
}
