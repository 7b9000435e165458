//! Transmission zeros.

use faer::{Mat, Scale};

use super::StateSpace;
use crate::Complex64;
use crate::error::LtiError;
use crate::matrix::{balance, eigenvalues, norm_2};

impl StateSpace {
    /// The zeros of a system with one input and one output: where its gain vanishes, and what its states hide.
    ///
    /// States that output or input cannot reach appear as a zero on their pole. Returns at most as many as there are
    /// states.
    ///
    /// # Errors
    /// [`LtiError::NotSiso`], [`LtiError::ZeroSystem`] where the gain is zero everywhere, [`LtiError::NoConvergence`].
    ///
    /// # Example
    /// ```
    /// // (s + 3) / (s² + 3 s + 2)
    /// let tf = lti::TransferFunction::continuous(vec![1.0, 3.0], vec![1.0, 3.0, 2.0])?;
    /// let zeros = tf.to_state_space()?.zeros()?;
    /// assert!(zeros.len() == 1 && (zeros[0].re + 3.0).abs() < 1e-12);
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    ///
    /// # Source
    /// The reduction of Emami-Naeini, A. and Van Dooren, P. (1982), Automatica 18(4), 415–430, for one input and one
    /// output.
    pub fn zeros(&self) -> Result<Vec<Complex64>, LtiError> {
        Ok(self.zeros_and_gain()?.0)
    }

    /// Zeros and the first Markov parameter that is not zero (`D`, `CB`, `CAB`, …), the numerator's leading
    /// coefficient.
    pub(crate) fn zeros_and_gain(&self) -> Result<(Vec<Complex64>, f64), LtiError> {
        self.check_siso()?;
        let (a, scale) = balance(self.a());
        let b = Mat::from_fn(self.states(), 1, |i, _| self.b[(i, 0)] / scale[i]);
        let c = Mat::from_fn(1, self.states(), |_, j| self.c[(0, j)] * scale[j]);
        let mut system = Reduced { a, b, c, d: self.d[(0, 0)] };
        let rounding = 10.0 * f64::EPSILON * self.states() as f64;
        let (size_a, size_b) = (norm_2(system.a.as_ref()), norm_2(system.b.as_ref()));
        let (small_d, small_c) = (rounding * size_b, rounding * size_a);
        let mut gain = 1.0;
        // Units of input and output are no measure of what is small: a feed-through is compared with what the states
        // add.
        let of_states = size_b * norm_2(system.c.as_ref());
        if system.d == 0.0 || (size_a > 0.0 && system.d.abs() * size_a <= rounding * of_states) {
            if norm_2(system.c.as_ref()) == 0.0 {
                return Err(LtiError::ZeroSystem);
            }
            gain *= system.differentiate();
            while system.d.abs() <= small_d {
                if system.a.nrows() == 0 || norm_2(system.c.as_ref()) <= small_c {
                    return Err(LtiError::ZeroSystem);
                }
                gain *= system.differentiate();
            }
        }
        Ok((eigenvalues(system.inverted().as_ref())?, gain * system.d))
    }
}

/// A system on the way to one with a feed-through.
struct Reduced {
    a: Mat<f64>,
    b: Mat<f64>,
    c: Mat<f64>,
    d: f64,
}

impl Reduced {
    /// Turns the states so that the output is `σ` times the last one alone, but for the feed-through; returns `σ`.
    /// There must be a state and `c` must not be zero.
    fn align(&mut self) -> f64 {
        let last = self.a.nrows() - 1;
        let sigma = -norm_2(self.c.as_ref()).copysign(self.c[(0, last)]);
        let mut v = self.c.transpose().to_owned();
        v[(last, 0)] -= sigma;
        let factor = Scale(2.0 / v.col(0).squared_norm_l2());
        let va = v.transpose() * &self.a;
        self.a -= &v * va * factor;
        let av = &self.a * &v;
        self.a -= av * v.transpose() * factor;
        let vb = v.transpose() * &self.b;
        self.b -= &v * vb * factor;
        self.c = Mat::from_fn(1, last + 1, |_, j| if j == last { sigma } else { 0.0 });
        sigma
    }

    /// Makes the derivative of the one state seen in the output the new output and drops the state, which an output
    /// held at zero keeps at zero. Returns `σ`; there must be a state and `c` must not be zero.
    fn differentiate(&mut self) -> f64 {
        let sigma = self.align();
        let last = self.a.nrows() - 1;
        self.c = self.a.submatrix(last, 0, 1, last).to_owned();
        self.d = self.b[(last, 0)];
        self.b = self.b.submatrix(0, 0, last, 1).to_owned();
        self.a = self.a.submatrix(0, 0, last, last).to_owned();
        sigma
    }

    /// `A − B C/d`, whose eigenvalues are the zeros; `d` is not zero.
    ///
    /// A small `d` makes it large along `C` alone. That direction is made the first, so that balancing and the QR
    /// iteration see a graded matrix and the moderate zeros are not lost in the rounding of the large one.
    fn inverted(&mut self) -> Mat<f64> {
        let n = self.a.nrows();
        if norm_2(self.c.as_ref()) > 0.0 {
            self.align();
        }
        Mat::from_fn(n, n, |i, j| {
            let (i, j) = (n - 1 - i, n - 1 - j);
            self.a[(i, j)] - self.b[(i, 0)] * self.c[(0, j)] / self.d
        })
    }
}
