//! The dynamometer's speed controller: its estimator, and what recordings show of it.

pub mod speed_controller;

pub use speed_controller::SpeedControllers;
