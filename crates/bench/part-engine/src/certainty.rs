//! How certain a rebuilt torque is, in a few numbers.

use numerics::order::upper_median;
use part_torque::torque_smoother::TorqueSource;
use serde::Serialize;

use crate::RebuiltEngine;

/// Normal quantile of a 95 % interval.
const QUANTILE_95: f64 = 1.96;

/// Certainty of a rebuilt torque of the engine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Certainty {
    /// Source of T_d.
    pub torque: TorqueSource,
    /// Median of the half widths of the 95 % intervals, Nm.
    pub half_width_nm: f64,
    /// The same of the part that is of the masses and the shaft, Nm.
    pub of_masses_nm: f64,
    /// Amplitude at order 1, Nm, of an error of 10⁻⁴ of the speed, once a turn, of the engine's encoder.
    pub once_a_turn_nm: f64,
    /// By what the deviations by noise are multiplied, one or more.
    pub widening: f64,
    /// True where the search for the noise levels reached a maximum.
    pub converged: bool,
}

impl RebuiltEngine {
    /// How certain the torque is.
    pub fn certainty(&self) -> Certainty {
        let half = |deviations: &[f64]| QUANTILE_95 * upper_median(&mut deviations.to_vec()).unwrap_or(f64::NAN);
        Certainty {
            torque: self.torque,
            half_width_nm: half(&self.standard_deviation_nm),
            of_masses_nm: half(&self.of_masses_nm),
            once_a_turn_nm: self.once_a_turn_nm,
            widening: self.noise.widening,
            converged: self.noise.converged,
        }
    }
}
