//! The complex Schur form, on which logarithms and Gramians stand.

use faer::{Mat, MatRef};

use crate::Complex64;
use crate::error::LtiError;
use crate::matrix::complex;

/// `A = Z T Zᴴ` with unitary `Z` and upper triangular `T`.
pub(crate) struct Schur {
    pub(crate) t: Mat<Complex64>,
    pub(crate) z: Mat<Complex64>,
}

/// Steps of the QR iteration that one eigenvalue may take.
const MAX_STEPS: usize = 60;

impl Schur {
    /// By Householder reduction and QR steps with Wilkinson's shift.
    ///
    /// # Source
    /// Golub, G. H. and Van Loan, C. F. (2013), *Matrix Computations*, 4th ed., §7.4–7.5, in complex arithmetic.
    pub(crate) fn new(a: MatRef<'_, f64>) -> Result<Self, LtiError> {
        let n = a.nrows();
        let mut schur = Self { t: complex(a), z: Mat::identity(n, n) };
        schur.reduce();
        let (mut last, mut steps) = (n.saturating_sub(1), 0);
        while last > 0 {
            let first = schur.start_of_block(last);
            if first == last {
                (last, steps) = (last - 1, 0);
                continue;
            }
            if steps == MAX_STEPS {
                return Err(LtiError::NoConvergence);
            }
            steps += 1;
            let shift = if steps % 10 == 0 {
                // A cycle is broken by a shift that has nothing to do with it.
                schur.t[(last, last)] + 0.75 * schur.t[(last, last - 1)].norm()
            } else {
                schur.wilkinson(last)
            };
            schur.step(first, last, shift);
        }
        for j in 0..n {
            for i in j + 1..n {
                schur.t[(i, j)] = Complex64::ZERO;
            }
        }
        Ok(schur)
    }

    /// To upper Hessenberg form.
    fn reduce(&mut self) {
        let n = self.t.nrows();
        for k in 0..n.saturating_sub(2) {
            let mut v: Vec<Complex64> = (k + 1..n).map(|i| self.t[(i, k)]).collect();
            let Some(factor) = householder(&mut v) else { continue };
            for j in 0..n {
                let sum: Complex64 = v.iter().enumerate().map(|(i, v)| v.conj() * self.t[(k + 1 + i, j)]).sum();
                v.iter().enumerate().for_each(|(i, v)| self.t[(k + 1 + i, j)] -= factor * sum * v);
            }
            for m in [&mut self.t, &mut self.z] {
                for i in 0..n {
                    let sum: Complex64 = v.iter().enumerate().map(|(j, v)| m[(i, k + 1 + j)] * v).sum();
                    v.iter().enumerate().for_each(|(j, v)| m[(i, k + 1 + j)] -= factor * sum * v.conj());
                }
            }
        }
    }

    /// Where the block that ends at `last` begins; what separates it from the one before is set to zero.
    fn start_of_block(&mut self, last: usize) -> usize {
        for k in (1..=last).rev() {
            let size = self.t[(k - 1, k - 1)].norm() + self.t[(k, k)].norm();
            if self.t[(k, k - 1)].norm() <= f64::EPSILON * size {
                self.t[(k, k - 1)] = Complex64::ZERO;
                return k;
            }
        }
        0
    }

    /// The eigenvalue of the last two rows and columns that is nearer to the last element.
    fn wilkinson(&self, last: usize) -> Complex64 {
        let at = |i: usize, j: usize| self.t[(last + i - 1, last + j - 1)];
        let half = 0.5 * (at(0, 0) - at(1, 1));
        let product = at(0, 1) * at(1, 0);
        let root = (half * half + product).sqrt();
        let (plus, minus) = (half + root, half - root);
        let larger = if plus.norm() >= minus.norm() { plus } else { minus };
        if larger == Complex64::ZERO { at(1, 1) } else { at(1, 1) - product / larger }
    }

    /// One QR step with a shift on the rows and columns `first..=last`.
    fn step(&mut self, first: usize, last: usize, shift: Complex64) {
        let n = self.t.nrows();
        (first..=last).for_each(|k| self.t[(k, k)] -= shift);
        let mut rotations = Vec::with_capacity(last - first);
        for k in first..last {
            let (a, b) = (self.t[(k, k)], self.t[(k + 1, k)]);
            let length = a.norm().hypot(b.norm());
            let (c, s) = if length == 0.0 { (Complex64::ONE, Complex64::ZERO) } else { (a / length, b / length) };
            for j in k..n {
                let (upper, lower) = (self.t[(k, j)], self.t[(k + 1, j)]);
                self.t[(k, j)] = c.conj() * upper + s.conj() * lower;
                self.t[(k + 1, j)] = c * lower - s * upper;
            }
            rotations.push((c, s));
        }
        for (k, (c, s)) in (first..last).zip(rotations) {
            for (m, rows) in [(&mut self.t, k + 2), (&mut self.z, n)] {
                for i in 0..rows {
                    let (left, right) = (m[(i, k)], m[(i, k + 1)]);
                    m[(i, k)] = c * left + s * right;
                    m[(i, k + 1)] = c.conj() * right - s.conj() * left;
                }
            }
        }
        (first..=last).for_each(|k| self.t[(k, k)] += shift);
    }
}

/// Turns a column into the vector of the reflection that leaves its first element alone, and returns `2/vᴴv`; `None`
/// for a column without a direction.
pub(crate) fn householder(v: &mut [Complex64]) -> Option<f64> {
    let length = v.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt();
    let first = v.first()?;
    if length == 0.0 {
        return None;
    }
    let phase = if first.norm() == 0.0 { Complex64::ONE } else { first / first.norm() };
    v[0] += phase * length;
    Some(2.0 / v.iter().map(Complex64::norm_sqr).sum::<f64>())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use faer::Mat;
    use proptest::prelude::*;

    use super::Schur;
    use crate::Complex64;
    use crate::matrix::complex;

    fn residuals(a: &Mat<f64>) -> (f64, f64) {
        let Schur { t, z } = Schur::new(a.as_ref()).unwrap();
        let difference = |p: Mat<Complex64>, q: Mat<Complex64>| (p - q).norm_l2();
        let back = difference(&z * &t * z.adjoint(), complex(a.as_ref()));
        (back / a.norm_l2().max(1e-300), difference(z.adjoint() * &z, Mat::identity(a.nrows(), a.nrows())))
    }

    proptest! {
        #[test]
        fn prop_schur_form_is_the_matrix(n in 1_usize..13, values in prop::collection::vec(-1.0_f64..1.0, 144), grading in 0.0_f64..4.0) {
            let a = Mat::from_fn(n, n, |i, j| values[12 * i + j] * 10_f64.powf(grading * (i as f64 - j as f64)));
            let (back, unitary) = residuals(&a);
            prop_assert!(back < 1e-13 && unitary < 1e-13, "{back:e} {unitary:e}");
        }
    }

    #[test]
    fn exact_schur_form_of_defective_and_cyclic_matrices() {
        let jordan = Mat::from_fn(6, 6, |i, j| if i == j { 0.9 } else { f64::from(u8::from(j == i + 1)) });
        let cycle = Mat::from_fn(6, 6, |i, j| f64::from(u8::from((i + 1) % 6 == j)));
        for a in [jordan.transpose().to_owned(), jordan, cycle, Mat::zeros(3, 3), Mat::full(5, 5, 1.0)] {
            let (back, unitary) = residuals(&a);
            assert!(back < 1e-14 && unitary < 1e-14, "{back:e} {unitary:e}");
        }
    }
}
