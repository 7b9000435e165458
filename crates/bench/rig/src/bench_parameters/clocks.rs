//! The clocks of the recording.

use serde::{Deserialize, Serialize};

use crate::bench_parameters::{ParameterError, require};

/// The clocks of the recording. A sample taken at time t after the start is stamped t (1 + drift) + offset + skew
/// with the skew and drift of its raster: a positive skew makes the raster's signals late, a positive drift ever later.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ClockParameters {
    /// Time stamp of the recording's start, s.
    pub start_offset_s: f64,
    /// Updates (1 ms) from one sample of the engine's speed to the next.
    pub engine_speed_decimation: usize,
    /// Updates (1 ms) from one sample of the torques to the next.
    pub torque_decimation: usize,
    /// Skew of the raster of N_d, N_d*, T_d*, s.
    pub fast_skew_s: f64,
    /// Skew of the engine speed's raster, s.
    pub engine_speed_skew_s: f64,
    /// Skew of the torques' raster, s.
    pub torque_skew_s: f64,
    /// Drift of the raster of N_d, N_d*, T_d*, s/s.
    pub fast_drift: f64,
    /// Drift of the engine speed's raster, s/s.
    pub engine_speed_drift: f64,
    /// Drift of the torques' raster, s/s.
    pub torque_drift: f64,
}

impl Default for ClockParameters {
    fn default() -> Self {
        Self {
            start_offset_s: 0.0,
            engine_speed_decimation: 2,
            torque_decimation: 4,
            fast_skew_s: 0.0,
            engine_speed_skew_s: 0.0,
            torque_skew_s: 0.0,
            fast_drift: 0.0,
            engine_speed_drift: 0.0,
            torque_drift: 0.0,
        }
    }
}

impl ClockParameters {
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        let decimations = [
            ("clocks.engine_speed_decimation", self.engine_speed_decimation),
            ("clocks.torque_decimation", self.torque_decimation),
        ];
        for (name, value) in decimations {
            require(name, value as f64, value > 0, "at least 1")?;
        }
        let times = [
            ("clocks.start_offset_s", self.start_offset_s),
            ("clocks.fast_skew_s", self.fast_skew_s),
            ("clocks.engine_speed_skew_s", self.engine_speed_skew_s),
            ("clocks.torque_skew_s", self.torque_skew_s),
        ];
        for (name, value) in times {
            require(name, value, true, "finite")?;
        }
        let drifts = [
            ("clocks.fast_drift", self.fast_drift),
            ("clocks.engine_speed_drift", self.engine_speed_drift),
            ("clocks.torque_drift", self.torque_drift),
        ];
        for (name, value) in drifts {
            require(name, value, value.abs() <= 0.01, "at most 1 %")?;
        }
        Ok(())
    }
}
