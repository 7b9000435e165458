//! The dynamometer's controllers, which run every millisecond.

mod shaft_torque;
mod speed;

pub(crate) use shaft_torque::ShaftTorqueController;
pub(crate) use speed::SpeedController;
