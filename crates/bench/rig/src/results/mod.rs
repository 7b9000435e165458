//! The plain types that estimates, their judgement and their outcomes are given in. They hold numbers and structure
//! only.

mod estimate;
mod outcome;
mod part;
mod parts;
mod validation;

pub use crate::quantity::{
    Notation, Quantity, ReadNotation, WrittenQuantity, read_notation, read_symbol, write_notation, write_quantity,
    write_symbol,
};
pub use estimate::{Estimate, Parameter, Stretch, WrittenParameter};
pub use outcome::{
    Found, Outcome, ReadStatus, Reason, read_found, read_if_sought, read_status, write_found, write_if_sought,
    write_status,
};
pub use part::Part;
pub use parts::{
    DelayPlace, DelayRoute, DemandLags, FeedForward, MeasuredResponse, ResidualSpectrum, Shaft, SharedError,
    SignalDelay, SpeedController, Timing, TorqueControl,
};
pub use validation::{ResidualTest, Trace, Validation};
