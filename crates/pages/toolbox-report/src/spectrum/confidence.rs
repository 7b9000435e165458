//! How sure spectra are.

/// Confidence of bands.
pub(super) const LEVEL: f64 = 0.95;
/// Probability that chance makes a peak anywhere in a spectrum.
pub(super) const FALSE_ALARM: f64 = 0.05;
