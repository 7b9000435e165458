//! A minimum and what surely leads to it.

use fitting::nonlinear::Lowest;

/// The cost near a minimum is that of the linearised errors to this fraction of what it has risen.
const ALIKE: f64 = 0.1;
/// Rises up to this fraction of the cost are looked at.
const NEAR: f64 = 0.01;
/// Rises below this fraction of the cost are none.
const EQUAL: f64 = 1e-6;

/// A minimum and the parabola around it.
pub(super) struct QuadraticRegion<'a>(pub(super) &'a Lowest);

impl QuadraticRegion<'_> {
    /// Returns true if θ with this cost lies where the minimum's parabola holds, so that a search from there would end
    /// in it.
    pub(super) fn holds(&self, theta: &[f64], cost: f64) -> bool {
        let Lowest { parameters, factor, cost: least, termination, .. } = self.0;
        if !termination.converged() {
            return false;
        }
        let step: Vec<f64> = theta.iter().zip(parameters).map(|(v, p)| v - p).collect();
        let along = |i: usize| (i..step.len()).map(|j| factor[(i, j)] * step[j]).sum::<f64>();
        let expected: f64 = (0..step.len()).map(|i| along(i).powi(2)).sum();
        expected <= NEAR * least && (cost - least - expected).abs() <= ALIKE * expected + EQUAL * least
    }
}
