//! Inertias, shaft, flywheel and friction.

use serde::{Deserialize, Serialize};

use crate::bench_parameters::{LossFactor, ParameterError, require, require_not_negative, require_positive};

/// Masses and the shafts between them; as it stands, two masses and one shaft: J_d dω_d/dt = T_shaft − T_d − T_fric,
/// J_e dω_e/dt = T_e − T_shaft, T_shaft = K φ + B (ω_e − ω_d), dφ/dt = ω_e − ω_d (thesis 6.1, 6.4, 2.7).
///
/// The options add: backlash and stiffening, T_shaft = K p + K_3 p³ + B dp/dt with p the twist beyond the play;
/// loss-factor damping; a rotor that twists against its coupling; a dual-mass flywheel, which makes three masses of
/// two.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MechanicsParameters {
    /// J_d, inertia of the dynamometer, kg m².
    pub dyno_inertia_kg_m2: f64,
    /// J_e, inertia of engine and flywheel, both its sides included, kg m².
    pub engine_inertia_kg_m2: f64,
    /// K, shaft stiffness, Nm/rad.
    pub shaft_stiffness_nm_per_rad: f64,
    /// B, shaft damping, Nm s/rad.
    pub shaft_damping_nm_s_per_rad: f64,
    /// Play of the shaft from stop to stop, rad; zero: none.
    pub shaft_backlash_rad: f64,
    /// K_3, stiffening of the shaft, Nm/rad³; zero: none.
    pub shaft_stiffening_nm_per_rad3: f64,
    /// Damping of the shaft by a loss factor, beside B.
    pub shaft_loss: Option<LossFactor>,
    /// The twist of the dynamometer itself; none: a stiff rotor.
    pub dyno_twist: Option<DynoTwist>,
    /// A dual-mass flywheel (bench variant TB); none: a welded one.
    pub flywheel: Option<DualMassFlywheel>,
    /// Coulomb friction of the dynamometer's bearings, Nm.
    pub coulomb_friction_nm: f64,
    /// Viscous friction of the dynamometer's bearings, Nm s/rad.
    pub viscous_friction_nm_s_per_rad: f64,
}

/// The rotor, on which the air-gap torque and the bearings act and whose end the encoder sits on, twists against the
/// coupling, to which the shaft is bolted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DynoTwist {
    /// Inertia of the coupling, part of J_d, kg m².
    pub coupling_inertia_kg_m2: f64,
    /// Stiffness between rotor and coupling, Nm/rad.
    pub stiffness_nm_per_rad: f64,
    /// Damping between rotor and coupling, Nm s/rad.
    pub damping_nm_s_per_rad: f64,
}

/// A flywheel of two masses: the secondary is bolted to the shaft, the primary to the crankshaft (thesis, figure 3.5).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DualMassFlywheel {
    /// Inertia of the secondary side, part of J_e, kg m².
    pub secondary_inertia_kg_m2: f64,
    /// K_fw, stiffness between the sides, Nm/rad.
    pub stiffness_nm_per_rad: f64,
    /// B_fw, damping between the sides, Nm s/rad.
    pub damping_nm_s_per_rad: f64,
}

impl Default for DualMassFlywheel {
    /// A passenger car's: with the default bench's shaft and inertias, resonances near 7 and 32 Hz.
    fn default() -> Self {
        Self { secondary_inertia_kg_m2: 0.08, stiffness_nm_per_rad: 650.0, damping_nm_s_per_rad: 2.5 }
    }
}

impl Default for MechanicsParameters {
    fn default() -> Self {
        Self {
            dyno_inertia_kg_m2: 0.6,
            engine_inertia_kg_m2: 0.28,
            shaft_stiffness_nm_per_rad: 2437.7,
            shaft_damping_nm_s_per_rad: 5.8,
            shaft_backlash_rad: 0.0,
            shaft_stiffening_nm_per_rad3: 0.0,
            shaft_loss: None,
            dyno_twist: None,
            flywheel: None,
            coulomb_friction_nm: 0.0,
            viscous_friction_nm_s_per_rad: 0.0,
        }
    }
}

impl MechanicsParameters {
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        require_positive("mechanics.dyno_inertia_kg_m2", self.dyno_inertia_kg_m2)?;
        require_positive("mechanics.engine_inertia_kg_m2", self.engine_inertia_kg_m2)?;
        require_positive("mechanics.shaft_stiffness_nm_per_rad", self.shaft_stiffness_nm_per_rad)?;
        require_not_negative("mechanics.shaft_damping_nm_s_per_rad", self.shaft_damping_nm_s_per_rad)?;
        require_not_negative("mechanics.shaft_backlash_rad", self.shaft_backlash_rad)?;
        require_not_negative("mechanics.shaft_stiffening_nm_per_rad3", self.shaft_stiffening_nm_per_rad3)?;
        require_not_negative("mechanics.coulomb_friction_nm", self.coulomb_friction_nm)?;
        require_not_negative("mechanics.viscous_friction_nm_s_per_rad", self.viscous_friction_nm_s_per_rad)?;
        self.shaft_loss.map_or(Ok(()), |loss| loss.check(self.shaft_backlash_rad))?;
        self.dyno_twist.map_or(Ok(()), |twist| twist.check(self.dyno_inertia_kg_m2))?;
        self.flywheel.map_or(Ok(()), |flywheel| flywheel.check(self.engine_inertia_kg_m2))
    }
}

impl DynoTwist {
    fn check(&self, dyno_inertia_kg_m2: f64) -> Result<(), ParameterError> {
        let coupling = self.coupling_inertia_kg_m2;
        let is_part = coupling > 0.0 && coupling < dyno_inertia_kg_m2;
        require("mechanics.dyno_twist.coupling_inertia_kg_m2", coupling, is_part, "above zero and less than J_d")?;
        require_positive("mechanics.dyno_twist.stiffness_nm_per_rad", self.stiffness_nm_per_rad)?;
        require_not_negative("mechanics.dyno_twist.damping_nm_s_per_rad", self.damping_nm_s_per_rad)
    }
}

impl DualMassFlywheel {
    fn check(&self, engine_inertia_kg_m2: f64) -> Result<(), ParameterError> {
        let secondary = self.secondary_inertia_kg_m2;
        let is_part = secondary > 0.0 && secondary < engine_inertia_kg_m2;
        require("mechanics.flywheel.secondary_inertia_kg_m2", secondary, is_part, "above zero and less than J_e")?;
        require_positive("mechanics.flywheel.stiffness_nm_per_rad", self.stiffness_nm_per_rad)?;
        require_not_negative("mechanics.flywheel.damping_nm_s_per_rad", self.damping_nm_s_per_rad)
    }
}
