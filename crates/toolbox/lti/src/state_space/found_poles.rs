//! Poles that are computed once: with hundreds of states they take longer than all else that is asked of a system.

use std::sync::{Arc, OnceLock};

use faer::MatRef;

use crate::Complex64;
use crate::error::LtiError;
use crate::matrix::eigenvalues;

/// The poles of a system, from when they were first asked for. Copies of a system have its state matrix, and share
/// them. They follow from the matrices, so that systems are equal whether they are known or not.
#[derive(Debug, Clone, Default)]
pub(super) struct FoundPoles(Arc<OnceLock<Vec<Complex64>>>);

impl PartialEq for FoundPoles {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl FoundPoles {
    /// The eigenvalues of this state matrix.
    pub(super) fn of(&self, a: MatRef<'_, f64>) -> Result<Vec<Complex64>, LtiError> {
        if let Some(found) = self.0.get() {
            return Ok(found.clone());
        }
        let found = eigenvalues(a)?;
        Ok(self.0.get_or_init(|| found).clone())
    }
}
