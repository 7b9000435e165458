//! Plain numbers of a bench.

use std::f64::consts::TAU;

/// One revolution a minute, rad/s.
pub(crate) const RPM: f64 = TAU / 60.0;

/// A bench.
#[derive(Debug, Clone, PartialEq)]
pub struct Bench {
    /// Both inertias and what connects them.
    pub train: Train,
    /// Inverter and machine.
    pub drive: Drive,
    /// Speed controller of the dynamometer.
    pub controller: Controller,
    /// The engine.
    pub engine: Engine,
    /// Encoders and torque sensors.
    pub sensors: Sensors,
    /// Clocks of the recordings.
    pub clocks: Clocks,
}

/// Both inertias and what connects them.
#[derive(Debug, Clone, PartialEq)]
pub struct Train {
    /// J_d, kg m².
    pub dyno_inertia_kg_m2: f64,
    /// J_e, flywheel and the mean of the moving pistons included, kg m².
    pub engine_inertia_kg_m2: f64,
    /// K, Nm/rad.
    pub stiffness_nm_per_rad: f64,
    /// B, Nm s/rad.
    pub damping_nm_s_per_rad: f64,
    /// Coulomb friction of the dynamometer's bearings, Nm.
    pub coulomb_nm: f64,
    /// Viscous friction of the dynamometer's bearings, Nm s/rad.
    pub viscous_nm_s_per_rad: f64,
}

/// Inverter and machine: T_d = T (1 + m sin 2πft) + a sin 2πft, T = e^{−sd} ω/(s + ω) T_d*.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// d, s.
    pub delay_s: f64,
    /// ω, rad/s.
    pub bandwidth_rad_s: f64,
    /// f, Hz.
    pub ripple_hz: f64,
    /// a, Nm.
    pub added_ripple_nm: f64,
    /// m, 1.
    pub multiplied_ripple: f64,
    /// Largest |T_d*|, Nm.
    pub limit_nm: f64,
}

/// Speed controller, updated every millisecond: T_d* = K_p e + K_i ∫e dt + k N_d* + m + k_a dN_d*/dt with the error e =
/// N_d − N_d*, of which N_d is late by τ, and N_d* too where the delay is on the demand.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    /// K_p, Nm s/rad.
    pub proportional_nm_s_per_rad: f64,
    /// K_i, Nm/rad.
    pub integral_nm_per_rad: f64,
    /// τ, ms.
    pub delay_ms: usize,
    /// True where the demand of the error is late too.
    pub delays_demand: bool,
    /// k, Nm s/rad.
    pub speed_gain_nm_s_per_rad: f64,
    /// m, Nm.
    pub constant_nm: f64,
    /// k_a, Nm s²/rad.
    pub acceleration_gain_nm_s2_per_rad: f64,
}

/// A four-stroke engine of equal slider-cranks.
#[derive(Debug, Clone, PartialEq)]
pub struct Engine {
    /// Torque of each cylinder over the mean, in the order of firing.
    pub cylinders: Vec<f64>,
    /// Standard deviation of the torque of a cylinder from cycle to cycle, relative.
    pub cycle_variation: f64,
    /// Swept volume of a cylinder, m³.
    pub swept_m3: f64,
    /// Stroke, m.
    pub stroke_m: f64,
    /// Crank radius over length of the rod.
    pub rod_ratio: f64,
    /// Compression ratio.
    pub compression: f64,
    /// Mass that moves with a piston, kg.
    pub piston_kg: f64,
    /// Pressure after combustion over that without, less one, at the best ignition angle.
    pub pressure_rise: f64,
    /// Crank angle of the ignition before top dead centre, rad.
    pub ignition_rad: f64,
    /// Crank angle in which 99.9 % burn, rad.
    pub burn_rad: f64,
    /// Friction of the engine, Nm.
    pub friction_nm: f64,
    /// Torque that it gives of a demanded one: gain, and offset, Nm. Its speed control corrects both.
    pub torque_error: (f64, f64),
    /// Time constant of the air path, s.
    pub air_lag_s: f64,
    /// K_p of its speed control, Nm s/rad.
    pub speed_proportional_nm_s_per_rad: f64,
    /// K_i of its speed control, Nm/rad.
    pub speed_integral_nm_per_rad: f64,
}

/// Encoders and torque sensors.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensors {
    /// Slits of the encoders, read by time stamps; none: the mean over the last millisecond.
    pub slits: Option<u32>,
    /// Once-a-turn error of the dynamometer's encoder, rad, and of the engine's.
    pub pitch_error_rad: [f64; 2],
    /// Noise of the measured speeds, rad/s.
    pub speed_noise_rad_s: f64,
    /// Measured speeds are multiples of this, rad/s.
    pub speed_step_rad_s: f64,
    /// The recorded T_d* is a multiple of this, Nm.
    pub demand_step_nm: f64,
    /// Noise of T_d,calc, Nm.
    pub torque_noise_nm: f64,
    /// Natural frequency of the load cell, rad/s.
    pub cell_rad_s: f64,
    /// Damping ratio of the load cell.
    pub cell_damping_ratio: f64,
    /// Delay of the load cell, ms.
    pub cell_delay_ms: usize,
}

/// Clocks of the recordings. N_d, N_d* and T_d* have one each millisecond.
#[derive(Debug, Clone, PartialEq)]
pub struct Clocks {
    /// Time between samples of N_e, ms.
    pub engine_speed_ms: usize,
    /// Time between samples of the torques, ms.
    pub torque_ms: usize,
    /// How late the stamps of N_e are, s.
    pub engine_speed_skew_s: f64,
    /// How late the stamps of the torques are, s.
    pub torque_skew_s: f64,
}
