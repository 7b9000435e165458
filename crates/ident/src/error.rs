//! Why an estimate cannot be made.

/// Why an estimate cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentError {
    /// Two things that belong together differ in length.
    #[error("{what}: {found} values where {expected} are needed")]
    Length {
        /// What was measured.
        what: &'static str,
        /// Values expected.
        expected: usize,
        /// Values found.
        found: usize,
    },
    /// Fewer data than parameters.
    #[error("{samples} samples cannot determine {parameters} parameters")]
    TooFewSamples {
        /// Samples given.
        samples: usize,
        /// Parameters wanted.
        parameters: usize,
    },
    /// A value is NaN or infinite.
    #[error("{what} holds a value that is not finite at index {index}")]
    NotFinite {
        /// Where it was found.
        what: &'static str,
        /// Index of the first such value.
        index: usize,
    },
    /// The data do not determine every parameter.
    #[error("the data determine only {rank} of {parameters} parameters (condition number {condition:.1e})")]
    RankDeficient {
        /// Numerical rank.
        rank: usize,
        /// Parameters wanted.
        parameters: usize,
        /// Condition number of the scaled regressor.
        condition: f64,
    },
    /// A signal that has to vary is constant.
    #[error("{what} does not vary, so nothing can be learnt from it")]
    Constant {
        /// The signal.
        what: &'static str,
    },
    /// A starting value or bound is unusable.
    #[error("parameter {index}: start {start} is outside its bounds {lower} to {upper}")]
    StartOutsideBounds {
        /// Parameter.
        index: usize,
        /// Starting value.
        start: f64,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// The decomposition of a matrix failed.
    #[error("a {what} decomposition failed")]
    Decomposition {
        /// Which one.
        what: &'static str,
    },
}
