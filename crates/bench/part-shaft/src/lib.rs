//! The shaft: stiffness, damping and what is beyond them, by several routes.

mod parts;
pub mod shaft;
pub mod shaft_analysis;
pub mod shaft_inputs;
pub mod shaft_routes;

pub use parts::Parts;
