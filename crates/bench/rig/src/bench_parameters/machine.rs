//! The induction machine and its field-oriented control.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::bench_parameters::{ParameterError, require, require_positive};

/// An induction machine by its T circuit, in a rotor-flux frame that turns with ω_k; u, i (stator) and ψ (rotor flux)
/// are complex, d + jq:
///
/// σL_s di/dt = u − (R_s + (L_m/L_r)² R_r + jω_k σL_s) i + (L_m/L_r)(R_r/L_r − jpω) ψ,
/// dψ/dt = (R_r/L_r)(L_m i − ψ) − j(ω_k − pω) ψ, torque (3/2) p (L_m/L_r) Im(ψ̄ i).
///
/// The control samples at 4 kHz: flux and slip from a current model, flux reduced above base speed, currents by PI with
/// decoupling, |i*| and |u| limited. A voltage is applied one sample after the currents it was computed from.
///
/// # Source
///
/// Trzynadlowski, *The Field Orientation Principle in Control of Induction Motors*, 1994; Harnefors & Nee, *Model-based
/// current control of AC machines using the internal model control method*, IEEE Trans. Ind. Appl. 34 (1998).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct InductionMachine {
    /// p, pole pairs.
    pub pole_pairs: u32,
    /// R_s, Ω.
    pub stator_resistance_ohm: f64,
    /// R_r, Ω.
    pub rotor_resistance_ohm: f64,
    /// Leakage inductance of the stator, H.
    pub stator_leakage_h: f64,
    /// Leakage inductance of the rotor, H.
    pub rotor_leakage_h: f64,
    /// L_m, H.
    pub magnetising_h: f64,
    /// Rotor flux below base speed, Vs.
    pub rated_flux_vs: f64,
    /// Largest phase voltage, peak, V.
    pub voltage_limit_v: f64,
    /// Largest phase current, peak, A.
    pub current_limit_a: f64,
    /// Bandwidth of the current control, rad/s.
    pub current_bandwidth_rad_s: f64,
}

impl Default for InductionMachine {
    /// About 400 Nm up to 3500 rpm.
    fn default() -> Self {
        Self {
            pole_pairs: 2,
            stator_resistance_ohm: 0.02,
            rotor_resistance_ohm: 0.015,
            stator_leakage_h: 0.15e-3,
            rotor_leakage_h: 0.15e-3,
            magnetising_h: 5e-3,
            rated_flux_vs: 0.5,
            voltage_limit_v: 400.0,
            current_limit_a: 350.0,
            current_bandwidth_rad_s: 120.0 * TAU,
        }
    }
}

impl InductionMachine {
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        let pairs = self.pole_pairs;
        require("drive.machine.pole_pairs", f64::from(pairs), (1..=20).contains(&pairs), "between 1 and 20")?;
        require_positive("drive.machine.stator_resistance_ohm", self.stator_resistance_ohm)?;
        require_positive("drive.machine.rotor_resistance_ohm", self.rotor_resistance_ohm)?;
        require_positive("drive.machine.stator_leakage_h", self.stator_leakage_h)?;
        require_positive("drive.machine.rotor_leakage_h", self.rotor_leakage_h)?;
        require_positive("drive.machine.magnetising_h", self.magnetising_h)?;
        require_positive("drive.machine.rated_flux_vs", self.rated_flux_vs)?;
        require_positive("drive.machine.voltage_limit_v", self.voltage_limit_v)?;
        require_positive("drive.machine.current_limit_a", self.current_limit_a)?;
        let magnetising_a = self.rated_flux_vs / self.magnetising_h;
        let leaves_torque = magnetising_a < 0.9 * self.current_limit_a;
        require("drive.machine.current_limit_a", magnetising_a, leaves_torque, "above the magnetising current")?;
        let bandwidth = self.current_bandwidth_rad_s;
        let requirement = "between 10 and 2000 rad/s, which 4 kHz allow";
        let is_possible = (10.0..=2000.0).contains(&bandwidth);
        require("drive.machine.current_bandwidth_rad_s", bandwidth, is_possible, requirement)
    }
}
