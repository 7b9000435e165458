//! Whether a document describes a bench that can be.

use rig::engine_pulses::EnginePulses;

use super::described::DescribedParameter;
use super::error::DocumentError;
use crate::model::{BenchModel, Bound, ModelParameter, ModelUncertainty};

/// Refuses numbers that no bench can have, and contradictions.
pub(super) fn all(
    model: &BenchModel,
    listed: &[DescribedParameter],
    uncertainty: &ModelUncertainty,
) -> Result<(), DocumentError> {
    parameters(model)?;
    constants(model)?;
    described(model, listed)?;
    uncertain(model, uncertainty)
}

/// Refuses pulses that no engine can have.
pub(super) fn pulses(pulses: Option<&EnginePulses>) -> Result<(), DocumentError> {
    pulses.map_or(Ok(()), EnginePulses::check).map_err(|impossible| DocumentError::Pulses { impossible })
}

fn parameters(model: &BenchModel) -> Result<(), DocumentError> {
    let impossible = |parameter: ModelParameter| {
        let (bound, field) = (parameter.bound(), parameter.field());
        let value = model.value(parameter).filter(|value| !bound.allows(*value))?;
        Some(DocumentError::Impossible { field, value, limit: bound.words() })
    };
    ModelParameter::ALL.into_iter().find_map(impossible).map_or(Ok(()), Err)
}

/// The numbers that are no estimates.
fn constants(model: &BenchModel) -> Result<(), DocumentError> {
    let pi = model.speed_controller;
    let numbers = [
        ("encoder_gate_s", Some(model.encoder_gate_s), Bound::NotNegative),
        ("torque_limit_nm", model.torque_limit_nm, Bound::Positive),
        ("speed_controller.sample_time_s", pi.map(|pi| pi.sample_time_s), Bound::Positive),
        ("speed_controller.demand_delay_s", pi.map(|pi| pi.demand_delay_s), Bound::Finite),
        ("feed_forward.delay_s", model.feed_forward.map(|feed| feed.delay_s), Bound::Finite),
    ];
    for (field, value, bound) in numbers {
        if let Some(value) = value.filter(|value| !bound.allows(*value)) {
            return Err(DocumentError::Impossible { field, value, limit: bound.words() });
        }
    }
    Ok(())
}

/// What people read and what programs read must be the same.
fn described(model: &BenchModel, listed: &[DescribedParameter]) -> Result<(), DocumentError> {
    for one in listed {
        let modelled = model.value(one.parameter);
        if modelled != Some(one.value) {
            let (parameter, listed) = (one.parameter, one.value);
            return Err(DocumentError::Contradiction { parameter, listed, modelled });
        }
    }
    Ok(())
}

fn uncertain(model: &BenchModel, uncertainty: &ModelUncertainty) -> Result<(), DocumentError> {
    let mut seen = Vec::new();
    for parameter in uncertainty.parameters() {
        let is_twice = seen.contains(&parameter);
        if is_twice || model.value(parameter).is_none() {
            return Err(DocumentError::Uncertainty { parameter, is_twice });
        }
        seen.push(parameter);
    }
    Ok(())
}
