//! Ripple that the drive puts onto the air-gap torque.

use crate::simulate::error::SimulationError;

/// A known ripple r, w of the air-gap torque T_d = m (1 + r) + w, straight between the samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ripple<'a> {
    /// r, relative to the torque; empty for none.
    pub relative: &'a [f64],
    /// w, Nm; empty for none.
    pub added_nm: &'a [f64],
}

impl Ripple<'_> {
    /// No ripple.
    pub const NONE: Ripple<'static> = Ripple { relative: &[], added_nm: &[] };

    pub(super) fn check_length(self, expected: usize) -> Result<(), SimulationError> {
        for series in [self.relative, self.added_nm] {
            if !series.is_empty() && series.len() != expected {
                return Err(SimulationError::Length { what: "ripple", expected, found: series.len() });
            }
        }
        Ok(())
    }

    /// m r + w, `position` of a sample interval after sample `k`; beyond the last sample it stays.
    pub(super) fn upon(self, torque_nm: f64, k: usize, position: f64) -> f64 {
        torque_nm * between(self.relative, k, position) + between(self.added_nm, k, position)
    }
}

/// A series `position` of a sample interval after sample `k`; beyond the last sample it stays, an empty one is zero.
pub(super) fn between(series: &[f64], k: usize, position: f64) -> f64 {
    let at = |i: usize| series.get(i).or(series.last()).copied().unwrap_or(0.0);
    at(k) + (at(k + 1) - at(k)) * position
}
