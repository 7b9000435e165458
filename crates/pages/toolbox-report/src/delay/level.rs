//! How sure delays are.

/// Confidence of intervals.
pub(super) const LEVEL: f64 = 0.95;

/// A time stamp is trusted to this part of the clock either way.
pub(super) const DATED: f64 = 1.0 / 20.0;
