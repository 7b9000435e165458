//! Cylinders on a crankshaft.

use serde::{Deserialize, Serialize};

use crate::bench_parameters::{ParameterError, require, require_not_negative, require_positive};

/// Geometry, gas and reciprocating mass of each cylinder, in place of the harmonics of the firing order.
///
/// Gas torque (p − p_0) A dx/dϑ with p = p_im (V_b/V)^κ + q w(ϑ) (V_c/V)^κ while the valves are shut: compression and
/// expansion without exchange of heat, and the burnt part w by Wiebe's function; p_im and q follow the torque
/// demanded of the firing. The mean over a cycle is the level; what the gas does not lose is friction, so that the
/// motored engine has its stated torque at idle pressure. Torque of the masses: T = −½ dM/dθ ω² − (M − M̄) dω/dt,
/// M = Σ m (dx/dθ)²; J_e has the mean M̄ in it.
///
/// # Source
///
/// Heywood, *Internal Combustion Engine Fundamentals*, 1988, §2.2 (geometry) and eq. 9.27 (Wiebe's function);
/// Eriksson & Nielsen, *Modeling and Control of Engines and Drivelines*, 2014, §7.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SliderCrank {
    /// Bore, m.
    pub bore_m: f64,
    /// Stroke, m.
    pub stroke_m: f64,
    /// λ, crank radius over length of the rod, 1.
    pub rod_ratio: f64,
    /// m, reciprocating mass of a cylinder, kg.
    pub reciprocating_mass_kg: f64,
    /// Compression ratio, 1.
    pub compression_ratio: f64,
    /// κ, 1.
    pub polytropic_exponent: f64,
    /// Pressure of the charge without torque, Pa.
    pub idle_pressure_pa: f64,
    /// Torque of the engine at which the charge has ambient pressure, Nm.
    pub full_torque_nm: f64,
    /// Start of the burn before top dead centre, rad.
    pub burn_start_rad: f64,
    /// Length of the burn, rad.
    pub burn_duration_rad: f64,
}

impl Default for SliderCrank {
    /// Four of these make two litres.
    fn default() -> Self {
        Self {
            bore_m: 0.082,
            stroke_m: 0.0945,
            rod_ratio: 0.3,
            reciprocating_mass_kg: 0.5,
            compression_ratio: 10.5,
            polytropic_exponent: 1.32,
            idle_pressure_pa: 0.35e5,
            full_torque_nm: 190.0,
            burn_start_rad: 0.3,
            burn_duration_rad: 1.0,
        }
    }
}

impl SliderCrank {
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        require_positive("engine.slider_crank.bore_m", self.bore_m)?;
        require_positive("engine.slider_crank.stroke_m", self.stroke_m)?;
        let ratio = self.rod_ratio;
        require("engine.slider_crank.rod_ratio", ratio, ratio > 0.0 && ratio < 0.9, "above 0 and below 0.9")?;
        require_not_negative("engine.slider_crank.reciprocating_mass_kg", self.reciprocating_mass_kg)?;
        let compression = self.compression_ratio;
        require("engine.slider_crank.compression_ratio", compression, compression > 1.0, "above 1")?;
        require_positive("engine.slider_crank.polytropic_exponent", self.polytropic_exponent)?;
        let idle = self.idle_pressure_pa;
        require("engine.slider_crank.idle_pressure_pa", idle, (0.0..=1e5).contains(&idle), "between 0 and 1e5")?;
        require_positive("engine.slider_crank.full_torque_nm", self.full_torque_nm)?;
        let start = self.burn_start_rad;
        require("engine.slider_crank.burn_start_rad", start, (0.0..=1.5).contains(&start), "between 0 and 1.5")?;
        let duration = self.burn_duration_rad;
        require("engine.slider_crank.burn_duration_rad", duration, (0.1..=2.0).contains(&duration), "between 0.1 and 2")
    }
}
