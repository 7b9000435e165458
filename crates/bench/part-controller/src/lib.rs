//! The dynamometer's speed controller: its estimator, and what recordings show of it.

mod recordings;
pub mod speed_control;
pub mod speed_controller;

pub use recordings::SpeedControllers;
