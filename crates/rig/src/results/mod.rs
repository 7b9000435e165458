//! The plain types that estimates, their judgement and their outcomes are given in. They hold numbers and structure only.

mod estimate;
mod notation;
mod outcome;
mod part;
mod parts;
mod quantity;
mod validation;

pub use estimate::{Estimate, Parameter, Stretch, WrittenParameter};
pub use notation::{Notation, write_notation, write_symbol};
pub use outcome::{Outcome, Reason, write_found, write_if_sought};
pub use part::Part;
pub use parts::{
    DelayRoute, FeedForward, MeasuredResponse, ResidualSpectrum, Shaft, SignalDelay, SpeedController, Timing,
    TorqueControl,
};
pub use quantity::Quantity;
pub use validation::{ResidualTest, Trace, Validation};
