//! Readings as registers hold them.

/// The nearest multiple of a resolution; the value itself where the resolution is zero.
pub(crate) fn rounded(value: f64, resolution: f64) -> f64 {
    if resolution > 0.0 { (value / resolution).round() * resolution } else { value }
}
