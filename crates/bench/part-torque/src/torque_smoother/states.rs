//! The levels of the smoother's noises, and where each stands.

/// Where the logarithms stand; each line's after that of the damping.
pub(crate) const WANDERING: usize = 0;

pub(crate) const TORQUE: usize = 1;

pub(crate) const DAMPING: usize = 2;

/// The levels as the smoother takes them.
#[derive(Debug, Clone)]
pub struct Levels {
    pub(crate) logarithms: Vec<f64>,
    pub(crate) scale: f64,
    pub(super) converged: bool,
}
