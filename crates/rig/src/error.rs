//! Why a part of the bench cannot be estimated.

use serde::Serializer;

use crate::role::Role;

/// Why a part of the bench cannot be estimated from a recording.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EstimateError {
    /// A signal the estimate needs was not recorded.
    #[error("{file}: the estimate needs {} ({})", .role.symbol(), .role.key())]
    MissingSignal {
        /// File.
        file: String,
        /// Role.
        role: Role,
    },
    /// The recording is too short.
    #[error("{file}: {duration_s:.3} s are too short, {needed_s} s are needed")]
    TooShort {
        /// File.
        file: String,
        /// Length, s.
        duration_s: f64,
        /// Needed, s.
        needed_s: f64,
    },
    /// A signal does not vary enough.
    #[error("{file}: {} hardly varies, so nothing can be learnt from it", .role.symbol())]
    WeakExcitation {
        /// File.
        file: String,
        /// Role.
        role: Role,
        /// Standard deviation in SI.
        standard_deviation: f64,
    },
    /// Too much of the recording is at a limit.
    #[error("{file}: {} rests at its limit for {:.0} % of the time", .role.symbol(), 100.0 * .share)]
    Saturated {
        /// File.
        file: String,
        /// Role.
        role: Role,
        /// Share of the samples, 0…1.
        share: f64,
    },
    /// A torque brakes with a negative sign, against what it does to the speed.
    #[error("{file}: {} brakes with a negative sign, against what it does to the speed", .role.symbol())]
    WrongSign {
        /// File.
        file: String,
        /// Role.
        role: Role,
    },
    /// Numbers do not allow an estimate.
    #[error("{file}: {source}")]
    Ident {
        /// File.
        file: String,
        /// The estimator's reason.
        source: ident::IdentError,
    },
    /// A signal cannot be processed.
    #[error("{file}: {source}")]
    Signal {
        /// File.
        file: String,
        /// The reason.
        source: signal::SignalError,
    },
}

impl EstimateError {
    /// The recording it is about.
    #[must_use]
    pub fn file(&self) -> &str {
        match self {
            EstimateError::MissingSignal { file, .. }
            | EstimateError::TooShort { file, .. }
            | EstimateError::WeakExcitation { file, .. }
            | EstimateError::Saturated { file, .. }
            | EstimateError::WrongSign { file, .. }
            | EstimateError::Ident { file, .. }
            | EstimateError::Signal { file, .. } => file,
        }
    }
}

/// Serialises an error as its words.
///
/// # Errors
/// Those of the serialiser.
pub fn write_words<S: Serializer>(error: &EstimateError, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(error)
}
