//! The numbers of a bench model, each by its name, so that uncertainty can be passed through any function of them.

use std::fmt;

use rig::results::Quantity;
use serde::{Deserialize, Serialize};

use super::BenchModel;

/// One number of a [`BenchModel`], in SI: those of the [`Quantity`]s that make up the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ModelParameter {
    /// J_d, kg m².
    DynoInertia,
    /// J_e, kg m².
    EngineInertia,
    /// K, Nm/rad.
    Stiffness,
    /// B, Nm s/rad.
    Damping,
    /// K_p, Nm s/rad.
    Proportional,
    /// K_i, Nm/rad.
    Integral,
    /// τ, s.
    ControllerDelay,
    /// k, Nm s/rad.
    SpeedFeedForward,
    /// k_a, Nm s²/rad.
    AccelerationFeedForward,
    /// d, s.
    TorqueControlDelay,
    /// a, rad/s.
    TorqueControlBandwidth,
}

impl ModelParameter {
    /// All of them: masses and shaft, speed controller, feed-forward, torque control.
    pub const ALL: [ModelParameter; 11] = [
        ModelParameter::DynoInertia,
        ModelParameter::EngineInertia,
        ModelParameter::Stiffness,
        ModelParameter::Damping,
        ModelParameter::Proportional,
        ModelParameter::Integral,
        ModelParameter::ControllerDelay,
        ModelParameter::SpeedFeedForward,
        ModelParameter::AccelerationFeedForward,
        ModelParameter::TorqueControlDelay,
        ModelParameter::TorqueControlBandwidth,
    ];

    /// The quantity it is, in estimates.
    #[must_use]
    pub fn quantity(self) -> Quantity {
        match self {
            ModelParameter::DynoInertia => Quantity::DynoInertia,
            ModelParameter::EngineInertia => Quantity::EngineInertia,
            ModelParameter::Stiffness => Quantity::Stiffness,
            ModelParameter::Damping => Quantity::Damping,
            ModelParameter::Proportional => Quantity::ProportionalGain,
            ModelParameter::Integral => Quantity::IntegralGain,
            ModelParameter::ControllerDelay => Quantity::ControllerDelay,
            ModelParameter::SpeedFeedForward => Quantity::SpeedFeedForward,
            ModelParameter::AccelerationFeedForward => Quantity::AccelerationFeedForward,
            ModelParameter::TorqueControlDelay => Quantity::TorqueControlDelay,
            ModelParameter::TorqueControlBandwidth => Quantity::TorqueControlBandwidth,
        }
    }

    /// Its symbol; it separates the two delays, which have the same one in their own parts.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            ModelParameter::ControllerDelay => "τ of the speed controller",
            other => other.quantity().symbol(),
        }
    }

    /// A symbol that no other number of the model has: the delays are τ_c and τ_t.
    #[must_use]
    pub fn distinct_symbol(self) -> &'static str {
        match self {
            ModelParameter::ControllerDelay => "τ_c",
            ModelParameter::TorqueControlDelay => "τ_t",
            other => other.quantity().symbol(),
        }
    }

    /// Where it is in the `model` of a bench model file.
    pub(crate) fn field(self) -> &'static str {
        match self {
            ModelParameter::DynoInertia => "mechanics.dyno_inertia_kg_m2",
            ModelParameter::EngineInertia => "mechanics.engine_inertia_kg_m2",
            ModelParameter::Stiffness => "mechanics.stiffness_nm_per_rad",
            ModelParameter::Damping => "mechanics.damping_nm_s_per_rad",
            ModelParameter::Proportional => "speed_controller.proportional_nm_s_per_rad",
            ModelParameter::Integral => "speed_controller.integral_nm_per_rad",
            ModelParameter::ControllerDelay => "speed_controller.delay_s",
            ModelParameter::SpeedFeedForward => "feed_forward.speed_nm_s_per_rad",
            ModelParameter::AccelerationFeedForward => "feed_forward.acceleration_nm_s2_per_rad",
            ModelParameter::TorqueControlDelay => "torque_control.delay_s",
            ModelParameter::TorqueControlBandwidth => "torque_control.bandwidth_rad_s",
        }
    }

    /// Values that a bench can have, generously: from the rotor of a toy to a ship's engine.
    pub(crate) fn bound(self) -> Bound {
        match self {
            ModelParameter::DynoInertia | ModelParameter::EngineInertia => Bound::new(1e-6, 1e6, "kg m²"),
            ModelParameter::Stiffness => Bound::new(1e-2, 1e10, "Nm/rad"),
            ModelParameter::Damping => Bound::new(0.0, 1e7, "Nm s/rad"),
            ModelParameter::Proportional => Bound::within(1e8, "Nm s/rad"),
            ModelParameter::Integral => Bound::within(1e10, "Nm/rad"),
            ModelParameter::SpeedFeedForward => Bound::within(1e6, "Nm s/rad"),
            ModelParameter::AccelerationFeedForward => Bound::within(1e6, "Nm s²/rad"),
            ModelParameter::ControllerDelay | ModelParameter::TorqueControlDelay => Bound::new(0.0, 1.0, "s"),
            ModelParameter::TorqueControlBandwidth => Bound::new(1e-3, 1e9, "rad/s"),
        }
    }

    /// Tells whether a bench can have this value.
    pub(crate) fn can_be(self, value: f64) -> bool {
        self.bound().allows(value)
    }
}

