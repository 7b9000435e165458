//! Inertias, shaft, flywheel and friction.

use serde::{Deserialize, Serialize};

use crate::virtual_bench::error::{VirtualBenchError, require, require_not_negative, require_positive};
use crate::virtual_bench::train::RelaxingSprings;

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

/// Damping of rubber and the like: the complex stiffness is K(1 + iη) near the reference, and its loss factor stays
/// near η over the band, where a viscous damper's grows with frequency. Below and above the band it falls off.
///
/// A sum of relaxing springs: K(ω) = K_0 (1 + Σ g_i iωτ_i/(1 + iωτ_i)), two τ_i a decade, such that real part and loss
/// factor at the reference are K and η. The real part grows slowly with frequency, as causality asks for.
///
/// # Source
///
/// Wiechert's model; see Tschoegl, *The Phenomenological Theory of Linear Viscoelastic Behavior*, 1989, §3.5.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LossFactor {
    /// η, 1.
    pub loss_factor: f64,
    /// Frequency at which stiffness and loss factor are those stated, Hz.
    pub reference_hz: f64,
    /// Lower end of the band, Hz.
    pub lowest_hz: f64,
    /// Upper end of the band, Hz.
    pub highest_hz: f64,
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
    pub(super) fn check(&self) -> Result<(), VirtualBenchError> {
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

impl LossFactor {
    fn check(&self, backlash_rad: f64) -> Result<(), VirtualBenchError> {
        let (low, reference, high) = (self.lowest_hz, self.reference_hz, self.highest_hz);
        require("mechanics.shaft_loss", backlash_rad, backlash_rad == 0.0, "without backlash")?;
        let eta = self.loss_factor;
        require("mechanics.shaft_loss.loss_factor", eta, (0.0..=0.5).contains(&eta), "between 0 and 0.5")?;
        require("mechanics.shaft_loss.lowest_hz", low, low >= 1e-3, "at least 1 mHz")?;
        let requirement = "within the band";
        require("mechanics.shaft_loss.reference_hz", reference, (low..=high).contains(&reference), requirement)?;
        require("mechanics.shaft_loss.highest_hz", high, high <= 1e4 * low, "at most 10 000 times the lowest")?;
        let ratio = RelaxingSprings::new(Some(*self)).static_ratio;
        require("mechanics.shaft_loss.static_ratio", ratio, ratio > 0.0 && ratio <= 1.0, "reached by a narrower band")
    }
}

impl DynoTwist {
    fn check(&self, dyno_inertia_kg_m2: f64) -> Result<(), VirtualBenchError> {
        let coupling = self.coupling_inertia_kg_m2;
        let is_part = coupling > 0.0 && coupling < dyno_inertia_kg_m2;
        require("mechanics.dyno_twist.coupling_inertia_kg_m2", coupling, is_part, "above zero and less than J_d")?;
        require_positive("mechanics.dyno_twist.stiffness_nm_per_rad", self.stiffness_nm_per_rad)?;
        require_not_negative("mechanics.dyno_twist.damping_nm_s_per_rad", self.damping_nm_s_per_rad)
    }
}

impl DualMassFlywheel {
    fn check(&self, engine_inertia_kg_m2: f64) -> Result<(), VirtualBenchError> {
        let secondary = self.secondary_inertia_kg_m2;
        let is_part = secondary > 0.0 && secondary < engine_inertia_kg_m2;
        require("mechanics.flywheel.secondary_inertia_kg_m2", secondary, is_part, "above zero and less than J_e")?;
        require_positive("mechanics.flywheel.stiffness_nm_per_rad", self.stiffness_nm_per_rad)?;
        require_not_negative("mechanics.flywheel.damping_nm_s_per_rad", self.damping_nm_s_per_rad)
    }
}
