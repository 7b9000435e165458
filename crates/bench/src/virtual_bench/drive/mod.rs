//! From the torque demand to the air-gap torque.

mod knowledge;
mod lag;

pub(crate) use knowledge::Knowledge;
pub(crate) use lag::{Inverter, TimedDemand};
