//! Weightings of the projection.

/// How past and future are weighted before the states are read off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weighting {
    /// The oblique projection as it is.
    N4sid,
    /// Future inputs projected out (PO-MOESP).
    Moesp,
    /// Future inputs projected out and future outputs made white: canonical variates. Where correlations beyond the order
    /// are one, as of data without noise, they rank nothing, and the states are those of [`Weighting::N4sid`].
    #[default]
    Cva,
}
