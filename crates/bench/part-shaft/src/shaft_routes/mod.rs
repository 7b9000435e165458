//! Further routes to the shaft, each of which errs in its own way: K and B that several of them find are worth more.
//!
//! | route | from | without |
//! | --- | --- | --- |
//! | [`state_space`] | (T_d, ω_e) → ω_d in the time domain, thesis (6.11) | differentiation, windows |
//! | [`black_box`] | T_d → ω_d alone, through the coefficients of an ARMAX model | ω_e but for the crank angle, J_d |
//! | [`multisine`] | mean spectra over the periods of a demand, weighted by their scatter | stated noise levels |

mod aligned;
pub mod black_box;
pub mod multisine;
pub mod state_space;

use numerics::null::nan_if_null;
use rig::estimation::{EstimateError, Unsuitable};
use rig::results::{Estimate, Parameter, Quantity, Stretch};
use serde::{Deserialize, Serialize};

use crate::shaft::ShaftInputs;

/// When the signals were taken, each with its standard uncertainty, s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Timing {
    /// δ_e: by how much N_e is dated later than N_d.
    #[serde(deserialize_with = "nan_if_null")]
    pub engine_skew_s: (f64, f64),
    /// δ_T: by how much the torque is dated later than N_d.
    #[serde(deserialize_with = "nan_if_null")]
    pub torque_skew_s: (f64, f64),
    /// T_g: gate of both encoders.
    #[serde(deserialize_with = "nan_if_null")]
    pub gate_s: (f64, f64),
}

impl Timing {
    /// Clocks that agree, and this gate.
    #[must_use]
    pub fn synchronous(gate_s: f64) -> Self {
        Timing { engine_skew_s: (0.0, 0.0), torque_skew_s: (0.0, 0.0), gate_s: (gate_s, 0.0) }
    }

    /// The timing that an estimate of the shaft found; none where it has no δ_e, δ_T or T_g.
    #[must_use]
    pub fn of(shaft: &Estimate) -> Option<Self> {
        let found = |quantity| shaft.parameter(quantity).map(|p| (p.value, p.standard_error));
        Some(Timing {
            engine_skew_s: found(Quantity::EngineSpeedSkew)?,
            torque_skew_s: found(Quantity::AirGapTorqueSkew)?,
            gate_s: found(Quantity::EncoderGates)?,
        })
    }
}

fn flange_torque(inputs: &ShaftInputs<'_>, route: &'static str) -> EstimateError {
    EstimateError::Unsuitable { file: inputs.file.to_owned(), reason: Unsuitable::FlangeTorque { route } }
}

/// Parameters with their covariance, as the study keeps them.
pub(super) fn estimate_of(
    found: &[(Quantity, f64)],
    covariance: Vec<Vec<f64>>,
    degrees_of_freedom: f64,
    stretch: Stretch,
    (iterations, condition): (usize, f64),
) -> Estimate {
    let parameter = |(i, (quantity, value)): (usize, &(Quantity, f64))| {
        let error = covariance[i][i].max(0.0).sqrt();
        Parameter::new(*quantity, *value, error, degrees_of_freedom)
    };
    Estimate {
        parameters: found.iter().enumerate().map(parameter).collect(),
        covariance,
        stretches: vec![stretch],
        iterations,
        condition,
    }
}
