//! Everything a virtual bench is made of, in SI.

use std::f64::consts::TAU;

use crate::units::RPM_RAD_S;
use serde::{Deserialize, Serialize};

use super::error::{VirtualBenchError, require, require_not_negative, require_positive};

/// The parameters of a virtual bench. `Default` resembles the DTB bench of Glans & Kärnell (Chalmers EX112/2018):
/// four-stroke engine with four cylinders, load cell, welded flywheel, shaft resonance near 18 Hz.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BenchParameters {
    /// Inertias, shaft and friction.
    pub mechanics: MechanicsParameters,
    /// The dynamometer's speed controller.
    pub controller: ControllerParameters,
    /// Inverter and machine: from T_d* to the real air-gap torque.
    pub inverter: InverterParameters,
    /// The engine and its control.
    pub engine: EngineParameters,
    /// Encoders, load cell, computed torques.
    pub sensors: SensorParameters,
    /// The clocks of the recording.
    pub clocks: ClockParameters,
}

/// Two masses and a shaft: J_d dω_d/dt = T_shaft − T_d − T_fric, J_e dω_e/dt = T_e − T_shaft,
/// T_shaft = K φ + B (ω_e − ω_d), dφ/dt = ω_e − ω_d (thesis 6.1, 6.4, 2.7).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MechanicsParameters {
    /// J_d, inertia of the dynamometer, kg m².
    pub dyno_inertia_kg_m2: f64,
    /// J_e, inertia of engine and flywheel, kg m².
    pub engine_inertia_kg_m2: f64,
    /// K, shaft stiffness, Nm/rad.
    pub shaft_stiffness_nm_per_rad: f64,
    /// B, shaft damping, Nm s/rad.
    pub shaft_damping_nm_s_per_rad: f64,
    /// Coulomb friction of the dynamometer's bearings, Nm.
    pub coulomb_friction_nm: f64,
    /// Viscous friction of the dynamometer's bearings, Nm s/rad.
    pub viscous_friction_nm_s_per_rad: f64,
}

impl Default for MechanicsParameters {
    fn default() -> Self {
        Self {
            dyno_inertia_kg_m2: 0.6,
            engine_inertia_kg_m2: 0.28,
            shaft_stiffness_nm_per_rad: 2437.7,
            shaft_damping_nm_s_per_rad: 5.8,
            coulomb_friction_nm: 0.0,
            viscous_friction_nm_s_per_rad: 0.0,
        }
    }
}

/// Speed control, updated every millisecond: T_d* = e^{−sτ} (K_p + K_i/s)(N_d − N_d*) + k N_d* + m + k_a dN_d*/dt
/// (thesis 6.2, 6.6, 6.7), limited to ± the torque limit.
///
/// In discrete form, with e the measured speed error of update j and T = 1 ms: v_j = K_p e_j + I_j, I_{j+1} = I_j + K_i
/// T e_j; the integrator rests while the limit is exceeded and e_j would drive it further. v_j takes effect τ later,
/// the feed-forward at once; dN_d*/dt is the backward difference of N_d* over T.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ControllerParameters {
    /// K_p, Nm s/rad.
    pub proportional_nm_s_per_rad: f64,
    /// K_i, Nm/rad.
    pub integral_nm_per_rad: f64,
    /// τ, transport delay of the PI part, s.
    pub delay_s: f64,
    /// k, feed-forward of N_d*, Nm s/rad.
    pub speed_feed_forward_nm_s_per_rad: f64,
    /// m, constant part of the feed-forward, Nm.
    pub offset_feed_forward_nm: f64,
    /// k_a, feed-forward of dN_d*/dt, Nm s²/rad.
    pub acceleration_feed_forward_nm_s2_per_rad: f64,
    /// The automation system's torque demands (T_d* and the engine's) change only once in this time, s.
    pub demand_hold_s: f64,
}

impl Default for ControllerParameters {
    fn default() -> Self {
        Self {
            proportional_nm_s_per_rad: 0.9385 / RPM_RAD_S,
            integral_nm_per_rad: 1.865 / RPM_RAD_S,
            delay_s: 0.001,
            speed_feed_forward_nm_s_per_rad: 0.012 / RPM_RAD_S,
            offset_feed_forward_nm: -4.0,
            acceleration_feed_forward_nm_s2_per_rad: -0.085 / RPM_RAD_S,
            demand_hold_s: 0.01,
        }
    }
}

