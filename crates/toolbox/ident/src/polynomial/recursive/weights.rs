//! How uncertain an estimate is whose samples have weights.

use faer::{Mat, MatRef};

/// `Q = Σ w² ψ ψᵀ` over the samples, of weights `w`.
///
/// Weighted least squares has the errors `P Σ w ψ e` with `P = (Σ w ψ ψᵀ)⁻¹`, hence for white noise of variance σ² the
/// covariance `σ² P Q P`. For `w = λ^age` in steady state that is `σ² P/(1 + λ)`, and `σ² P` would be up to twice too
/// large.
///
/// # Source
/// Ljung 1999, §11.2 (the weighted criterion) and appendix II (the covariance of weighted least squares).
#[derive(Debug, Clone)]
pub(super) struct SquaredWeights {
    sum: Mat<f64>,
}

impl SquaredWeights {
    pub(super) fn new(count: usize) -> Self {
        SquaredWeights { sum: Mat::zeros(count, count) }
    }

    /// Counts prior knowledge of a parameter, of this variance for noise of variance one, as one sample.
    pub(super) fn start_at(&mut self, parameter: usize, variance: f64) {
        self.sum[(parameter, parameter)] = 1.0 / variance;
    }

    /// Weights what was gathered by `forgetting`, and adds the gradient of the leading parameters.
    pub(super) fn push(&mut self, psi: &[f64], forgetting: f64) {
        self.sum *= faer::Scale(forgetting * forgetting);
        for (j, by_j) in psi.iter().enumerate() {
            psi.iter().enumerate().for_each(|(i, by_i)| self.sum[(i, j)] += by_i * by_j);
        }
    }

    /// `P Q P`.
    pub(super) fn sandwich(&self, p: &Mat<f64>) -> Mat<f64> {
        p * &self.sum * p
    }

    /// `tr P Q`.
    pub(super) fn trace_with(&self, p: &Mat<f64>) -> f64 {
        let of = |m: MatRef<'_, f64>| (0..m.nrows()).map(|i| m[(i, i)]).sum();
        of((p * &self.sum).as_ref())
    }
}
