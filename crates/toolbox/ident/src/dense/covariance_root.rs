//! Square roots of covariances that may be singular.

use faer::Mat;
use numerics::linalg;

use crate::IdentError;

/// The correlation matrix of `p`, its eigenvectors and eigenvalues, and the deviations taken off.
struct Correlation {
    deviations: Vec<f64>,
    vectors: Mat<f64>,
    values: Vec<f64>,
}

impl Correlation {
    fn new(p: &Mat<f64>) -> Result<Self, IdentError> {
        let n = p.nrows();
        let at = |i: usize, j: usize| 0.5 * (p[(i, j)] + p[(j, i)]);
        if let Some(index) = (0..n).find(|i| (0..n).any(|j| !at(*i, j).is_finite())) {
            return Err(IdentError::NotFinite { what: "a covariance", index });
        }
        let deviations: Vec<f64> = (0..n).map(|i| at(i, i).max(0.0).sqrt()).collect();
        let unit = |i: usize| if deviations[i] > 0.0 { deviations[i].recip() } else { 0.0 };
        let scaled = Mat::from_fn(n, n, |i, j| unit(i) * at(i, j) * unit(j));
        let eigen = linalg::symmetric_eigen(scaled.as_ref())?;
        Ok(Correlation { vectors: eigen.vectors, values: eigen.values, deviations })
    }

    /// The directions with more than this part of the largest variance.
    fn directions(&self, tolerance: f64) -> Vec<usize> {
        let largest = self.values.last().copied().unwrap_or(0.0);
        (0..self.values.len()).filter(|k| self.values[*k] > tolerance * largest && self.values[*k] > 0.0).collect()
    }
}

/// `S` with `S Sᵀ = P`, one column for each direction in which P is not zero. Negative variances, which rounding
/// leaves, count as zero; the scale of each parameter is taken off first, so that units do not decide what is small.
pub(crate) fn root(p: &Mat<f64>) -> Result<Mat<f64>, IdentError> {
    root_above(p, 0.0)
}

fn root_above(p: &Mat<f64>, tolerance: f64) -> Result<Mat<f64>, IdentError> {
    if p.nrows() == 0 {
        return Ok(Mat::zeros(0, 0));
    }
    let c = Correlation::new(p)?;
    let kept = c.directions(tolerance);
    Ok(Mat::from_fn(p.nrows(), kept.len(), |i, k| c.deviations[i] * c.vectors[(i, kept[k])] * c.values[kept[k]].sqrt()))
}

/// As [`root`], without the directions that are there by rounding alone: eigenvalues of a matrix of order n have errors
/// of n units in the last place of the largest.
pub(crate) fn root_beyond_rounding(p: &Mat<f64>) -> Result<Mat<f64>, IdentError> {
    root_above(p, p.nrows() as f64 * f64::EPSILON)
}

/// `W` with `Wᵀ P W = I`, one column for each direction whose part of the largest variance exceeds `tolerance`.
pub(crate) fn inverse_root(p: &Mat<f64>, tolerance: f64) -> Result<Mat<f64>, IdentError> {
    if p.nrows() == 0 {
        return Ok(Mat::zeros(0, 0));
    }
    let c = Correlation::new(p)?;
    let kept = c.directions(tolerance);
    let unit = |i: usize| if c.deviations[i] > 0.0 { c.deviations[i].recip() } else { 0.0 };
    Ok(Mat::from_fn(p.nrows(), kept.len(), |i, k| unit(i) * c.vectors[(i, kept[k])] / c.values[kept[k]].sqrt()))
}