/// Inverter and machine: T = e^{−s d} a/(s + a) T_d* with T_d* within ± the limit; the real air-gap torque is
/// T_d = T (1 + r_m sin(2π f t)) + r_a sin(2π f t).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct InverterParameters {
    /// d, delay, s.
    pub delay_s: f64,
    /// a, bandwidth of the closed torque loop, rad/s.
    pub bandwidth_rad_s: f64,
    /// Largest torque demand in either direction, Nm.
    pub torque_limit_nm: f64,
    /// f, frequency of the drive's ripple, Hz.
    pub ripple_hz: f64,
    /// r_a, additive ripple, Nm.
    pub additive_ripple_nm: f64,
    /// r_m, multiplicative ripple, 1.
    pub multiplicative_ripple: f64,
}

impl Default for InverterParameters {
    fn default() -> Self {
        Self {
            delay_s: 0.00125,
            bandwidth_rad_s: 90.0 * TAU,
            torque_limit_nm: 400.0,
            ripple_hz: 100.0,
            additive_ripple_nm: 1.2,
            multiplicative_ripple: 0.03,
        }
    }
}

/// One harmonic of the firing order.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Harmonic {
    /// Amplitude relative to the mean torque, 1.
    pub relative_amplitude: f64,
    /// Phase at the moment of firing, rad.
    pub phase_rad: f64,
}

/// Four-stroke engine with c cylinders, firing at crank angles θ = 4π j/c. From firing j to the next,
/// T_e = T_j (1 + p Σ_n a_n cos(n c θ/2 + φ_n)), T_j = (level at firing j) · (factor of cylinder j mod c) · (1 + ε_j),
/// ε_j normal and independent. p is 1 when fired; a motored engine has p < 1, unit cylinder factors and no ε_j.
/// Firing frequency: f_cb = (c/2) N_e/60 (thesis 2.1).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EngineParameters {
    /// Torque of each cylinder relative to the level, in firing order; their number is the number of cylinders.
    pub cylinder_factors: Vec<f64>,
    /// a_n, φ_n: harmonics of the firing order, first harmonic first.
    pub firing_harmonics: Vec<Harmonic>,
    /// Standard deviation of ε, 1.
    pub cycle_variation: f64,
    /// Mean torque of the motored engine, Nm (negative).
    pub motored_torque_nm: f64,
    /// p of the motored engine, 1.
    pub motored_pulsation: f64,
    /// Proportional gain of the engine's speed control (TN): torque per speed too low, Nm s/rad.
    pub speed_control_proportional_nm_s_per_rad: f64,
    /// Integral gain of the engine's speed control (TN), Nm/rad.
    pub speed_control_integral_nm_per_rad: f64,
}

impl Default for EngineParameters {
    fn default() -> Self {
        let harmonic = |relative_amplitude, phase_rad| Harmonic { relative_amplitude, phase_rad };
        Self {
            cylinder_factors: vec![1.0, 0.93, 1.05, 0.98],
            firing_harmonics: vec![harmonic(2.0, 0.3), harmonic(0.9, 1.1), harmonic(0.4, -0.5), harmonic(0.2, 0.2)],
            cycle_variation: 0.02,
            motored_torque_nm: -15.8,
            motored_pulsation: 0.2,
            speed_control_proportional_nm_s_per_rad: 2.0,
            speed_control_integral_nm_per_rad: 6.0,
        }
    }
}

/// Sensors. An encoder reads the mean speed over a gate that ends at the time stamp:
/// N = (θ̃(t) − θ̃(t − gate))/gate with θ̃ = θ + ε sin θ, plus white noise, rounded. The load cell reads the air-gap
/// torque late and through ω_0²/(s² + 2ζω_0 s + ω_0²). The system's shaft torque is
/// T_d,calc + J_d dN̄_d/dt, with N̄_d the moving average of N_d over N updates (1 ms each) and a backward difference for
/// its derivative: the inertia part is late by (N − 1)/2 ms, T_d,calc is not (thesis, figure 3.3 and the text below it).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SensorParameters {
    /// Gate over which speed is averaged, s.
    pub gate_s: f64,
    /// ε of the dynamometer's encoder: its once-a-turn relative speed error, 1.
    pub dyno_eccentricity: f64,
    /// ε of the engine's encoder, 1.
    pub engine_eccentricity: f64,
    /// Standard deviation of the white noise of measured speeds, rad/s.
    pub speed_noise_rad_s: f64,
    /// Measured speeds are rounded to multiples of this, rad/s; zero: not rounded.
    pub speed_resolution_rad_s: f64,
    /// The recorded T_d* is rounded to multiples of this, Nm; zero: not rounded. The inverter gets it unrounded.
    pub demand_resolution_nm: f64,
    /// Standard deviation of the white noise of T_d,calc, Nm.
    pub calc_noise_nm: f64,
    /// Delay of the load cell, s.
    pub cell_delay_s: f64,
    /// Natural frequency ω_0/2π of the load cell, Hz.
    pub cell_resonance_hz: f64,
    /// Damping ratio ζ of the load cell, 1.
    pub cell_damping_ratio: f64,
    /// Standard deviation of the white noise of the load cell, Nm.
    pub cell_noise_nm: f64,
    /// N of the moving average in the system's shaft torque.
    pub moving_average: usize,
}

