//! Why a parameter of a virtual bench is impossible.

/// A parameter has a value that no bench can have.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("virtual bench: {name} = {value} is impossible; it must be {requirement}")]
pub struct ParameterError {
    /// The field, as a path in [`BenchParameters`](super::BenchParameters).
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Condition that the value must meet.
    pub requirement: &'static str,
}

/// Fails unless `value` is finite and `holds`.
///
/// # Errors
///
/// [`ParameterError`] with the name, the value and the requirement.
pub fn require(name: &'static str, value: f64, holds: bool, requirement: &'static str) -> Result<(), ParameterError> {
    if value.is_finite() && holds { Ok(()) } else { Err(ParameterError { name, value, requirement }) }
}

/// Fails unless `value` is finite and above zero.
pub(crate) fn require_positive(name: &'static str, value: f64) -> Result<(), ParameterError> {
    require(name, value, value > 0.0, "finite and above zero")
}

/// Fails unless `value` is finite and not negative.
pub(crate) fn require_not_negative(name: &'static str, value: f64) -> Result<(), ParameterError> {
    require(name, value, value >= 0.0, "finite and not negative")
}
