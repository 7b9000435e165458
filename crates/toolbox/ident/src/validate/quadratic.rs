//! Quadratic forms with the inverse of a covariance of many sums that may be singular.

use faer::Mat;
use numerics::linalg;
use numerics::vector::dot;

use super::JointTest;
use crate::IdentError;
use crate::dense::covariance_root::inverse_root;
use fitting::triangle::upper_factor;

/// Directions with less than this part of the largest variance count as not moving.
pub(super) const STILL: f64 = 1e-8;
/// Directions of which an estimate leaves less than this part of the variance count as held: there, terms that the
/// linearisation leaves out are no longer small against what is left.
pub(super) const HELD: f64 = 0.03;
/// So many sums are taken apart into directions in good time.
const SEPARABLE: usize = 500;
/// Directions of a correction below this part of the largest are nothing but rounding.
const ROUNDING: f64 = 1e-8;

/// The covariance T of sums at neighbouring lags.
#[derive(Debug, Clone)]
pub(super) enum Covariance {
    /// One for each sum.
    Identity,
    /// Written out.
    Dense(Mat<f64>),
    /// `scale(i) · covariance(|i − j|) · scale(j)`; a scale of zero where there is no sum.
    Toeplitz { covariances: Vec<f64>, scales: Vec<f64> },
}

impl Covariance {
    /// That of the sums `first…` alone.
    fn block(&self, first: usize, count: usize) -> Covariance {
        match self {
            Covariance::Identity => Covariance::Identity,
            Covariance::Dense(t) => Covariance::Dense(t.submatrix(first, first, count, count).to_owned()),
            Covariance::Toeplitz { covariances, scales } => Covariance::Toeplitz {
                covariances: covariances[..count.max(1)].to_vec(),
                scales: scales[first..first + count].to_vec(),
            },
        }
    }

    fn variance(&self, i: usize) -> f64 {
        match self {
            Covariance::Identity => 1.0,
            Covariance::Dense(t) => t[(i, i)],
            Covariance::Toeplitz { covariances, scales } => scales[i].powi(2) * covariances[0],
        }
    }

    /// `S` with `SᵀTS = I` applied to columns, and the degrees of freedom that are left.
    fn whiten(&self, columns: &Mat<f64>) -> Result<(Mat<f64>, f64), IdentError> {
        match self {
            Covariance::Identity => Ok((columns.clone(), columns.nrows() as f64)),
            Covariance::Dense(t) => along_directions(t, columns),
            Covariance::Toeplitz { covariances, scales } => {
                let kept: Vec<usize> = (0..scales.len()).filter(|i| scales[*i] > 0.0).collect();
                let scaled = Mat::from_fn(kept.len(), columns.ncols(), |i, j| columns[(kept[i], j)] / scales[kept[i]]);
                if kept.windows(2).all(|pair| pair[1] == pair[0] + 1) {
                    return whiten_toeplitz(covariances, &scaled);
                }
                let among = |i: usize, j: usize| covariances[kept[i].abs_diff(kept[j])];
                along_directions(&Mat::from_fn(kept.len(), kept.len(), among), &scaled)
            }
        }
    }
}

/// Sums whose covariance is `T + C − Z Bᵀ − B Zᵀ + B K Bᵀ + J Jᵀ`: what an estimate took out, and what its errors add.
#[derive(Debug, Clone)]
pub(super) struct Sums {
    pub(super) values: Vec<f64>,
    pub(super) covariance: Covariance,
    /// `C`: what is taken out otherwise than along `B`, if anything.
    pub(super) change: Option<Mat<f64>>,
    /// Sums × directions taken out.
    pub(super) z: Mat<f64>,
    pub(super) b: Mat<f64>,
    pub(super) k: Mat<f64>,
    /// Sums × uncertain directions.
    pub(super) j: Mat<f64>,
}

impl Sums {
    /// The variance of each sum; never below what rounding leaves of its parts.
    pub(super) fn variances(&self) -> Vec<f64> {
        let correction = &self.b * &self.k;
        let variance = |i: usize| {
            let taken = dots(&self.z, &self.b, i);
            let whole = self.covariance.variance(i);
            let change = self.change.as_ref().map_or(0.0, |change| change[(i, i)]);
            (whole + change - 2.0 * taken + dots(&correction, &self.b, i) + dots(&self.j, &self.j, i))
                .max(STILL * whole)
        };
        (0..self.values.len()).map(variance).collect()
    }

