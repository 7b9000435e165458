//! How sure numbers are.

/// Confidence of intervals and bands.
pub(crate) const LEVEL: f64 = 0.95;