impl Default for SensorParameters {
    fn default() -> Self {
        Self {
            gate_s: 0.001,
            dyno_eccentricity: 0.0002,
            engine_eccentricity: 0.0003,
            speed_noise_rad_s: 0.03 * RPM_RAD_S,
            speed_resolution_rad_s: 0.01 * RPM_RAD_S,
            demand_resolution_nm: 0.01,
            calc_noise_nm: 0.15,
            cell_delay_s: 0.008,
            cell_resonance_hz: 75.0,
            cell_damping_ratio: 0.25,
            cell_noise_nm: 0.0,
            moving_average: 16,
        }
    }
}

impl SensorParameters {
    /// The same sensors without noise, rounding and once-a-turn errors; gates, delays and resonance stay.
    #[must_use]
    pub fn without_errors(self) -> Self {
        Self {
            dyno_eccentricity: 0.0,
            engine_eccentricity: 0.0,
            speed_noise_rad_s: 0.0,
            speed_resolution_rad_s: 0.0,
            demand_resolution_nm: 0.0,
            calc_noise_nm: 0.0,
            cell_noise_nm: 0.0,
            ..self
        }
    }
}

/// The clocks of the recording. A sample taken at time t after the start is stamped t + offset + skew of its raster: a
/// positive skew makes the raster's signals late.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ClockParameters {
    /// Time stamp of the recording's start, s.
    pub start_offset_s: f64,
    /// Updates (1 ms) from one sample of the engine's speed to the next.
    pub engine_speed_decimation: usize,
    /// Updates (1 ms) from one sample of the torques to the next.
    pub torque_decimation: usize,
    /// Skew of the raster of N_d, N_d*, T_d*, s.
    pub fast_skew_s: f64,
    /// Skew of the engine speed's raster, s.
    pub engine_speed_skew_s: f64,
    /// Skew of the torques' raster, s.
    pub torque_skew_s: f64,
}

impl Default for ClockParameters {
    fn default() -> Self {
        Self {
            start_offset_s: 0.0,
            engine_speed_decimation: 2,
            torque_decimation: 4,
            fast_skew_s: 0.0,
            engine_speed_skew_s: 0.0,
            torque_skew_s: 0.0,
        }
    }
}

impl BenchParameters {
    /// Checks every parameter that has impossible values.
    ///
    /// # Errors
    ///
    /// [`VirtualBenchError::Parameter`] naming the first impossible one.
    pub fn check(&self) -> Result<(), VirtualBenchError> {
        self.mechanics.check()?;
        self.controller.check()?;
        self.inverter.check()?;
        self.engine.check()?;
        self.sensors.check()?;
        self.clocks.check()
    }
}

impl MechanicsParameters {
    fn check(&self) -> Result<(), VirtualBenchError> {
        require_positive("mechanics.dyno_inertia_kg_m2", self.dyno_inertia_kg_m2)?;
        require_positive("mechanics.engine_inertia_kg_m2", self.engine_inertia_kg_m2)?;
        require_positive("mechanics.shaft_stiffness_nm_per_rad", self.shaft_stiffness_nm_per_rad)?;
        require_not_negative("mechanics.shaft_damping_nm_s_per_rad", self.shaft_damping_nm_s_per_rad)?;
        require_not_negative("mechanics.coulomb_friction_nm", self.coulomb_friction_nm)?;
        require_not_negative("mechanics.viscous_friction_nm_s_per_rad", self.viscous_friction_nm_s_per_rad)
    }
}

