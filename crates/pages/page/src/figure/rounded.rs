//! Numbers of a figure: rounded to what a plot can show, and never NaN or infinite in the file.

use serde::{Serialize, Serializer};

/// A number that is written with five significant digits, or as `null` when it is not finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounded(pub f64);

impl Serialize for Rounded {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if !self.0.is_finite() {
            return serializer.serialize_none();
        }
        let value: f64 = format!("{:.4e}", self.0).parse().unwrap_or(self.0);
        if value.fract() == 0.0 && value.abs() < 1e9 {
            return serializer.serialize_i64(value as i64);
        }
        serializer.serialize_f64(value)
    }
}

/// Each number of a slice.
pub fn rounded(values: &[f64]) -> Vec<Rounded> {
    values.iter().copied().map(Rounded).collect()
}
