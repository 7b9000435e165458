//! Influence of each parameter on the results computed from the model.

use rig::results::Quantity;

use crate::analysis::{Influence, ParameterInfluence};
use crate::model::{BenchModel, ModelParameter, ModelUncertainty};

/// Step of the numerical slopes, in parts of the parameter.
const STEP: f64 = 1e-4;
/// Results that move by less than this many per cent a per cent are not moved by a parameter.
const UNMOVED: f64 = 1e-3;

/// Influence of each parameter on a result; parameters without effect on it are left out.
pub(super) fn influence(
    quantity: Quantity,
    model: &BenchModel,
    uncertainty: &ModelUncertainty,
    result: impl Fn(&BenchModel) -> f64,
) -> Influence {
    let value = result(model);
    let removed = uncertainty.removed_by_knowing(model, &result);
    let of = |parameter: ModelParameter| {
        let at = model.value(parameter).filter(|at| *at != 0.0)?;
        let moved = |by: f64| result(&model.with(parameter, at * (1.0 + by)));
        let elasticity = (moved(STEP) - moved(-STEP)) / (2.0 * STEP * value);
        let known = removed.iter().find(|(which, _)| *which == parameter);
        let share = known.map(|(_, share)| *share);
        (elasticity.abs() > UNMOVED).then_some(ParameterInfluence { parameter, elasticity, variance_share: share })
    };
    Influence { quantity, parameters: ModelParameter::ALL.into_iter().filter_map(of).collect() }
}
