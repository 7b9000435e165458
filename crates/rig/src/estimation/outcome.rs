//! From an estimator's error to an outcome without a result.

use super::EstimateError;
use crate::results::{Told, Untold};

impl From<&EstimateError> for Untold {
    fn from(error: &EstimateError) -> Self {
        match error {
            EstimateError::MissingSignal { role, .. } => Untold::Missing { role: *role },
            EstimateError::WrongSign { role, .. } => Untold::WrongSign { role: *role },
            EstimateError::WeakExcitation { .. } => Untold::NotExcited,
            error => Untold::Failed { reason: error.to_string() },
        }
    }
}

impl<T> From<Result<T, EstimateError>> for Told<T> {
    fn from(outcome: Result<T, EstimateError>) -> Self {
        outcome.map_or_else(|error| Told::Untold(Untold::from(&error)), Told::Found)
    }
}