    /// The test of the sums `first…` over the directions in which they move at all.
    pub(super) fn test(&self, first: usize, count: usize) -> Result<JointTest, IdentError> {
        let (r, d) = (self.b.ncols(), self.j.ncols());
        let columns = Mat::from_fn(count, 1 + 2 * r + d, |i, c| match c {
            0 => self.values[first + i],
            c if c <= r => self.z[(first + i, c - 1)],
            c if c <= 2 * r => self.b[(first + i, c - 1 - r)],
            c => self.j[(first + i, c - 1 - 2 * r)],
        });
        let block = self.covariance.block(first, count);
        let (white, freedom) = block.whiten(&columns)?;
        let part = |from: usize, count: usize| white.subcols(from, count);
        let (s, z, b, j) = (part(0, 1), part(1, r), part(1 + r, r), part(1 + 2 * r, d));
        let basis = match &self.change {
            // All directions may change.
            Some(_) => Mat::identity(white.nrows(), white.nrows()),
            None => basis(&white.subcols(1, 2 * r + d).to_owned())?,
        };
        let (zq, bq, jq) = (basis.transpose() * z, basis.transpose() * b, basis.transpose() * j);
        let taken = &zq * bq.transpose();
        let n = basis.ncols();
        let mut inner = Mat::<f64>::identity(n, n) - &taken - taken.transpose()
            + &bq * &self.k * bq.transpose()
            + &jq * jq.transpose();
        if let Some(change) = &self.change {
            let half = block.whiten(&change.submatrix(first, first, count, count).to_owned())?.0;
            inner += block.whiten(&half.transpose().to_owned())?.0;
        }
        let along = basis.transpose() * s;
        let outside = (s - &basis * &along).squared_norm_l2();
        let (inside, kept) = over_eigenvectors(&inner, &along)?;
        // Rounding, and a floor under the variances, may leave less than nothing.
        let freedom = (freedom - (n - kept) as f64).max(0.0);
        Ok(JointTest::chi_squared(if freedom < 0.5 { 0.0 } else { outside + inside }, freedom))
    }
}

/// `Σ_k a(i, k) b(i, k)`.
fn dots(a: &Mat<f64>, b: &Mat<f64>, i: usize) -> f64 {
    (0..a.ncols()).map(|k| a[(i, k)] * b[(i, k)]).sum()
}

/// An orthonormal basis of the columns.
fn basis(columns: &Mat<f64>) -> Result<Mat<f64>, IdentError> {
    if columns.ncols() == 0 || columns.nrows() == 0 {
        return Ok(Mat::zeros(columns.nrows(), 0));
    }
    let norms: Vec<f64> = (0..columns.ncols()).map(|k| columns.col(k).norm_l2()).collect();
    let moving: Vec<usize> = (0..columns.ncols()).filter(|k| norms[*k] > 0.0).collect();
    if moving.is_empty() {
        return Ok(Mat::zeros(columns.nrows(), 0));
    }
    let scaled = Mat::from_fn(columns.nrows(), moving.len(), |i, k| columns[(i, moving[k])] / norms[moving[k]]);
    // By way of the triangular factor: the columns are few and may be very long.
    let factor = upper_factor(scaled.clone());
    let svd = linalg::thin_svd(factor.as_ref())?;
    let values = &svd.values;
    let rank = values.iter().filter(|value| **value > ROUNDING * values[0]).count();
    let turn = Mat::from_fn(moving.len(), rank, |i, k| svd.v[(i, k)] / values[k]);
    Ok(scaled * turn)
}

/// `aᵀ C⁻¹ a` over the eigenvectors of C that are not held, and their number.
fn over_eigenvectors(c: &Mat<f64>, a: &Mat<f64>) -> Result<(f64, usize), IdentError> {
    if c.nrows() == 0 {
        return Ok((0.0, 0));
    }
    let eigen = linalg::symmetric_eigen(c.as_ref())?;
    let along = eigen.vectors.transpose() * a;
    let values = &eigen.values;
    let kept: Vec<usize> = (0..c.nrows()).filter(|k| values[*k] > HELD).collect();
    Ok((kept.iter().map(|k| along[(*k, 0)].powi(2) / values[*k]).sum(), kept.len()))
}

