//! Systems in series, in parallel and in loops.

use faer::Mat;

use super::StateSpace;
use crate::error::{LtiError, check_shape};
use crate::matrix::{blocks, identity, inverse, norm_1};

impl StateSpace {
    /// This system followed by `next`: `y = next(self(u))`. The states are this one's, then `next`'s.
    ///
    /// # Errors
    /// [`LtiError::Shape`] where `next` does not take as many inputs as this one has outputs,
    /// [`LtiError::SampleTimesDiffer`].
    pub fn series(&self, next: &Self) -> Result<Self, LtiError> {
        self.check_same_clock(next)?;
        check_shape("second system's D", (next.outputs(), self.outputs()), next.d.shape())?;
        let zero = Mat::zeros(self.states(), next.states());
        let (coupling, through) = (&next.b * &self.c, &next.d * &self.c);
        Self::new(
            blocks([[self.a(), zero.as_ref()], [coupling.as_ref(), next.a()]]),
            blocks([[self.b()], [(&next.b * &self.d).as_ref()]]),
            blocks([[through.as_ref(), next.c()]]),
            &next.d * &self.d,
            self.sample_time_s,
        )
    }

    /// This system beside `other`, outputs added: `y = self(u) + other(u)`. The states are this one's, then `other`'s.
    ///
    /// # Errors
    /// [`LtiError::Shape`] where the numbers of channels differ, [`LtiError::SampleTimesDiffer`].
    pub fn parallel(&self, other: &Self) -> Result<Self, LtiError> {
        self.check_same_clock(other)?;
        check_shape("second system's D", self.d.shape(), other.d.shape())?;
        let upper = Mat::zeros(self.states(), other.states());
        Self::new(
            blocks([[self.a(), upper.as_ref()], [upper.transpose(), other.a()]]),
            blocks([[self.b()], [other.b()]]),
            blocks([[self.c(), other.c()]]),
            &self.d + &other.d,
            self.sample_time_s,
        )
    }

    /// The loop closed through `back` with a negative sign: `y = self(u − back(y))`. The states are this one's, then
    /// `back`'s.
    ///
    /// # Errors
    /// [`LtiError::AlgebraicLoop`] where `I + D_back D` is singular, [`LtiError::Shape`],
    /// [`LtiError::SampleTimesDiffer`].
    ///
    /// # Example
    /// ```
    /// use faer::mat;
    /// let integrator = lti::StateSpace::continuous(mat![[0.0]], mat![[1.0]], mat![[1.0]], mat![[0.0]])?;
    /// let gain = lti::StateSpace::gain(mat![[4.0]], None)?;
    /// assert!((integrator.feedback(&gain)?.poles()?[0].re + 4.0).abs() < 1e-12);
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    pub fn feedback(&self, back: &Self) -> Result<Self, LtiError> {
        self.check_same_clock(back)?;
        check_shape("feedback system's D", (self.inputs(), self.outputs()), back.d.shape())?;
        let through = &back.d * &self.d;
        let loop_gain = identity(self.inputs()) + &through;
        let e = inverse(loop_gain.as_ref()).ok_or(LtiError::AlgebraicLoop)?;
        if is_algebraic_loop(1.0 / norm_1(e.as_ref()), 1.0 + norm_1(through.as_ref())) {
            return Err(LtiError::AlgebraicLoop);
        }
        // The forward system's input is E u − e1 x₁ − e2 x₂.
        let (e1, e2) = (&e * &back.d * &self.c, &e * &back.c);
        let y1 = &self.c - &self.d * &e1;
        let y2 = -(&self.d * &e2);
        let d = &self.d * &e;
        let a11 = &self.a - &self.b * &e1;
        let a12 = -(&self.b * &e2);
        let a21 = &back.b * &y1;
        let a22 = &back.a + &back.b * &y2;
        Self::new(
            blocks([[a11.as_ref(), a12.as_ref()], [a21.as_ref(), a22.as_ref()]]),
            blocks([[(&self.b * &e).as_ref()], [(&back.b * &d).as_ref()]]),
            blocks([[y1.as_ref(), y2.as_ref()]]),
            d,
            self.sample_time_s,
        )
    }

    /// A system without states, `y = D u`.
    ///
    /// # Errors
    /// [`LtiError::NonFinite`], [`LtiError::SampleTime`].
    pub fn gain(d: Mat<f64>, sample_time_s: Option<f64>) -> Result<Self, LtiError> {
        let (outputs, inputs) = d.shape();
        Self::new(Mat::zeros(0, 0), Mat::zeros(0, inputs), Mat::zeros(outputs, 0), d, sample_time_s)
    }

    fn check_same_clock(&self, other: &Self) -> Result<(), LtiError> {
        check_same_clock(self.sample_time_s, other.sample_time_s)
    }
}

/// Returns true if the value `left` of `1 + D·D_back` is rounding, its two terms being of this size together.
pub(crate) fn is_algebraic_loop(left: f64, terms: f64) -> bool {
    left.abs() <= 4.0 * f64::EPSILON * terms
}

pub(crate) fn check_same_clock(first: Option<f64>, second: Option<f64>) -> Result<(), LtiError> {
    if first == second { Ok(()) } else { Err(LtiError::SampleTimesDiffer { first, second }) }
}
