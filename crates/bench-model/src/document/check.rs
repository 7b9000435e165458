//! Whether a document describes a bench that can be.

use super::described::DescribedParameter;
use super::error::DocumentError;
use crate::model::{BenchModel, ModelParameter, ModelUncertainty};

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

fn parameters(model: &BenchModel) -> Result<(), DocumentError> {
    let impossible = |parameter: ModelParameter| {
        let value = model.value(parameter).filter(|value| !parameter.can_be(*value))?;
        Some(DocumentError::Impossible { what: parameter.quantity().name(), value })
    };
    ModelParameter::ALL.into_iter().find_map(impossible).map_or(Ok(()), Err)
}

/// The numbers that are no estimates.
fn constants(model: &BenchModel) -> Result<(), DocumentError> {
    let pi = model.speed_controller;
    let numbers = [
        ("the gate of the encoders", Some(model.encoder_gate_s), Bound::NotNegative),
        ("the torque limit", model.torque_limit_nm, Bound::Positive),
        ("the sample time of the controller", pi.map(|pi| pi.sample_time_s), Bound::Positive),
        ("the delay of N_d* in the speed error", pi.map(|pi| pi.demand_delay_s), Bound::Finite),
        ("the delay of the feed-forward", model.feed_forward.map(|feed| feed.delay_s), Bound::Finite),
    ];
    for (what, value, bound) in numbers {
        if let Some(value) = value.filter(|value| !bound.allows(*value)) {
            return Err(DocumentError::Impossible { what, value });
        }
    }
    Ok(())
}

#[derive(Clone, Copy)]
enum Bound {
    Finite,
    NotNegative,
    Positive,
}

impl Bound {
    fn allows(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Bound::Finite => true,
                Bound::NotNegative => value >= 0.0,
                Bound::Positive => value > 0.0,
            }
    }
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
