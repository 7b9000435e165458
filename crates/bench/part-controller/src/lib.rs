//! The dynamometer's speed controller: its estimator, what recordings show of it, and what noise
//! does to the estimate.

pub mod noise_test;
pub mod speed_controller;

pub use speed_controller::SpeedControllers;