impl ControllerParameters {
    fn check(&self) -> Result<(), VirtualBenchError> {
        let any = [
            ("controller.proportional_nm_s_per_rad", self.proportional_nm_s_per_rad),
            ("controller.integral_nm_per_rad", self.integral_nm_per_rad),
            ("controller.speed_feed_forward_nm_s_per_rad", self.speed_feed_forward_nm_s_per_rad),
            ("controller.offset_feed_forward_nm", self.offset_feed_forward_nm),
            ("controller.acceleration_feed_forward_nm_s2_per_rad", self.acceleration_feed_forward_nm_s2_per_rad),
        ];
        for (name, value) in any {
            require(name, value, true, "finite")?;
        }
        let delay = self.delay_s;
        require("controller.delay_s", delay, (0.0..=1.0).contains(&delay), "between 0 and 1 s")?;
        require_not_negative("controller.demand_hold_s", self.demand_hold_s)
    }
}

impl InverterParameters {
    fn check(&self) -> Result<(), VirtualBenchError> {
        let delay = self.delay_s;
        require("inverter.delay_s", delay, (0.0..=1.0).contains(&delay), "between 0 and 1 s")?;
        require_positive("inverter.bandwidth_rad_s", self.bandwidth_rad_s)?;
        require_positive("inverter.torque_limit_nm", self.torque_limit_nm)?;
        require_not_negative("inverter.ripple_hz", self.ripple_hz)?;
        require_not_negative("inverter.additive_ripple_nm", self.additive_ripple_nm)?;
        require_not_negative("inverter.multiplicative_ripple", self.multiplicative_ripple)
    }
}

impl EngineParameters {
    fn check(&self) -> Result<(), VirtualBenchError> {
        let cylinders = self.cylinder_factors.len();
        require("engine.cylinder_factors", cylinders as f64, cylinders > 0, "one factor for each cylinder")?;
        for &factor in &self.cylinder_factors {
            require("engine.cylinder_factors", factor, true, "finite")?;
        }
        for harmonic in &self.firing_harmonics {
            require("engine.firing_harmonics", harmonic.relative_amplitude, true, "finite")?;
            require("engine.firing_harmonics", harmonic.phase_rad, true, "finite")?;
        }
        require_not_negative("engine.cycle_variation", self.cycle_variation)?;
        require("engine.motored_torque_nm", self.motored_torque_nm, true, "finite")?;
        require("engine.motored_pulsation", self.motored_pulsation, true, "finite")?;
        let gain = self.speed_control_proportional_nm_s_per_rad;
        require_not_negative("engine.speed_control_proportional_nm_s_per_rad", gain)?;
        require_not_negative("engine.speed_control_integral_nm_per_rad", self.speed_control_integral_nm_per_rad)
    }
}

impl SensorParameters {
    fn check(&self) -> Result<(), VirtualBenchError> {
        require("sensors.gate_s", self.gate_s, self.gate_s >= 1e-5 && self.gate_s <= 1.0, "between 10 µs and 1 s")?;
        require("sensors.dyno_eccentricity", self.dyno_eccentricity, true, "finite")?;
        require("sensors.engine_eccentricity", self.engine_eccentricity, true, "finite")?;
        require_not_negative("sensors.speed_noise_rad_s", self.speed_noise_rad_s)?;
        require_not_negative("sensors.speed_resolution_rad_s", self.speed_resolution_rad_s)?;
        require_not_negative("sensors.demand_resolution_nm", self.demand_resolution_nm)?;
        require_not_negative("sensors.calc_noise_nm", self.calc_noise_nm)?;
        let delay = self.cell_delay_s;
        require("sensors.cell_delay_s", delay, (0.0..=1.0).contains(&delay), "between 0 and 1 s")?;
        require_positive("sensors.cell_resonance_hz", self.cell_resonance_hz)?;
        require_positive("sensors.cell_damping_ratio", self.cell_damping_ratio)?;
        require_not_negative("sensors.cell_noise_nm", self.cell_noise_nm)?;
        let average = self.moving_average;
        require("sensors.moving_average", average as f64, (1..=1000).contains(&average), "between 1 and 1000")
    }
}

impl ClockParameters {
    fn check(&self) -> Result<(), VirtualBenchError> {
        let decimations = [
            ("clocks.engine_speed_decimation", self.engine_speed_decimation),
            ("clocks.torque_decimation", self.torque_decimation),
        ];
        for (name, value) in decimations {
            require(name, value as f64, value > 0, "at least 1")?;
        }
        let times = [
            ("clocks.start_offset_s", self.start_offset_s),
            ("clocks.fast_skew_s", self.fast_skew_s),
            ("clocks.engine_speed_skew_s", self.engine_speed_skew_s),
            ("clocks.torque_skew_s", self.torque_skew_s),
        ];
        for (name, value) in times {
            require(name, value, true, "finite")?;
        }
        Ok(())
    }
}
