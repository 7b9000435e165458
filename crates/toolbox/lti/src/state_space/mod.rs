//! [`StateSpace`]: systems as four matrices.

mod connect;
mod discretise;
mod found_poles;
mod resolvent;
mod zeros;

use faer::{Mat, MatRef};
use serde::{Deserialize, Serialize};

pub(crate) use connect::{check_same_clock, is_algebraic_loop};
pub use discretise::FirstOrderHold;
use found_poles::FoundPoles;
use resolvent::{Resolvent, full_solution};

use crate::Complex64;
use crate::error::{LtiError, check_sample_time, check_shape};
use crate::frequency_response::FrequencyResponse;
use crate::matrix::check_matrix;
use crate::matrix::{from_rows, identity, inverse, to_rows};

/// A linear system in state space, continuous (`ẋ = A x + B u`) or discrete (`x_{k+1} = A x_k + B u_k`), with
/// `y = C x + D u`.
///
/// `A` is states × states, `B` states × inputs, `C` outputs × states, `D` outputs × inputs. There may be no state.
///
/// # Example
/// ```
/// use faer::mat;
/// // A motor's speed: J ω̇ = −b ω + T with J = 0.1 kg m² and b = 0.2 N m s.
/// let motor = lti::StateSpace::continuous(mat![[-2.0]], mat![[10.0]], mat![[1.0]], mat![[0.0]])?;
/// assert!((motor.dc_gain()?[(0, 0)] - 5.0).abs() < 1e-12);
/// let sampled = motor.to_discrete_zoh(0.5)?;
/// assert!((sampled.a()[(0, 0)] - (-1.0_f64).exp()).abs() < 1e-15);
/// # Ok::<(), lti::LtiError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "Rows"))]
#[serde(try_from = "Rows", into = "Rows")]
pub struct StateSpace {
    a: Mat<f64>,
    b: Mat<f64>,
    c: Mat<f64>,
    d: Mat<f64>,
    sample_time_s: Option<f64>,
    poles: FoundPoles,
}

/// How a system is written down: matrices as lists of rows, with the sizes that an empty list would lose.
#[derive(Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Rows {
    states: usize,
    inputs: usize,
    outputs: usize,
    a: Vec<Vec<f64>>,
    b: Vec<Vec<f64>>,
    c: Vec<Vec<f64>>,
    d: Vec<Vec<f64>>,
    sample_time_s: Option<f64>,
}

impl From<StateSpace> for Rows {
    fn from(system: StateSpace) -> Self {
        let rows = |m: &Mat<f64>| to_rows(m.as_ref());
        Self {
            states: system.states(),
            inputs: system.inputs(),
            outputs: system.outputs(),
            a: rows(&system.a),
            b: rows(&system.b),
            c: rows(&system.c),
            d: rows(&system.d),
            sample_time_s: system.sample_time_s,
        }
    }
}

impl TryFrom<Rows> for StateSpace {
    type Error = LtiError;

    fn try_from(parts: Rows) -> Result<Self, LtiError> {
        let Rows { states, inputs, outputs, .. } = parts;
        Self::new(
            from_rows("A", &parts.a, states, states)?,
            from_rows("B", &parts.b, states, inputs)?,
            from_rows("C", &parts.c, outputs, states)?,
            from_rows("D", &parts.d, outputs, inputs)?,
            parts.sample_time_s,
        )
    }
}

impl StateSpace {
    /// A system from its matrices; `None` for the sample time makes it continuous.
    ///
    /// # Errors
    /// [`LtiError::Shape`] where the matrices do not fit, [`LtiError::NonFinite`], [`LtiError::SampleTime`].
    pub fn new(
        a: Mat<f64>,
        b: Mat<f64>,
        c: Mat<f64>,
        d: Mat<f64>,
        sample_time_s: Option<f64>,
    ) -> Result<Self, LtiError> {
        sample_time_s.map_or(Ok(()), check_sample_time)?;
        let (states, inputs, outputs) = (a.nrows(), d.ncols(), d.nrows());
        check_shape("A", (states, states), a.shape())?;
        check_shape("B", (states, inputs), b.shape())?;
        check_shape("C", (outputs, states), c.shape())?;
        for (what, m) in [("A", &a), ("B", &b), ("C", &c), ("D", &d)] {
            check_matrix(what, m.as_ref())?;
        }
        Ok(Self { a, b, c, d, sample_time_s, poles: FoundPoles::default() })
    }

    /// A continuous system; see [`StateSpace::new`].
    ///
    /// # Errors
    /// Those of [`StateSpace::new`].
    pub fn continuous(a: Mat<f64>, b: Mat<f64>, c: Mat<f64>, d: Mat<f64>) -> Result<Self, LtiError> {
        Self::new(a, b, c, d, None)
    }

    /// A discrete system; see [`StateSpace::new`].
    ///
    /// # Errors
    /// Those of [`StateSpace::new`].
    pub fn discrete(a: Mat<f64>, b: Mat<f64>, c: Mat<f64>, d: Mat<f64>, sample_time_s: f64) -> Result<Self, LtiError> {
        Self::new(a, b, c, d, Some(sample_time_s))
    }

