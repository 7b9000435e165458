//! The torque side of a bench: torque control from T_d* to T_d, its order, and the torque signals with their delays.

pub mod air_gap_torque;
pub mod demand_clock;
pub mod model_comparison;
mod recordings;
pub mod ripple_clock;
pub mod timing;
pub mod torque_control;
pub mod torque_signals;
pub mod torque_smoother;

pub use recordings::TorqueControls;
