//! placeholder until the data branch lands
/// rad/s per rpm.
pub const RPM_RAD_S: f64 = std::f64::consts::TAU / 60.0;
