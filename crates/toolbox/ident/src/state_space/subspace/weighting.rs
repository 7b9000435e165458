//! Weightings of the projection.

/// How past and future are weighted before the states are read off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weighting {
    /// [`Weighting::Cva`], and [`Weighting::Ssarx`] where the residuals of that show feedback.
    #[default]
    Automatic,
    /// The oblique projection as it is.
    N4sid,
    /// Future inputs projected out (PO-MOESP).
    Moesp,
    /// Future inputs projected out and future outputs made white: canonical variates. Where correlations beyond the
    /// order are one, as of data without noise, they rank nothing, and the states are those of [`Weighting::N4sid`].
    Cva,
    /// Future outputs less what future inputs and outputs contribute by an autoregression with inputs, then canonical
    /// variates (SSARX): the only one that holds under feedback, as future inputs are not taken for independent of the
    /// noise.
    ///
    /// # Source
    /// Jansson, *Subspace identification and ARX modeling*, 13th IFAC SYSID, 2003; Chiuso & Picci, *Consistency
    /// analysis of some closed-loop subspace identification methods*, Automatica 41, 2005.
    Ssarx,
}
