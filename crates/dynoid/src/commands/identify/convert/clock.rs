//! From one clock to another.

use std::f64::consts::TAU;

use lti::{Discretisation, LtiError, StateSpace, TransferFunction};

use crate::cli::identify::{ModelConvertArguments, Sampling};

pub(super) fn rule(arguments: &ModelConvertArguments) -> Discretisation {
    match arguments.method {
        Sampling::Zoh => Discretisation::ZeroOrderHold,
        Sampling::Foh => Discretisation::FirstOrderHold,
        Sampling::Tustin => Discretisation::Tustin { prewarp_rad_s: arguments.prewarp_hz.map(|hz| TAU * hz) },
        Sampling::Impulse => Discretisation::ImpulseInvariant,
        Sampling::Matched => Discretisation::Matched,
    }
}

pub(super) fn resampled(system: StateSpace, arguments: &ModelConvertArguments) -> Result<StateSpace, LtiError> {
    let method = rule(arguments);
    match (arguments.sample_time, system.sample_time_s()) {
        (Some(t), None) => system.to_discrete(method, t),
        (Some(t), Some(_)) => system.resampled(method, t),
        (None, Some(_)) if arguments.continuous => system.to_continuous(method),
        (None, _) => Ok(system),
    }
}

pub(super) fn resampled_ratio(
    h: TransferFunction,
    arguments: &ModelConvertArguments,
) -> Result<TransferFunction, LtiError> {
    let method = rule(arguments);
    match (arguments.sample_time, h.sample_time_s()) {
        (Some(t), None) => h.to_discrete(method, t),
        (Some(t), Some(_)) => h.resampled(method, t),
        (None, Some(_)) if arguments.continuous => h.to_continuous(method),
        (None, _) => Ok(h),
    }
}
