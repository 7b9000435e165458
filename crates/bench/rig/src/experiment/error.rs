//! Why a plan cannot be.

/// A value of a plan that no experiment can have.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("experiment: {name} = {value} is impossible; it must be {requirement}")]
pub struct PlanError {
    /// The field, as a path in [`ExperimentPlan`](super::ExperimentPlan).
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Condition that the value must meet.
    pub requirement: &'static str,
}

/// Fails unless `value` is finite and `holds`.
pub(super) fn require(name: &'static str, value: f64, holds: bool, requirement: &'static str) -> Result<(), PlanError> {
    if value.is_finite() && holds { Ok(()) } else { Err(PlanError { name, value, requirement }) }
}

/// Fails unless `value` is finite and above zero.
pub(super) fn require_positive(name: &'static str, value: f64) -> Result<(), PlanError> {
    require(name, value, value > 0.0, "finite and above zero")
}

/// Fails unless `value` is finite and not negative.
pub(super) fn require_not_negative(name: &'static str, value: f64) -> Result<(), PlanError> {
    require(name, value, value >= 0.0, "finite and not negative")
}
