//! Everything a virtual bench is made of, in SI.

mod clocks;
mod controller;
mod drive;
mod engine;
mod error;
mod loss;
mod machine;
mod mechanics;
mod sensors;
mod slider_crank;

use serde::{Deserialize, Serialize};

use crate::facts::BenchVariant;
pub use clocks::ClockParameters;
pub use controller::ControllerParameters;
pub use drive::{DriveParameters, MachineKnowledge};
pub use engine::{CycleHarmonic, EngineParameters, Harmonic, ThrottleMap};
pub use error::{ParameterError, require};
pub(crate) use error::{require_not_negative, require_positive};
pub use loss::{LossFactor, RelaxingSpring, RelaxingSprings};
pub use machine::InductionMachine;
pub use mechanics::{DualMassFlywheel, DynoTwist, MechanicsParameters};
pub use sensors::{FlangeParameters, ONCE_A_TURN, PulseParameters, SensorParameters};
pub use slider_crank::SliderCrank;

/// The parameters of a virtual bench. `Default` resembles the DTB bench of Glans & Kärnell (Chalmers EX112/2018):
/// four-stroke engine with four cylinders, load cell, welded flywheel, shaft resonance near 18 Hz.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BenchParameters {
    /// How torque is measured: by a load cell (DTB) or a flange (TB).
    pub variant: BenchVariant,
    /// Inertias, shaft and friction.
    pub mechanics: MechanicsParameters,
    /// The dynamometer's speed controller.
    pub controller: ControllerParameters,
    /// The drive, drive and machine: from T_d* to the real air-gap torque.
    pub drive: DriveParameters,
    /// The engine and its control.
    pub engine: EngineParameters,
    /// Encoders, load cell, computed torques.
    pub sensors: SensorParameters,
    /// The clocks of the recording.
    pub clocks: ClockParameters,
}

impl Default for BenchParameters {
    fn default() -> Self {
        Self {
            variant: BenchVariant::LoadCell,
            mechanics: MechanicsParameters::default(),
            controller: ControllerParameters::default(),
            drive: DriveParameters::default(),
            engine: EngineParameters::default(),
            sensors: SensorParameters::default(),
            clocks: ClockParameters::default(),
        }
    }
}

impl BenchParameters {
    /// A bench like the default one but of variant TB: a torque flange, and a dual-mass flywheel that makes it a
    /// three-mass system (thesis §3.5).
    #[must_use]
    pub fn torque_flange() -> Self {
        let flywheel = Some(DualMassFlywheel::default());
        let mechanics = MechanicsParameters { flywheel, ..MechanicsParameters::default() };
        Self { variant: BenchVariant::TorqueFlange, mechanics, ..Self::default() }
    }

    /// With every option that there is, whether or not they go together: all keys that a file of parameters may hold.
    pub(crate) fn with_every_option() -> Self {
        let mut all = Self::torque_flange();
        all.mechanics.shaft_loss =
            Some(LossFactor { loss_factor: 0.1, reference_hz: 18.0, lowest_hz: 1.0, highest_hz: 100.0 });
        all.mechanics.dyno_twist =
            Some(DynoTwist { coupling_inertia_kg_m2: 0.05, stiffness_nm_per_rad: 1e5, damping_nm_s_per_rad: 10.0 });
        all.drive.machine = Some(InductionMachine::default());
        all.engine.slider_crank = Some(SliderCrank::default());
        all.sensors.pulses = Some(PulseParameters::default());
        all
    }

    /// Checks every parameter that has impossible values.
    ///
    /// # Errors
    ///
    /// [`ParameterError`] naming the first impossible one.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.mechanics.check()?;
        self.controller.check()?;
        self.drive.check()?;
        self.engine.check()?;
        self.sensors.check()?;
        self.clocks.check()
    }
}
