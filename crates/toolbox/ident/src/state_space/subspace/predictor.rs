//! States from a predictor that an autoregression with inputs gives: consistent under feedback.

use faer::Mat;
use numerics::linalg;

use super::hankel::{Hankel, HankelFactor};
use super::realise::{ROUNDING, Realised, beside, columns, gather, stable_shift, whiten};
use crate::IdentError;
use crate::dense::spectral_radius;

/// Canonical variates of the past and of the future without what later inputs and outputs contribute.
///
/// With `Ã = A − K C` the future is `y(t+f) = C Ãᶠ x(t) + Σ_{i ≤ f} C Ãⁱ⁻¹ [B K] [u y](t+f−i) + e(t+f)`. The
/// coefficients of the sum are those of a long autoregression with inputs; what is left when it is taken off depends on
/// the past and on later noise only, whatever makes the inputs.
///
/// # Source
/// Jansson, *Subspace identification and ARX modeling*, 13th IFAC SYSID, 2003.
pub(super) struct PredictorStates<'a> {
    hankel: &'a Hankel<'a>,
    factor: &'a HankelFactor,
    /// Matrix that turns the past into the states, most correlated first.
    states: Mat<f64>,
    correlations: Vec<f64>,
    feedthrough: bool,
}

impl<'a> PredictorStates<'a> {
    pub(super) fn new(hankel: &'a Hankel<'a>, factor: &'a HankelFactor, feedthrough: bool) -> Result<Self, IdentError> {
        let (past, q) = (hankel.horizons.past, hankel.channels());
        let known = gather(factor, &columns(hankel, 0..past, 0..q));
        let (white, _) = whiten(known.as_ref())?;
        let (future, _) = whiten(corrected_future(hankel, factor, feedthrough)?.as_ref())?;
        let svd = linalg::thin_svd((white.transpose() * future).as_ref())?;
        let variates = white * svd.u;
        let states = linalg::least_norm(known.as_ref(), variates.as_ref(), ROUNDING)?;
        Ok(PredictorStates { hankel, factor, states, correlations: svd.values, feedthrough })
    }

    pub(super) fn correlations(&self) -> &[f64] {
        &self.correlations
    }

    /// The model of so many states, in scaled channels.
    pub(super) fn realise(&self, order: usize, stable: bool, noise_model: bool) -> Result<Realised, IdentError> {
        let found = self.correlations.iter().filter(|c| **c > ROUNDING).count();
        if found < order {
            return Err(IdentError::RankDeficient { rank: found, parameters: order, condition: f64::INFINITY });
        }
        let Regressed { mut a, c, joint } = self.regress(&self.states.subcols(0, order).to_owned())?;
        if stable && spectral_radius(a.as_ref())? >= 1.0 {
            let gamma = observability(&a, &c, self.hankel.horizons.future);
            a = stable_shift(gamma.as_ref(), self.hankel.outputs)?;
        }
        Ok(Realised::new(a, c, &joint, noise_model))
    }

    /// `C` by outputs on states; `A` and `K` by next states on states, inputs and the errors of the outputs. With the
    /// errors known, an input may follow the output of the same instant.
    fn regress(&self, states: &Mat<f64>) -> Result<Regressed, IdentError> {
        let (hankel, factor) = (self.hankel, self.factor);
        let (m, q, past, n) = (hankel.inputs, hankel.channels(), hankel.horizons.past, states.ncols());
        let now = gather(factor, &columns(hankel, 0..past, 0..q)) * states;
        let next = gather(factor, &columns(hankel, 1..past + 1, 0..q)) * states;
        let inputs = gather(factor, &columns(hankel, past..past + 1, 0..m));
        let outputs = gather(factor, &columns(hankel, past..past + 1, m..q));
        let seen = if self.feedthrough { beside(&now, &inputs) } else { now.clone() };
        let to_outputs = linalg::least_norm(seen.as_ref(), outputs.as_ref(), ROUNDING)?;
        let errors = outputs - seen * &to_outputs;
        let all = beside(&beside(&now, &inputs), &errors);
        let to_next = linalg::least_norm(all.as_ref(), next.as_ref(), ROUNDING)?;
        let own = beside(&now, &inputs) * to_next.subrows(0, n + m);
        // What is left of the next state without the errors' part: K e and what no regressor explains.
        let left = beside(&(next - own), &errors);
        Ok(Regressed {
            a: to_next.subrows(0, n).transpose().to_owned(),
            c: to_outputs.subrows(0, n).transpose().to_owned(),
            joint: left.transpose() * &left * faer::Scale(1.0 / factor.windows as f64),
        })
    }
}

/// Matrices of the states, and the covariance `[Q S; Sᵀ R]` of what is left of next states and outputs.
struct Regressed {
    a: Mat<f64>,
    c: Mat<f64>,
    joint: Mat<f64>,
}

/// The future outputs less what later inputs and outputs contribute by an autoregression over the past.
fn corrected_future(hankel: &Hankel<'_>, factor: &HankelFactor, feedthrough: bool) -> Result<Mat<f64>, IdentError> {
    let (m, q, p) = (hankel.inputs, hankel.channels(), hankel.outputs);
    let (past, future) = (hankel.horizons.past, hankel.horizons.future);
    let mut regressors = columns(hankel, 0..past, 0..q);
    if feedthrough {
        regressors.extend(columns(hankel, past..past + 1, 0..m));
    }
    let target = gather(factor, &columns(hankel, past..past + 1, m..q));
    let coefficients = linalg::least_norm(gather(factor, &regressors).as_ref(), target.as_ref(), ROUNDING)?;
    let mut corrected = gather(factor, &columns(hankel, past..past + future, m..q));
    for ahead in 0..future {
        let mut rest = corrected.subcols_mut(ahead * p, p);
        for lag in 1..=ahead.min(past) {
            let block = past + ahead - lag;
            let later = gather(factor, &columns(hankel, block..block + 1, 0..q));
            rest -= later * coefficients.subrows((past - lag) * q, q);
        }
        if feedthrough {
            let now = gather(factor, &columns(hankel, past + ahead..past + ahead + 1, 0..m));
            rest -= now * coefficients.subrows(past * q, m);
        }
    }
    Ok(corrected)
}

/// `C, C A, C A² …`, so many blocks.
fn observability(a: &Mat<f64>, c: &Mat<f64>, blocks: usize) -> Mat<f64> {
    let (p, n) = (c.nrows(), a.nrows());
    let mut all = Mat::zeros(blocks * p, n);
    let mut row = c.clone();
    for block in 0..blocks {
        all.subrows_mut(block * p, p).copy_from(&row);
        row = &row * a;
    }
    all
}