    /// The state matrix `A`, states × states.
    #[must_use]
    pub fn a(&self) -> MatRef<'_, f64> {
        self.a.as_ref()
    }

    /// The input matrix `B`, states × inputs.
    #[must_use]
    pub fn b(&self) -> MatRef<'_, f64> {
        self.b.as_ref()
    }

    /// The output matrix `C`, outputs × states.
    #[must_use]
    pub fn c(&self) -> MatRef<'_, f64> {
        self.c.as_ref()
    }

    /// The feed-through matrix `D`, outputs × inputs.
    #[must_use]
    pub fn d(&self) -> MatRef<'_, f64> {
        self.d.as_ref()
    }

    /// The sample time in seconds, `None` for a continuous system.
    #[must_use]
    pub fn sample_time_s(&self) -> Option<f64> {
        self.sample_time_s
    }

    /// Number of states.
    #[must_use]
    pub fn states(&self) -> usize {
        self.a.nrows()
    }

    /// Number of inputs.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.d.ncols()
    }

    /// Number of outputs.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.d.nrows()
    }

    /// The poles: eigenvalues of `A`, in rad/s for a continuous system.
    ///
    /// # Errors
    /// [`LtiError::NoConvergence`].
    pub fn poles(&self) -> Result<Vec<Complex64>, LtiError> {
        self.poles.of(self.a())
    }

    /// Returns true if every pole lies strictly inside the stable region: the left half-plane, or the unit circle.
    ///
    /// # Errors
    /// [`LtiError::NoConvergence`].
    pub fn is_stable(&self) -> Result<bool, LtiError> {
        let discrete = self.sample_time_s.is_some();
        Ok(self.poles()?.iter().all(|p| if discrete { p.norm() < 1.0 } else { p.re < 0.0 }))
    }

    /// The gain at rest, outputs × inputs: `D − C A⁻¹ B`, or `D + C (I − A)⁻¹ B` for a discrete system.
    ///
    /// # Errors
    /// [`LtiError::Singular`] for a system that integrates.
    pub fn dc_gain(&self) -> Result<Mat<f64>, LtiError> {
        let resolvent = match self.sample_time_s {
            None => -&self.a,
            Some(_) => identity(self.states()) - &self.a,
        };
        let inverse = inverse(resolvent.as_ref()).ok_or(LtiError::Singular { what: "A (or I − A) at rest" })?;
        Ok(&self.d + &self.c * (inverse * &self.b))
    }

    /// The gain at one complex point, outputs × inputs: `D + C (pI − A)⁻¹ B` at `p = s` or `p = z`. Not finite on a
    /// pole.
    #[must_use]
    pub fn evaluate(&self, point: Complex64) -> Mat<Complex64> {
        self.gain_of(&full_solution(self.a(), self.b(), point))
    }

    /// The gains at angular frequencies in rad/s, one matrix (outputs × inputs) each, at `jω` or `e^{jωT}`.
    #[must_use]
    pub fn gains(&self, omega_rad_s: &[f64]) -> Vec<Mat<Complex64>> {
        let resolvent = Resolvent::new(self.a(), self.b());
        let gain = |omega: &f64| self.gain_of(&resolvent.at(frequency_point(*omega, self.sample_time_s)));
        work::checked(omega_rad_s).map(gain).collect()
    }

    /// `D + C X`.
    fn gain_of(&self, x: &Mat<Complex64>) -> Mat<Complex64> {
        let way = |i: usize, j: usize| along(self.c.row(i).iter(), x.col(j).iter());
        Mat::from_fn(self.outputs(), self.inputs(), |i, j| way(i, j) + self.d[(i, j)])
    }

    /// The frequency response from one input to one output.
    ///
    /// # Errors
    /// [`LtiError::Index`] where the channel does not exist, [`LtiError::NonFinite`] for a frequency.
    pub fn frequency_response(
        &self,
        output: usize,
        input: usize,
        omega_rad_s: &[f64],
    ) -> Result<FrequencyResponse, LtiError> {
        check_index("output", output, self.outputs())?;
        check_index("input", input, self.inputs())?;
        let resolvent = Resolvent::new(self.a(), self.b().submatrix(0, input, self.states(), 1));
        let gain = |omega: &f64| {
            let x = resolvent.at(frequency_point(*omega, self.sample_time_s));
            along(self.c.row(output).iter(), x.col(0).iter()) + self.d[(output, input)]
        };
        let response = work::checked(omega_rad_s).map(gain).collect();
        FrequencyResponse::new(omega_rad_s.to_vec(), response)
    }

    /// The part from one input to one output, with all states.
    ///
    /// # Errors
    /// [`LtiError::Index`] where the channel does not exist.
    pub fn channel(&self, output: usize, input: usize) -> Result<Self, LtiError> {
        check_index("output", output, self.outputs())?;
        check_index("input", input, self.inputs())?;
        let n = self.states();
        Ok(Self {
            a: self.a.clone(),
            b: self.b.submatrix(0, input, n, 1).to_owned(),
            c: self.c.submatrix(output, 0, 1, n).to_owned(),
            d: self.d.submatrix(output, input, 1, 1).to_owned(),
            sample_time_s: self.sample_time_s,
            poles: self.poles.clone(),
        })
    }

    pub(crate) fn check_siso(&self) -> Result<(), LtiError> {
        match (self.inputs(), self.outputs()) {
            (1, 1) => Ok(()),
            (inputs, outputs) => Err(LtiError::NotSiso { inputs, outputs }),
        }
    }
}

/// `c x`.
fn along<'a>(c: impl Iterator<Item = &'a f64>, x: impl Iterator<Item = &'a Complex64>) -> Complex64 {
    c.zip(x).map(|(c, x)| x * c).sum()
}

pub(crate) fn check_index(what: &'static str, index: usize, count: usize) -> Result<(), LtiError> {
    if index < count { Ok(()) } else { Err(LtiError::Index { what, index, count }) }
}

/// Where a system is evaluated for an angular frequency: `jω`, or `e^{jωT}`.
pub(crate) fn frequency_point(omega_rad_s: f64, sample_time_s: Option<f64>) -> Complex64 {
    match sample_time_s {
        None => Complex64::new(0.0, omega_rad_s),
        Some(sample_time_s) => Complex64::cis(omega_rad_s * sample_time_s),
    }
}
