//! How sure delays are.

/// A time stamp is trusted to this part of the clock either way.
pub(super) const DATED: f64 = 1.0 / 20.0;