/// Columns whitened by a Toeplitz covariance.
///
/// Where it is singular and the sums are many, δ is added to the variance λ of each direction, 1e-8 of the largest
/// there can be: a direction then counts as `λ/(λ + δ)` of a degree of freedom, which is what it adds to a form on
/// average.
fn whiten_toeplitz(covariances: &[f64], columns: &Mat<f64>) -> Result<(Mat<f64>, f64), IdentError> {
    let m = columns.nrows();
    let largest = covariances[0] + 2.0 * covariances.iter().take(m).skip(1).map(|v| v.abs()).sum::<f64>();
    let least = STILL * largest;
    match by_recursion(covariances, columns, 0.0) {
        Some((white, trace)) if trace * least < 1.0 => return Ok((white, m as f64)),
        _ => {}
    }
    if m > SEPARABLE
        && let Some((white, trace)) = by_recursion(covariances, columns, least)
    {
        return Ok((white, m as f64 - least * trace));
    }
    along_directions(&Mat::from_fn(m, m, |i, j| covariances[i.abs_diff(j)]), columns)
}

/// Columns whitened by `Q = P + floor·I`, and the trace of `Q⁻¹`, which bounds the reciprocal of the smallest
/// eigenvalue: each sum is predicted from those before it, and the errors are taken in units of their deviations. The
/// trace is `Σ (1 + φᵀφ)/v` for the predictors φ and variances v. `None` where Q is not positive.
///
/// # Source
/// Brockwell & Davis, *Time Series: Theory and Methods*, 2nd ed., 1991, proposition 5.2.1 (Durbin and Levinson).
fn by_recursion(covariances: &[f64], columns: &Mat<f64>, floor: f64) -> Option<(Mat<f64>, f64)> {
    work::checkpoint();
    let m = columns.nrows();
    let (mut variance, mut trace) = (covariances[0] + floor, 0.0);
    let mut white = Mat::zeros(m, columns.ncols());
    // The oldest sum's coefficient first.
    let (mut predictor, mut longer) = (Vec::with_capacity(m), Vec::with_capacity(m));
    for k in work::checked(0..m) {
        if k > 0 {
            let reflection = (covariances[k] - dot(&predictor, &covariances[1..k])) / variance;
            longer.clear();
            longer.push(reflection);
            longer.extend(predictor.iter().zip(predictor.iter().rev()).map(|(x, y)| x - reflection * y));
            std::mem::swap(&mut predictor, &mut longer);
            variance *= 1.0 - reflection * reflection;
        }
        if variance.is_nan() || variance <= 0.0 {
            return None;
        }
        trace += (1.0 + dot(&predictor, &predictor)) / variance;
        for j in 0..columns.ncols() {
            let column = columns.col_as_slice(j);
            white[(k, j)] = (column[k] - dot(&predictor, &column[..k])) / variance.sqrt();
        }
    }
    let finite = (0..columns.ncols()).all(|j| white.col_as_slice(j).iter().all(|v: &f64| v.is_finite()));
    (finite && trace.is_finite()).then_some((white, trace))
}

