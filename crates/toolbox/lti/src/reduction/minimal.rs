//! Minimal realisation.

use faer::{Mat, MatRef, concat};
use numerics::linalg;

use crate::error::LtiError;
use crate::matrix::balance;
use crate::state_space::StateSpace;

impl StateSpace {
    /// The system without the states that the inputs do not move or the outputs do not show, stable or not.
    ///
    /// `tolerance` is the share of `A` (and of `B` or `C` for the first step) below which a coupling counts as none;
    /// 1e-10 suits exact models. Made in orthogonal steps.
    ///
    /// # Errors
    /// [`LtiError::NoConvergence`].
    ///
    /// # Example
    /// ```
    /// // (s + 1) / ((s + 1)(s − 2))
    /// let hidden = lti::TransferFunction::continuous(vec![1.0, 1.0], vec![1.0, -1.0, -2.0])?.to_state_space()?;
    /// let seen = hidden.minimal(1e-10)?;
    /// assert!(seen.states() == 1 && (seen.poles()?[0].re - 2.0).abs() < 1e-12);
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    ///
    /// # Source
    /// Rosenbrock, H. H. (1970), *State-space and Multivariable Theory*: the staircase form.
    pub fn minimal(&self, tolerance: f64) -> Result<Self, LtiError> {
        let n = self.states();
        let (a, scale) = balance(self.a());
        let b = Mat::from_fn(n, self.inputs(), |i, j| self.b()[(i, j)] / scale[i]);
        let c = Mat::from_fn(self.outputs(), n, |i, j| self.c()[(i, j)] * scale[j]);
        let q = reached(a.as_ref(), b.as_ref(), tolerance)?;
        let (a, b, c) = (q.transpose() * a * &q, q.transpose() * b, c * &q);
        let q = reached(a.transpose(), c.transpose(), tolerance)?;
        Self::new(q.transpose() * a * &q, q.transpose() * b, c * &q, self.d().to_owned(), self.sample_time_s())
    }
}

/// An orthonormal basis of the states that `B`, `A B`, `A² B` … span.
fn reached(a: MatRef<'_, f64>, b: MatRef<'_, f64>, tolerance: f64) -> Result<Mat<f64>, LtiError> {
    let n = a.nrows();
    let mut basis: Mat<f64> = Mat::zeros(n, 0);
    let mut newest = directions(b.to_owned(), tolerance * b.norm_l2())?;
    while newest.ncols() > 0 && basis.ncols() < n {
        let next = a * &newest;
        basis = concat![[basis, newest]];
        newest = directions(orthogonal(&basis, orthogonal(&basis, next)), tolerance * a.norm_l2())?;
    }
    let found = basis.ncols().min(n);
    Ok(basis.subcols(0, found).to_owned())
}

/// Part of `m` that is orthogonal to a basis; taken twice it is orthogonal to working precision.
fn orthogonal(basis: &Mat<f64>, m: Mat<f64>) -> Mat<f64> {
    let along = basis.transpose() * &m;
    m - basis * along
}

/// The left singular vectors of singular values above a limit.
fn directions(m: Mat<f64>, limit: f64) -> Result<Mat<f64>, LtiError> {
    if m.nrows() == 0 || m.ncols() == 0 {
        return Ok(Mat::zeros(m.nrows(), 0));
    }
    let svd = linalg::thin_svd(m.as_ref())?;
    let rank = svd.values.iter().take_while(|value| **value > limit).count();
    Ok(svd.u.subcols(0, rank).to_owned())
}
