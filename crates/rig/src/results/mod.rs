//! The plain types that estimates, their judgement and their outcomes are given in. They hold numbers and structure only.

mod estimate;
mod outcome;
mod parts;
mod validation;

pub use estimate::{Estimate, Parameter, Stretch};
pub use outcome::{Need, Part, Told, Untold};
pub use parts::{
    DelayRoute, FeedForward, MeasuredResponse, ResidualSpectrum, Shaft, SignalDelay, SpeedController, Timing,
    TorqueControl,
};
pub use validation::{ResidualTest, Trace, Validation};