/// Columns along the directions that move, in units of their deviations.
fn along_directions(t: &Mat<f64>, columns: &Mat<f64>) -> Result<(Mat<f64>, f64), IdentError> {
    let root = inverse_root(t, STILL)?;
    Ok((root.transpose() * columns, root.ncols() as f64))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn column(values: &[f64]) -> Mat<f64> {
        Mat::from_fn(values.len(), 1, |i, _| values[i])
    }

    fn toeplitz(covariances: &[f64]) -> Mat<f64> {
        Mat::from_fn(covariances.len(), covariances.len(), |i, j| covariances[i.abs_diff(j)])
    }

    #[test]
    fn prop_recursion_and_directions_agree() {
        let mut random = signal::excitation::Random::new(3);
        for pole in [0.0, 0.6, -0.8, 0.95] {
            for m in [1, 2, 40, 150] {
                let covariances: Vec<f64> = (0..m).map(|l| 7.0 * f64::powi(pole, l)).collect();
                let sums = column(&(0..m).map(|_| random.normal()).collect::<Vec<_>>());
                let fast = by_recursion(&covariances, &sums, 0.0).unwrap().0.squared_norm_l2();
                let (slow, freedom) = along_directions(&toeplitz(&covariances), &sums).unwrap();
                assert_eq!(freedom, f64::from(m));
                assert!((fast / slow.squared_norm_l2() - 1.0).abs() < 1e-10, "{pole} {m}");
            }
        }
    }

    /// Two lines: four directions whatever the number of lags.
    #[test]
    fn prop_directions_that_stand_still_are_left_out() {
        for m in [60, 800] {
            let line = |t: i32, phase: f64| (0.5 * f64::from(t) + phase).cos() + (1.3 * f64::from(t)).cos();
            let covariances: Vec<f64> = (0..m).map(|l| line(l, 0.0)).collect();
            let sums = column(&(0..m).map(|t| line(t, 0.2)).collect::<Vec<_>>());
            let (slow, directions) = along_directions(&toeplitz(&covariances), &sums).unwrap();
            let (white, freedom) = whiten_toeplitz(&covariances, &sums).unwrap();
            assert_eq!(directions, 4.0);
            assert!((freedom - 4.0).abs() < 1e-3, "{freedom}");
            assert!((white.squared_norm_l2() / slow.squared_norm_l2() - 1.0).abs() < 1e-3);
        }
    }

    /// A projection takes directions out, uncertain ones count for less: both as the covariance written out has it.
    #[test]
    fn exact_corrected_form_is_that_of_the_covariance_written_out() {
        let mut random = signal::excitation::Random::new(5);
        let mut normal = |rows: usize, columns: usize| Mat::from_fn(rows, columns, |_, _| random.normal());
        let (rows, m) = (60, 8);
        let u = normal(rows, m);
        let q = linalg::Qr::new(normal(rows, 3).as_ref()).thin_q();
        // The first lag lies within what is taken out.
        let all = Mat::from_fn(rows, 4, |i, j| if j < 3 { q[(i, j)] } else { u[(i, 0)] });
        let q = linalg::Qr::new(all.as_ref()).thin_q();
        let w = &u - &q * (q.transpose() * &u);
        let (j, values) = (normal(m, 1), normal(m, 1));
        let b = u.transpose() * &q;
        let sums = Sums {
            values: (0..m).map(|i| values[(i, 0)]).collect(),
            covariance: Covariance::Dense(u.transpose() * &u),
            change: None,
            z: b.clone(),
            b,
            k: Mat::identity(4, 4),
            j: faer::Scale(0.1) * &j,
        };
        let written = w.transpose() * &w + faer::Scale(0.01) * (&j * j.transpose());
        for (i, variance) in sums.variances().iter().enumerate() {
            assert!((variance - written[(i, i)]).abs() < 1e-9 * (1.0 + written[(i, i)]), "{i}");
        }
        let test = sums.test(1, 7).unwrap();
        let part = written.submatrix(1, 1, 7, 7);
        let inverse = linalg::inverse(part.as_ref());
        let form = values.subrows(1, 7).transpose() * inverse * values.subrows(1, 7);
        assert_eq!(test.degrees_of_freedom, 7.0);
        assert!((test.statistic / form[(0, 0)] - 1.0).abs() < 1e-9, "{} {}", test.statistic, form[(0, 0)]);
        let otherwise = Sums {
            change: Some(w.transpose() * &w - u.transpose() * &u),
            z: Mat::zeros(m, 0),
            b: Mat::zeros(m, 0),
            k: Mat::zeros(0, 0),
            ..sums.clone()
        };
        assert!((otherwise.test(1, 7).unwrap().statistic / test.statistic - 1.0).abs() < 1e-9);
        for sums in [sums, otherwise] {
            let without = Sums { j: Mat::zeros(m, 0), ..sums };
            assert_eq!(without.test(0, 8).unwrap().degrees_of_freedom, 7.0);
        }
    }
}
