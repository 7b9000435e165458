//! [`Kernel`]: what is expected of an impulse response before it is measured.

use faer::Mat;

use fitting::triangle::upper_factor;

/// Prior covariance of an impulse response `g(1), g(2), …` (counted from its delay on): smooth and decaying, to a
/// degree that the data decide.
///
/// # Source
/// Chen, Ohlsson & Ljung, *On the estimation of transfer functions, regularizations and Gaussian processes –
/// revisited*, 2012; Pillonetto & De Nicolao, *A new kernel-based approach for linear system identification*, 2010.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kernel {
    /// Tuned and correlated: `c λ^max(i,j)`. Continuous, decaying; a good first choice.
    TunedCorrelated,
    /// Diagonal and correlated: `c λ^((i+j)/2) ρ^|i−j|`. The correlation is tuned on its own.
    DiagonalCorrelated,
    /// Stable spline of second order: `c (λ^(i+j+max(i,j))/2 − λ^(3 max(i,j))/6)`. Smooth responses.
    StableSpline,
    /// Diagonal: `c λ^i`. Decaying, no smoothness.
    Diagonal,
}

/// The numbers that a kernel is tuned by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hyperparameters {
    /// `c`, the scale of the covariance, in squared units of the response.
    pub scale: f64,
    /// `λ`, the decay a sample, between 0 and 1.
    pub decay: f64,
    /// `ρ`, the correlation of neighbours, between −1 and 1; only of [`Kernel::DiagonalCorrelated`].
    pub correlation: f64,
}

impl Kernel {
    /// `L` with `L Lᵀ` the covariance of `n` coefficients, built from how the process is generated: no matrix is
    /// decomposed, so it is exact however fast the response decays.
    pub(super) fn root(self, n: usize, h: &Hyperparameters) -> Mat<f64> {
        let gain = h.scale.sqrt();
        let power = |exponent: f64| h.decay.powf(exponent);
        match self {
            Kernel::TunedCorrelated => {
                // Brownian motion in the time λ^i: independent steps from the last coefficient backwards.
                let last = |k: usize| if k + 1 == n { 1.0 } else { 1.0 - h.decay };
                let step: Vec<f64> = (0..n).map(|k| gain * (power(k as f64 + 1.0) * last(k)).sqrt()).collect();
                Mat::from_fn(n, n, |i, k| if k >= i { step[k] } else { 0.0 })
            }
            Kernel::DiagonalCorrelated => {
                let fresh = (1.0 - h.correlation * h.correlation).max(0.0).sqrt();
                let envelope: Vec<f64> = (0..n).map(|i| gain * power((i as f64 + 1.0) / 2.0)).collect();
                let correlation = |i: usize, k: usize| h.correlation.powi((i - k) as i32);
                let entry = |i: usize, k: usize| correlation(i, k) * if k == 0 { 1.0 } else { fresh };
                Mat::from_fn(n, n, |i, k| if k <= i { envelope[i] * entry(i, k) } else { 0.0 })
            }
            Kernel::StableSpline => spline_root(n, h.decay, gain),
            Kernel::Diagonal => {
                Mat::from_fn(n, n, |i, k| if i == k { gain * power((i as f64 + 1.0) / 2.0) } else { 0.0 })
            }
        }
    }

    /// How many numbers it is tuned by.
    pub(super) fn hyperparameters(self) -> usize {
        if self == Kernel::DiagonalCorrelated { 3 } else { 2 }
    }
}

/// Integrated Brownian motion in the time `λ^i`, from the last coefficient backwards.
fn spline_root(n: usize, decay: f64, gain: f64) -> Mat<f64> {
    let mut rows = Mat::<f64>::zeros(2 * n, n);
    let (mut slope, mut value) = (vec![0.0; 2 * n], vec![0.0; 2 * n]);
    for i in (0..n).rev() {
        let time = decay.powf(i as f64 + 1.0);
        let step = if i + 1 == n { time } else { time * (1.0 - decay) };
        let root = step.sqrt();
        value.iter_mut().zip(&slope).for_each(|(v, s)| *v += step * s);
        value[2 * i] += step * root / 2.0;
        value[2 * i + 1] += step * root / 12_f64.sqrt();
        slope[2 * i] += root;
        (0..2 * n).for_each(|k| rows[(k, i)] = gain * value[k]);
    }
    upper_factor(rows).transpose().to_owned()
}
