//! Poles or zeros that a model's ways share.

use ident::uncertainty::UncertainRoot;

/// Poles or zeros of some of a model's ways from input to output.
pub(super) struct Roots {
    pub(super) model: usize,
    pub(super) is_pole: bool,
    /// The ways that have them; empty where all do.
    pub(super) channels: Vec<String>,
    pub(super) roots: Vec<UncertainRoot>,
}
