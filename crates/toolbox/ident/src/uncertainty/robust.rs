//! A covariance that does not rest on white residuals.

use faer::Mat;

use super::STEP;
use crate::dense::covariance_root;
use crate::prediction::{InitialState, residuals};
use crate::{Dataset, Fit, IdentError, LinearModel, Parametric};

impl<M: Parametric + LinearModel> Fit<M> {
    /// The covariance of the parameters when the residuals on `data` (those of the fit) are coloured up to `lags`
    /// samples apart, or change in size: `G⁻¹ M G⁻¹` with `ψ(t)` the sensitivity of the prediction error,
    /// `s(t) = ψ(t) Λ⁻¹ ε(t)`, `G = Σ_t ψ(t) Λ⁻¹ ψ(t)ᵀ` and `M = Σ_{|τ| ≤ lags} (1 − |τ|/(lags + 1)) Σ_t s(t) s(t−τ)ᵀ`.
    ///
    /// An output-error model of a system with coloured noise needs it: its own covariance can be several times too
    /// small. Take several times as many lags as the residuals remember.
    ///
    /// # Errors
    /// Those of [`residuals`]; [`IdentError::Missing`] where an output is missing; [`IdentError::TooFewSamples`].
    ///
    /// # Source
    /// Ljung 1999, (9.42); Newey & West, *A simple, positive semi-definite, heteroskedasticity and autocorrelation
    /// consistent covariance matrix*, 1987.
    pub fn robust_covariance(&self, data: &Dataset, lags: usize) -> Result<Mat<f64>, IdentError> {
        let root = covariance_root::root(&self.covariance)?;
        let whiten = covariance_root::inverse_root(&self.noise_covariance, f64::EPSILON)?;
        let errors = whitened_residuals(&self.model, data, &whiten)?;
        let (rows, directions) = (errors.len(), root.ncols());
        if rows <= directions {
            return Err(IdentError::TooFewSamples { samples: rows, parameters: directions });
        }
        let theta = self.parameters();
        let mut psi = Mat::zeros(rows, directions);
        for k in 0..directions {
            let at = |h: f64| {
                let moved: Vec<f64> = theta.iter().enumerate().map(|(i, v)| v + h * root[(i, k)]).collect();
                whitened_residuals(&self.model.with_parameters(&moved)?, data, &whiten)
            };
            let (above, below) = (at(STEP)?, at(-STEP)?);
            for (slot, (a, b)) in psi.col_as_slice_mut(k).iter_mut().zip(above.iter().zip(&below)) {
                *slot = (a - b) / (2.0 * STEP);
            }
        }
        let scores = scores(&psi, &errors, whiten.ncols());
        let lengths: Vec<usize> = data.experiments().iter().map(crate::Experiment::len).collect();
        // The directions are those in which the parameters are uncorrelated, so that this product is well conditioned.
        let half = covariance_root::inverse_root(&(psi.transpose() * &psi), f64::EPSILON)?;
        let bread = &root * &half * half.transpose();
        Ok(&bread * spread(&scores, &lengths, lags) * bread.transpose())
    }
}

/// The residuals of every experiment, sample by sample, each sample's turned so that their covariance is the identity.
fn whitened_residuals<M: LinearModel>(model: &M, data: &Dataset, whiten: &Mat<f64>) -> Result<Vec<f64>, IdentError> {
    let mut all = Vec::with_capacity(data.samples() * whiten.ncols());
    for e in residuals(model, data, &InitialState::Estimated)?.outputs {
        for t in 0..e.nrows() {
            if (0..e.ncols()).any(|i| e[(t, i)].is_nan()) {
                return Err(IdentError::Missing { what: "an output", index: t });
            }
            all.extend((0..whiten.ncols()).map(|k| (0..e.ncols()).map(|i| whiten[(i, k)] * e[(t, i)]).sum::<f64>()));
        }
    }
    Ok(all)
}

/// `s(t)`, samples × directions.
fn scores(psi: &Mat<f64>, errors: &[f64], outputs: usize) -> Mat<f64> {
    let samples = errors.len() / outputs.max(1);
    Mat::from_fn(samples, psi.ncols(), |t, k| (t * outputs..(t + 1) * outputs).map(|r| psi[(r, k)] * errors[r]).sum())
}

/// `M`, with no product across the border of two experiments.
fn spread(scores: &Mat<f64>, lengths: &[usize], lags: usize) -> Mat<f64> {
    let n = scores.ncols();
    let mut sum = Mat::<f64>::zeros(n, n);
    let mut first = 0;
    for length in lengths {
        for lag in 0..=lags.min(length.saturating_sub(1)) {
            work::checkpoint();
            let weight = 1.0 - lag as f64 / (lags + 1) as f64;
            let now = scores.get(first + lag..first + length, ..);
            let before = scores.get(first..first + length - lag, ..);
            let product = faer::Scale(weight) * (now.transpose() * before);
            sum += &product;
            if lag > 0 {
                sum += product.transpose();
            }
        }
        first += length;
    }
    sum
}
