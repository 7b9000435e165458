//! Demands with the instants at which they take effect.

/// A demand that takes effect at a time and is held until the next one does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TimedDemand {
    pub(crate) time_s: f64,
    pub(crate) torque_nm: f64,
}
