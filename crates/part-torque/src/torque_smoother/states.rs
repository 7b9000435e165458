//! Places of the smoother's states.

/// Where the logarithms stand; each line's after that of the damping.
pub(crate) const WANDERING: usize = 0;

pub(crate) const TORQUE: usize = 1;

pub(crate) const DAMPING: usize = 2;
