//! Why a model has no such form.

use ident::IdentError;
use lti::LtiError;

/// Why a model cannot be converted.
#[derive(Debug, thiserror::Error)]
pub enum ConvertError {
    /// The model has no such form, or no such clock.
    #[error(transparent)]
    Model(#[from] IdentError),
    /// A state space with delayed inputs cannot hold it.
    #[error("the delays from one input differ from output to output")]
    DelaysDiffer,
    /// There is nothing to convert.
    #[error("the model is white noise alone")]
    WhiteNoise,
}

impl From<LtiError> for ConvertError {
    fn from(error: LtiError) -> Self {
        ConvertError::Model(error.into())
    }
}
