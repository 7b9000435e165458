//! How sure delays are.

/// Confidence of intervals.
pub(super) const LEVEL: f64 = 0.95;
