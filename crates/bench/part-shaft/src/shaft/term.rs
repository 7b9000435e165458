//! Terms that may be in a shaft beyond stiffness and damping.

use serde::{Deserialize, Serialize};

/// A term beyond the simple shaft.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Term {
    /// K (1 + iη) in place of K: damping that does not grow with frequency.
    LossFactor,
    /// A mass between shaft and engine: ω_e (1 − m s²) in place of ω_e, m = J/K of that mass and the spring behind it,
    /// the first effect of a dual-mass flywheel.
    SecondMass,
    /// That flywheel as it is: a mass, and a spring with damping behind it. It has three parameters and is no
    /// `TermTest`; see [`super::Wanted::DualMass`].
    DualMass,
    /// K changes with the weight, as a part of K.
    OfStiffness(Weight),
    /// B changes with the weight, in Nm s/rad.
    OfDamping(Weight),
}

/// Weights with which stiffness or damping may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Weight {
    /// T_shaft less its mean, per 100 Nm.
    Torque,
    /// The square of that less its mean, per (100 Nm)².
    TorqueSquared,
    /// N_d less its mean, per 1000 rpm.
    Speed,
    /// How near to zero T_shaft is, e^{−(T/5 Nm)²}: −1 where the shaft is loose about zero torque.
    NearZeroTorque,
}
