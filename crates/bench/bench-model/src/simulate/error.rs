//! Why the model cannot be simulated.

use rig::results::Part;

/// Why a simulation cannot run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// The model lacks a part the drive needs.
    #[error("the model has no {}", name(*.part))]
    MissingPart {
        /// Which part.
        part: Part,
    },
    /// Inputs differ in length, or there is none.
    #[error("{what}: {found} samples where {expected} are needed")]
    Length {
        /// Which input.
        what: &'static str,
        /// Samples expected.
        expected: usize,
        /// Samples found.
        found: usize,
    },
    /// The inputs do not stand on the controller's clock.
    #[error("inputs every {inputs_s} s, but the controller runs every {controller_s} s")]
    Clock {
        /// Sample time of the inputs, s.
        inputs_s: f64,
        /// Sample time of the controller, s.
        controller_s: f64,
    },
    /// The model has no exact discrete form.
    #[error(transparent)]
    Discretisation(#[from] lti::LtiError),
}

/// A part that a simulation may need.
fn name(part: Part) -> &'static str {
    match part {
        Part::SpeedController => "speed controller",
        Part::FeedForward => "feed-forward",
        Part::TorqueControl => "torque control",
        Part::Shaft => "shaft",
        Part::Timing | Part::Whole => "such part",
    }
}
