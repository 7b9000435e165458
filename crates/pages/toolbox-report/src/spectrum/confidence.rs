//! How sure spectra are.

/// Probability that chance makes a peak anywhere in a spectrum.
pub(super) const FALSE_ALARM: f64 = 0.05;
