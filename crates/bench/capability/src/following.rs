//! How the mean torque of an engine follows what is demanded of it.

use numerics::null::nan_if_null;
use numerics::random::Stream;
use rig::bench_parameters::EngineParameters;
use rig::experiment::Demands;
use serde::{Deserialize, Serialize};

/// How engines differ in it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FollowingSpread {
    /// Standard deviation of the gain about 1.
    #[serde(deserialize_with = "nan_if_null")]
    pub gain: f64,
    /// Standard deviation of the offset, over the largest torque that is demanded.
    #[serde(deserialize_with = "nan_if_null")]
    pub offset: f64,
    /// The longest lag beside that of the intake, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub lag_s: f64,
}

impl FollowingSpread {
    /// An engine that gives what is demanded, through its intake.
    pub const NONE: FollowingSpread = FollowingSpread { gain: 0.0, offset: 0.0, lag_s: 0.0 };
    /// Engines of which nobody states more. Their torque is a model's in the control unit: it is right to some per
    /// cent, and an intake fills within 0.1 s (Guzzella and Onder, *Introduction to Modeling and Control of Internal
    /// Combustion Engine Systems*, 2nd ed., ch. 2 and 4).
    pub const ASSUMED: FollowingSpread = FollowingSpread { gain: 0.02, offset: 0.01, lag_s: 0.1 };

    /// An engine that is asked for these torques.
    pub(crate) fn draw(&self, largest_nm: f64, random: &mut Stream) -> Following {
        Following {
            gain: 1.0 + self.gain * random.normal(),
            offset_nm: self.offset * largest_nm * random.normal(),
            lag_s: self.lag_s * random.between(0.0, 1.0),
        }
    }
}

/// One engine: T = g T* + o, through a lag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Following {
    gain: f64,
    offset_nm: f64,
    lag_s: f64,
}

impl Following {
    pub(crate) const EXACT: Following = Following { gain: 1.0, offset_nm: 0.0, lag_s: 0.0 };

    pub(crate) fn given_nm(&self, demanded_nm: f64) -> f64 {
        self.gain * demanded_nm + self.offset_nm
    }

    /// The engine with what its torque lags beside the intake.
    pub(crate) fn slower(&self, engine: &EngineParameters) -> EngineParameters {
        EngineParameters { intake_lag_s: engine.intake_lag_s + self.lag_s, ..engine.clone() }
    }

    /// The demands that an exact engine would follow so; throttles are no torques.
    pub(crate) fn demands(&self, demands: &Demands) -> Demands {
        let engine_torque_nm = demands.engine_torque_nm.iter().map(|torque_nm| self.given_nm(*torque_nm)).collect();
        Demands { engine_torque_nm, ..demands.clone() }
    }
}
