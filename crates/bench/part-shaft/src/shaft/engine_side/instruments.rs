//! Effect of the demand on the engine's side, as an orthonormal basis on which errors are projected.

use faer::Mat;
use ident::IdentError;
use numerics::linalg;
use signal::Complex64;

use super::equation::{Control, UNKNOWNS, laplace};
use crate::shaft::places;
use crate::shaft::spectra::Spectra;

/// The holds of the instruments, in half firing intervals.
const HOLDS: [f64; 3] = [0.0, 1.0, 2.0];
/// s²v, and s v and v after each hold.
const COUNT: usize = 1 + 2 * HOLDS.len();
/// Singular values below it, of the largest, are of instruments that are combinations of others.
const NEGLIGIBLE: f64 = 1e-9;
/// J_d behind a flange, which is in no equation.
const ANY_INERTIA_KG_M2: f64 = 0.5;
/// The least J_e that instruments are made with, of J_d.
const SMALLEST: f64 = 1e-3;

/// J_d for the instruments.
pub(super) fn dyno_inertia(theta: &[f64]) -> f64 {
    let inertia = theta[places::INERTIA];
    if inertia > 0.0 { inertia } else { ANY_INERTIA_KG_M2 }
}

pub(super) struct Instruments {
    /// 1/√S at every bin.
    weights: Vec<f64>,
    /// Real and imaginary part of every bin, one under the other; columns orthonormal.
    basis: Mat<f64>,
}

impl Instruments {
    /// From the demand's spectrum, the shaft's parameters with a guess of J_e, and the spectrum of s T_e.
    ///
    /// # Errors
    /// A demand that moves nothing.
    pub(super) fn new(
        spectra: &Spectra,
        excitation: &[Complex64],
        theta: &[f64],
        engine_kg_m2: f64,
        spectrum: &[f64],
        half_firing_s: f64,
    ) -> Result<Self, IdentError> {
        let dyno = dyno_inertia(theta);
        let engine = engine_kg_m2.abs().max(SMALLEST * dyno);
        let weights: Vec<f64> = spectrum.iter().map(|power| 1.0 / power.sqrt()).collect();
        let mut columns = Mat::zeros(2 * spectra.bins.len(), COUNT);
        for (row, ((bin, u), weight)) in spectra.bins.iter().zip(excitation).zip(&weights).enumerate() {
            let s = laplace(spectra, *bin);
            let spring = theta[places::K] + theta[places::B] * s;
            let speed = -spring / (s * (dyno * engine * s * s + (dyno + engine) * spring)) * *u * *weight;
            let held = HOLDS.iter().map(|hold| Control::Held.response(s, hold * half_firing_s).0);
            let of_control = held.flat_map(|late| [s * speed * late, speed * late]);
            for (column, z) in std::iter::once(s * s * speed).chain(of_control).enumerate() {
                (columns[(2 * row, column)], columns[(2 * row + 1, column)]) = (z.re, z.im);
            }
        }
        Ok(Instruments { weights, basis: orthonormal(columns)? })
    }

    /// Errors and slopes over √S, projected: a column, and a column for each unknown.
    pub(super) fn project(
        &self,
        errors: impl Iterator<Item = (Complex64, [Complex64; UNKNOWNS])>,
    ) -> (Mat<f64>, Mat<f64>) {
        let mut weighted = Mat::zeros(self.basis.nrows(), 1 + UNKNOWNS);
        for (row, ((error, slopes), weight)) in errors.zip(&self.weights).enumerate() {
            for (column, z) in std::iter::once(error).chain(slopes).enumerate() {
                (weighted[(2 * row, column)], weighted[(2 * row + 1, column)]) = (z.re * weight, z.im * weight);
            }
        }
        let projected = self.basis.transpose() * &weighted;
        (projected.get(.., ..1).to_owned(), projected.get(.., 1..).to_owned())
    }

    /// Combinations of the instruments, one for each column of `coefficients`, over √S.
    pub(super) fn combined(&self, coefficients: &Mat<f64>) -> Vec<[Complex64; UNKNOWNS]> {
        let columns = &self.basis * coefficients;
        let at = |row: usize, i: usize| Complex64::new(columns[(2 * row, i)], columns[(2 * row + 1, i)]);
        let of_bin = |(row, weight): (usize, &f64)| std::array::from_fn(|i| at(row, i) * *weight);
        self.weights.iter().enumerate().map(of_bin).collect()
    }
}

/// An orthonormal basis of what the columns span.
fn orthonormal(mut columns: Mat<f64>) -> Result<Mat<f64>, IdentError> {
    const SILENT: IdentError = IdentError::Constant { what: "the demand" };
    for mut column in columns.col_iter_mut() {
        let norm = column.norm_l2();
        if !(norm.is_finite() && norm > 0.0) {
            return Err(SILENT);
        }
        column /= faer::Scale(norm);
    }
    let svd = linalg::thin_svd(columns.as_ref()).map_err(|_| SILENT)?;
    let rank = svd.values.iter().take_while(|value| **value > NEGLIGIBLE * svd.values[0]).count();
    if rank < UNKNOWNS { Err(SILENT) } else { Ok(svd.u.get(.., ..rank).to_owned()) }
}

/// The solution of a small system whose rows and columns differ in scale.
pub(super) fn solved(left: &Mat<f64>, right: &Mat<f64>) -> Result<Mat<f64>, IdentError> {
    let n = left.nrows();
    let rows: Vec<f64> = (0..n).map(|i| left.row(i).norm_max()).collect();
    let columns: Vec<f64> =
        (0..n).map(|j| (0..n).map(|i| (left[(i, j)] / rows[i]).abs()).fold(0.0, f64::max)).collect();
    if rows.iter().chain(&columns).any(|s| !s.is_finite() || *s <= 0.0) {
        return Err(IdentError::Constant { what: "the demand" });
    }
    let scaled = Mat::from_fn(n, n, |i, j| left[(i, j)] / (rows[i] * columns[j]));
    let target = Mat::from_fn(n, right.ncols(), |i, j| right[(i, j)] / rows[i]);
    let solution = linalg::FullyPivotedLu::new(scaled.as_ref()).solve(target.as_ref());
    if (0..n).any(|i| !solution[(i, 0)].is_finite()) {
        return Err(IdentError::Constant { what: "the demand" });
    }
    Ok(Mat::from_fn(n, right.ncols(), |i, j| solution[(i, j)] / columns[i]))
}
