//! Factors of Gramians.

use faer::{Mat, MatRef};

use crate::Complex64;
use crate::error::LtiError;
use crate::matrix::{balance, complex};
use crate::schur::{Schur, householder};

/// `F` with `F Fᵀ = P` of `A P + P Aᵀ + B Bᵀ = 0`, or `A P Aᵀ − P + B Bᵀ = 0` where `discrete`; n × 2n.
///
/// Hammarling's recursion on the complex Schur form: the last row of the triangular factor first, by which `B` shrinks
/// to that of a problem with one row less. `P` itself, whose small parts would drown, is not formed.
pub(super) fn factor(a: MatRef<'_, f64>, b: MatRef<'_, f64>, discrete: bool) -> Result<Mat<f64>, LtiError> {
    let n = a.nrows();
    let (balanced, scale) = balance(a);
    let Schur { t, z } = Schur::new(balanced.as_ref())?;
    check_stable(&t, discrete)?;
    let scaled = Mat::from_fn(n, b.ncols(), |i, j| b[(i, j)] / scale[i]);
    let mut rows = z.adjoint() * complex(scaled.as_ref());
    let mut u: Mat<Complex64> = Mat::zeros(n, n);
    for k in (0..n).rev() {
        let last: Vec<Complex64> = (0..b.ncols()).map(|j| rows[(k, j)]).collect();
        let size = last.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt();
        if size == 0.0 {
            continue;
        }
        let step = Step { t: &t, k, last: &last, tau: size / decay(t[(k, k)], discrete).sqrt() };
        u[(k, k)] = Complex64::from(step.tau);
        let column = if discrete { step.discrete(&mut rows) } else { step.continuous(&mut rows) };
        column.into_iter().enumerate().for_each(|(i, value)| u[(i, k)] = value);
    }
    let whole = z * u;
    Ok(Mat::from_fn(n, 2 * n, |i, j| scale[i] * if j < n { whole[(i, j)].re } else { whole[(i, j - n)].im }))
}

/// How fast the square of a mode dies out: `−2 Re s`, or `1 − |z|²`.
fn decay(pole: Complex64, discrete: bool) -> f64 {
    if discrete { (1.0 - pole.norm()) * (1.0 + pole.norm()) } else { -2.0 * pole.re }
}

fn check_stable(t: &Mat<Complex64>, discrete: bool) -> Result<(), LtiError> {
    let poles = (0..t.nrows()).map(|i| t[(i, i)]);
    let worst = poles.min_by(|p, q| decay(*p, discrete).total_cmp(&decay(*q, discrete)));
    match worst {
        Some(pole) if decay(pole, discrete) <= 0.0 => Err(LtiError::Unstable { re: pole.re, im: pole.im }),
        _ => Ok(()),
    }
}

/// One row of the recursion.
struct Step<'a> {
    t: &'a Mat<Complex64>,
    k: usize,
    /// The last row of `B`.
    last: &'a [Complex64],
    /// The factor's diagonal element.
    tau: f64,
}

impl Step<'_> {
    /// `B₁ y` with `y` the last row of `B`, conjugate, over `τ`.
    fn seen(&self, rows: &Mat<Complex64>, i: usize) -> Complex64 {
        self.last.iter().enumerate().map(|(j, b)| rows[(i, j)] * b.conj()).sum::<Complex64>() / self.tau
    }

    /// `(A₁ + ᾱ I) u = −(B₁ y + a τ)`, then `B₁ − u yᴴ`.
    fn continuous(&self, rows: &mut Mat<Complex64>) -> Vec<Complex64> {
        let (t, k) = (self.t, self.k);
        let alpha = t[(k, k)].conj();
        let mut u: Vec<Complex64> = (0..k).map(|i| -(self.seen(rows, i) + t[(i, k)] * self.tau)).collect();
        for i in (0..k).rev() {
            let above: Complex64 = (i + 1..k).map(|j| t[(i, j)] * u[j]).sum();
            u[i] = (u[i] - above) / (t[(i, i)] + alpha);
        }
        for (i, u) in u.iter().enumerate() {
            for (j, b) in self.last.iter().enumerate() {
                rows[(i, j)] -= u * b / self.tau;
            }
        }
        u
    }

    /// `(I − ᾱ A₁) u = ᾱ a τ + B₁ y`; with `v = A₁ u + a τ` the rows `[v B₁]` lose their part `u` along `w = [ᾱ; y]`,
    /// which has length one, and one column by a reflection.
    fn discrete(&self, rows: &mut Mat<Complex64>) -> Vec<Complex64> {
        let (t, k) = (self.t, self.k);
        let alpha = t[(k, k)].conj();
        let mut u: Vec<Complex64> = (0..k).map(|i| self.seen(rows, i) + alpha * t[(i, k)] * self.tau).collect();
        for i in (0..k).rev() {
            let above: Complex64 = (i + 1..k).map(|j| alpha * t[(i, j)] * u[j]).sum();
            u[i] = (u[i] + above) / (1.0 - alpha * t[(i, i)]);
        }
        let mut w: Vec<Complex64> =
            std::iter::once(alpha).chain(self.last.iter().map(|b| b.conj() / self.tau)).collect();
        let Some(factor) = householder(&mut w) else { return u };
        for i in 0..k {
            let v = (i..k).map(|j| t[(i, j)] * u[j]).sum::<Complex64>() + t[(i, k)] * self.tau;
            let along: Complex64 = v * w[0] + (1..w.len()).map(|j| rows[(i, j - 1)] * w[j]).sum::<Complex64>();
            (1..w.len()).for_each(|j| rows[(i, j - 1)] -= factor * along * w[j].conj());
        }
        u
    }
}
