//! The parts of the bench, one after another: what it is, its equation, its numbers, how it was judged.

mod control;
mod shaft;
mod timing;

pub(crate) use control::{feed_forward, speed_controller, torque_control};
pub(crate) use shaft::shaft;
pub(crate) use timing::timing;
