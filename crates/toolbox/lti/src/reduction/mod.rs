//! Fewer states: balanced reduction and minimal realisation.

mod gramian;
mod minimal;

use faer::Mat;
use numerics::linalg;
use serde::{Deserialize, Serialize};

use crate::error::LtiError;
use crate::matrix::{identity, inverse};
use crate::state_space::StateSpace;

/// Treatment of the states that a reduction leaves out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reduction {
    /// They stay zero: right at high frequency.
    Truncation,
    /// They follow the others without lag: right at rest.
    SingularPerturbation,
}

/// Hankel singular values below this share of the largest belong to states that input or output does not reach.
const HIDDEN: f64 = 1e-14;

impl StateSpace {
    /// `P` of `A P + P Aᵀ + B Bᵀ = 0`, or `A P Aᵀ − P + B Bᵀ = 0` for a discrete system: the covariance of the states
    /// under white noise of unit intensity on the inputs.
    ///
    /// # Errors
    /// [`LtiError::Unstable`] unless every pole is stable, [`LtiError::NoConvergence`].
    ///
    /// # Example
    /// ```
    /// let lag = lti::TransferFunction::discrete(vec![1.0], vec![1.0, -0.5], 0.1)?.to_state_space()?;
    /// assert!((lag.controllability_gramian()?[(0, 0)] - 1.0 / (1.0 - 0.25)).abs() < 1e-15);
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    ///
    /// # Source
    /// Hammarling, S. J. (1982), IMA J. Numer. Anal. 2(3), 303–323: the factor of the solution, without the solution.
    pub fn controllability_gramian(&self) -> Result<Mat<f64>, LtiError> {
        let factor = self.controllability_factor()?;
        Ok(&factor * factor.transpose())
    }

    /// `Q` of `Aᵀ Q + Q A + Cᵀ C = 0`, or `Aᵀ Q A − Q + Cᵀ C = 0` for a discrete system: `x₀ᵀ Q x₀` is the energy of
    /// the output that an initial state leaves.
    ///
    /// # Errors
    /// Those of [`StateSpace::controllability_gramian`].
    pub fn observability_gramian(&self) -> Result<Mat<f64>, LtiError> {
        let factor = self.observability_factor()?;
        Ok(&factor * factor.transpose())
    }

    /// The Hankel singular values `√λ(PQ)`, largest first, one a state. Leaving out all after the `r`-th moves the gain
    /// at no frequency by more than twice their sum.
    ///
    /// # Errors
    /// Those of [`StateSpace::controllability_gramian`].
    pub fn hankel_singular_values(&self) -> Result<Vec<f64>, LtiError> {
        Ok(Balancing::new(self)?.values)
    }

    /// The balanced realisation: both Gramians are the diagonal of Hankel singular values. States that input or output
    /// does not reach are dropped.
    ///
    /// # Errors
    /// Those of [`StateSpace::controllability_gramian`].
    ///
    /// # Source
    /// Laub, A. J. et al. (1987), IEEE Trans. Autom. Control 32(2), 115–122: the square-root method.
    pub fn balanced(&self) -> Result<Self, LtiError> {
        Balancing::new(self)?.apply(self)
    }

    /// The system with `order` states, those with the largest Hankel singular values.
    ///
    /// # Errors
    /// Those of [`StateSpace::controllability_gramian`]; [`LtiError::Order`] for more states than there are;
    /// [`LtiError::Singular`] where the left-out states have no rest of their own (singular perturbation).
    ///
    /// # Source
    /// Liu, Y. and Anderson, B. D. O. (1989), Int. J. Control 50(4), 1379–1405.
    pub fn reduced(&self, order: usize, reduction: Reduction) -> Result<Self, LtiError> {
        if order > self.states() {
            return Err(LtiError::Order { order, most: self.states() });
        }
        let balanced = self.balanced()?;
        let n = balanced.states();
        if order >= n {
            return Ok(balanced);
        }
        let rest = n - order;
        let (a, b, c) = (balanced.a(), balanced.b(), balanced.c());
        let (b1, c1) = (b.subrows(0, order), c.subcols(0, order));
        let a11 = a.submatrix(0, 0, order, order);
        if reduction == Reduction::Truncation {
            let d = balanced.d().to_owned();
            return Self::new(a11.to_owned(), b1.to_owned(), c1.to_owned(), d, self.sample_time_s());
        }
        let (a12, a21) = (a.submatrix(0, order, order, rest), a.submatrix(order, 0, rest, order));
        let (a22, b2, c2) = (a.submatrix(order, order, rest, rest), b.subrows(order, rest), c.subcols(order, rest));
        let at_rest = if self.sample_time_s().is_some() { identity(rest) - a22 } else { -a22 };
        let settle = inverse(at_rest.as_ref()).ok_or(LtiError::Singular { what: "A of the states left out" })?;
        let (from_states, from_input) = (&settle * a21, &settle * b2);
        Self::new(
            a11 + a12 * &from_states,
            b1 + a12 * &from_input,
            c1 + c2 * &from_states,
            balanced.d() + c2 * &from_input,
            self.sample_time_s(),
        )
    }

    fn controllability_factor(&self) -> Result<Mat<f64>, LtiError> {
        gramian::factor(self.a(), self.b(), self.sample_time_s().is_some())
    }

    fn observability_factor(&self) -> Result<Mat<f64>, LtiError> {
        gramian::factor(self.a().transpose(), self.c().transpose(), self.sample_time_s().is_some())
    }
}

/// The way to balanced states: `x = T z`, `z = W x` with `W T = I`.
struct Balancing {
    values: Vec<f64>,
    t: Mat<f64>,
    w: Mat<f64>,
}

impl Balancing {
    fn new(system: &StateSpace) -> Result<Self, LtiError> {
        let (n, reach, sight) = (system.states(), system.controllability_factor()?, system.observability_factor()?);
        if n == 0 {
            return Ok(Self { values: Vec::new(), t: Mat::zeros(0, 0), w: Mat::zeros(0, 0) });
        }
        let svd = linalg::svd((sight.transpose() * &reach).as_ref())?;
        let mut values = svd.values;
        values.truncate(n);
        let seen = values.iter().take_while(|v| **v > HIDDEN * values[0]).count();
        let scaled = |m: &Mat<f64>| Mat::from_fn(m.nrows(), seen, |i, j| m[(i, j)] / values[j].sqrt());
        let (t, w) = (reach * scaled(&svd.v), sight * scaled(&svd.u));
        Ok(Self { values, t, w: w.transpose().to_owned() })
    }

    fn apply(&self, system: &StateSpace) -> Result<StateSpace, LtiError> {
        let a = &self.w * system.a() * &self.t;
        StateSpace::new(a, &self.w * system.b(), system.c() * &self.t, system.d().to_owned(), system.sample_time_s())
    }
}
