//! The drive: inverter and machine.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::bench_parameters::{InductionMachine, ParameterError, require, require_not_negative, require_positive};

/// The drive, inverter and machine: T = e^{−s d} a/(s + a) T_d* with T_d* within ± the limit, or, in place of the lag,
/// an induction machine under field-oriented control; the real air-gap torque is T_d = g (T (1 + r_m sin(2π f t)) + r_a
/// sin(2π f t)), with g one where the drive knows its machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DriveParameters {
    /// d, delay, s.
    pub delay_s: f64,
    /// a, bandwidth of the closed torque loop, rad/s; without a part where the machine is simulated.
    pub bandwidth_rad_s: f64,
    /// The induction machine; none: the lag.
    pub machine: Option<InductionMachine>,
    /// Largest torque demand in either direction, Nm.
    pub torque_limit_nm: f64,
    /// f, frequency of the drive's ripple, Hz.
    pub ripple_hz: f64,
    /// r_a, additive ripple, Nm.
    pub additive_ripple_nm: f64,
    /// r_m, multiplicative ripple, 1.
    pub multiplicative_ripple: f64,
    /// How well the drive knows its machine.
    pub knowledge: MachineKnowledge,
}

/// Difference between the torque that the drive computes from currents and the machine's own, where resistances have
/// warmed: T_d = g T_d,calc, g = (1 + e_0 + c ϑ)/(1 + â). The rotor's temperature rise ϑ follows the torque, dϑ/dt = (h
/// T_d² − ϑ)/τ_ϑ; the drive adapts â to the load cell, dâ/dt = (T_d,meas − T_d,calc) T_d,calc/(T_d,calc² + 25 Nm²)/τ_a
/// (thesis §3.4.2). A bench without load cell cannot.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MachineKnowledge {
    /// e_0, relative error of the torque of the cold machine, 1.
    pub cold_error: f64,
    /// c, error per temperature rise, 1/K.
    pub error_per_k: f64,
    /// h, temperature rise in the end per squared torque, K/(Nm)².
    pub heating_k_per_nm2: f64,
    /// τ_ϑ, thermal time constant, s.
    pub thermal_time_s: f64,
    /// τ_a, time constant of the adaptation, s; zero: none.
    pub adaptation_time_s: f64,
}

impl Default for MachineKnowledge {
    fn default() -> Self {
        Self {
            cold_error: 0.0,
            error_per_k: 0.0,
            heating_k_per_nm2: 0.005,
            thermal_time_s: 600.0,
            adaptation_time_s: 0.0,
        }
    }
}

impl Default for DriveParameters {
    fn default() -> Self {
        Self {
            delay_s: 0.00125,
            bandwidth_rad_s: 90.0 * TAU,
            machine: None,
            torque_limit_nm: 400.0,
            ripple_hz: 100.0,
            additive_ripple_nm: 1.2,
            multiplicative_ripple: 0.03,
            knowledge: MachineKnowledge::default(),
        }
    }
}

impl DriveParameters {
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        let delay = self.delay_s;
        require("drive.delay_s", delay, (0.0..=1.0).contains(&delay), "between 0 and 1 s")?;
        require_positive("drive.bandwidth_rad_s", self.bandwidth_rad_s)?;
        require_positive("drive.torque_limit_nm", self.torque_limit_nm)?;
        require_not_negative("drive.ripple_hz", self.ripple_hz)?;
        require_not_negative("drive.additive_ripple_nm", self.additive_ripple_nm)?;
        require_not_negative("drive.multiplicative_ripple", self.multiplicative_ripple)?;
        self.machine.map_or(Ok(()), |machine| machine.check())?;
        self.knowledge.check()
    }
}

impl MachineKnowledge {
    fn check(&self) -> Result<(), ParameterError> {
        let cold = self.cold_error;
        require("drive.knowledge.cold_error", cold, cold.abs() <= 0.5, "at most 50 %")?;
        require("drive.knowledge.error_per_k", self.error_per_k, true, "finite")?;
        require_not_negative("drive.knowledge.heating_k_per_nm2", self.heating_k_per_nm2)?;
        require_positive("drive.knowledge.thermal_time_s", self.thermal_time_s)?;
        require_not_negative("drive.knowledge.adaptation_time_s", self.adaptation_time_s)
    }
}
