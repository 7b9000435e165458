//! Stepping a discrete system through time.

use faer::{Mat, MatRef};

use crate::error::{LtiError, check_shape, check_state};
use crate::matrix::{RowMajor, map_rows};
use crate::state_space::StateSpace;

/// A discrete system with its state, stepped one sample at a time without allocation.
///
/// `y_k = C x_k + D u_k`, then `x_{k+1} = A x_k + B u_k`. Use it where inputs depend on outputs, as with limits or
/// friction; [`StateSpace::simulate`] where they are known beforehand.
///
/// # Example
/// ```
/// use faer::mat;
/// let sum = lti::StateSpace::discrete(mat![[1.0]], mat![[1.0]], mat![[1.0]], mat![[0.0]], 0.1)?;
/// let mut simulator = lti::Simulator::new(&sum, &[0.0])?;
/// let mut y = [0.0];
/// for u in [1.0, 2.0, 3.0] {
///     simulator.output(&[u], &mut y);
///     simulator.advance(&[u]);
/// }
/// assert_eq!((y[0], simulator.state()), (3.0, &[6.0][..]));
/// # Ok::<(), lti::LtiError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Simulator {
    a: RowMajor,
    b: RowMajor,
    c: RowMajor,
    d: RowMajor,
    state: Vec<f64>,
    next: Vec<f64>,
}

impl Simulator {
    /// A simulator of `system` that starts in the state `x0`.
    ///
    /// # Errors
    /// [`LtiError::NotDiscrete`], [`LtiError::Shape`] where `x0` does not have one entry a state,
    /// [`LtiError::NonFinite`].
    pub fn new(system: &StateSpace, x0: &[f64]) -> Result<Self, LtiError> {
        if system.sample_time_s().is_none() {
            return Err(LtiError::NotDiscrete);
        }
        check_state(x0, system.states())?;
        Ok(Self {
            a: RowMajor::new(system.a()),
            b: RowMajor::new(system.b()),
            c: RowMajor::new(system.c()),
            d: RowMajor::new(system.d()),
            state: x0.to_vec(),
            next: vec![0.0; x0.len()],
        })
    }

    /// The present state.
    #[must_use]
    pub fn state(&self) -> &[f64] {
        &self.state
    }

    /// Writes the present output for the input `u` to `y`; both must have the system's numbers of channels, entries
    /// beyond are left alone.
    pub fn output(&self, u: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        self.c.add_product(&self.state, y);
        self.d.add_product(u, y);
    }

    /// Moves the state on by one sample under the input `u`.
    pub fn advance(&mut self, u: &[f64]) {
        self.next.fill(0.0);
        self.a.add_product(&self.state, &mut self.next);
        self.b.add_product(u, &mut self.next);
        std::mem::swap(&mut self.state, &mut self.next);
    }
}

impl StateSpace {
    /// Simulates a discrete system: `y_k = C x_k + D u_k`, `x_{k+1} = A x_k + B u_k`.
    ///
    /// `u` has one row a sample and one column an input, `x0` one entry a state. Returns the outputs, one row a sample
    /// and one column an output.
    ///
    /// # Errors
    /// [`LtiError::NotDiscrete`], [`LtiError::Shape`], [`LtiError::NonFinite`] for `x0`. NaN in `u` runs through to
    /// the outputs.
    ///
    /// # Example
    /// ```
    /// use faer::{Mat, mat};
    /// let lag = lti::StateSpace::discrete(mat![[0.5]], mat![[0.5]], mat![[1.0]], mat![[0.0]], 0.1)?;
    /// let y = lag.simulate(Mat::full(4, 1, 1.0).as_ref(), &[0.0])?;
    /// assert_eq!(y[(3, 0)], 0.875);
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    pub fn simulate(&self, u: MatRef<'_, f64>, x0: &[f64]) -> Result<Mat<f64>, LtiError> {
        let mut simulator = Simulator::new(self, x0)?;
        check_shape("input", (u.nrows(), self.inputs()), u.shape())?;
        Ok(map_rows(u, self.outputs(), |input, output| {
            simulator.output(input, output);
            simulator.advance(input);
        }))
    }
}