/// The values that a number can have, both ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    low: f64,
    high: f64,
    unit: &'static str,
}

impl Bound {
    pub(crate) const fn new(low: f64, high: f64, unit: &'static str) -> Self {
        Bound { low, high, unit }
    }

    /// Of either sign, up to this magnitude.
    pub(crate) const fn within(most: f64, unit: &'static str) -> Self {
        Bound::new(-most, most, unit)
    }

    pub(crate) fn allows(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// The largest magnitude.
    pub(crate) fn largest(self) -> f64 {
        self.high
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let range = format!("{} to {} {}", short(self.low), short(self.high), self.unit);
        f.write_str(range.trim_end())
    }
}

/// A number without a long row of zeros.
pub(crate) fn short(value: f64) -> String {
    let is_plain = value == 0.0 || (1e-4..1e7).contains(&value.abs());
    if is_plain { value.to_string() } else { format!("{value:e}") }
}

impl BenchModel {
    /// A parameter's value; `None` where the model lacks the part.
    pub fn value(&self, parameter: ModelParameter) -> Option<f64> {
        self.clone().slot(parameter).map(|slot| *slot)
    }

    /// The model with one parameter changed; unchanged where it lacks the part.
    #[must_use]
    pub fn with(&self, parameter: ModelParameter, value: f64) -> Self {
        let mut changed = self.clone();
        if let Some(slot) = changed.slot(parameter) {
            *slot = value;
        }
        changed
    }

    fn slot(&mut self, parameter: ModelParameter) -> Option<&mut f64> {
        let mechanics = &mut self.mechanics;
        let (pi, torque_control) = (self.speed_controller.as_mut(), self.torque_control.as_mut());
        let feed_forward = self.feed_forward.as_mut();
        match parameter {
            ModelParameter::DynoInertia => Some(&mut mechanics.dyno_inertia_kg_m2),
            ModelParameter::EngineInertia => Some(&mut mechanics.engine_inertia_kg_m2),
            ModelParameter::Stiffness => Some(&mut mechanics.stiffness_nm_per_rad),
            ModelParameter::Damping => Some(&mut mechanics.damping_nm_s_per_rad),
            ModelParameter::Proportional => pi.map(|p| &mut p.proportional_nm_s_per_rad),
            ModelParameter::Integral => pi.map(|p| &mut p.integral_nm_per_rad),
            ModelParameter::ControllerDelay => pi.map(|p| &mut p.delay_s),
            ModelParameter::SpeedFeedForward => feed_forward.map(|f| &mut f.speed_nm_s_per_rad),
            ModelParameter::AccelerationFeedForward => feed_forward.map(|f| &mut f.acceleration_nm_s2_per_rad),
            ModelParameter::TorqueControlDelay => torque_control.map(|i| &mut i.delay_s),
            ModelParameter::TorqueControlBandwidth => torque_control.and_then(|i| i.bandwidth_rad_s.as_mut()),
        }
    }
}
