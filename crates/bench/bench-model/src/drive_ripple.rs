//! Ripple of the drive: what is added to T_d, and what it is multiplied by, at lines of its own.

use std::f64::consts::TAU;

use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};

/// One line of the drive's ripple, v cos φ + w sin φ + T (p cos φ + q sin φ), φ = 2πf(t − t_ref), on the torque T.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RippleLine {
    /// f, Hz.
    pub frequency_hz: f64,
    /// v, w, Nm.
    pub additive_nm: [f64; 2],
    /// p, q, in parts of the torque.
    pub relative: [f64; 2],
}

impl RippleLine {
    /// The line's (factor, addend): what multiplies T beyond one, and what is added, a time after t_ref.
    pub fn parts(&self, since_s: f64) -> (f64, f64) {
        let (sin, cos) = (TAU * self.frequency_hz * since_s).sin_cos();
        let sum = |p: [f64; 2]| p[0] * cos + p[1] * sin;
        (sum(self.relative), sum(self.additive_nm))
    }
}

/// How recordings show the torque of the drive: what their own T_d needs beside the model.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordedTorque {
    /// The delay from T_d* to T_d,calc as both are stamped, s; the skew of T_d,calc is in it.
    pub delay_s: f64,
    /// Lines of the drive's ripple, Hz. Their size and phase are those of a recording.
    pub ripple_hz: Vec<f64>,
}

/// Offset and ripple of T_d in one recording: T_d = m (1 + r) + w on the torque m without them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DriveRipple {
    /// o, Nm: offset of T_d,calc against the demand.
    #[serde(deserialize_with = "nan_if_null")]
    pub offset_nm: f64,
    /// Ripple lines, strongest first.
    #[serde(rename = "ripple")]
    pub lines: Vec<RippleLine>,
    /// t_ref, s of the recording's clock.
    #[serde(deserialize_with = "nan_if_null")]
    pub reference_s: f64,
}

impl DriveRipple {
    /// Ripple at an instant of the recording's clock: r and w, Nm; the offset is part of w.
    pub fn at(&self, time_s: f64) -> (f64, f64) {
        let parts = self.lines.iter().map(|line| line.parts(time_s - self.reference_s));
        parts.fold((0.0, self.offset_nm), |sum, part| (sum.0 + part.0, sum.1 + part.1))
    }
}
