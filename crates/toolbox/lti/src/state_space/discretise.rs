//! From continuous to discrete: zero-order and first-order hold.

use faer::{Mat, MatRef, Scale};

use super::StateSpace;
use crate::error::{LtiError, check_sample_time, check_shape, check_state};
use crate::expm::expm;
use crate::matrix::{RowMajor, blocks, column_scale, identity, map_rows};

impl StateSpace {
    /// The discrete system that equals this continuous one at the samples when inputs are held between them.
    ///
    /// `e^{[A B; 0 0] T} = [Φ Γ; 0 I]`; `C` and `D` stay.
    ///
    /// # Errors
    /// [`LtiError::NotContinuous`], [`LtiError::SampleTime`], [`LtiError::NonFinite`] where the exponential overflows.
    ///
    /// # Source
    /// Van Loan, C. F. (1978), IEEE Trans. Autom. Control 23(3), 395–404.
    pub fn to_discrete_zoh(&self, sample_time_s: f64) -> Result<Self, LtiError> {
        check_sample_time(sample_time_s)?;
        let (phi, gamma) = self.transition(sample_time_s)?;
        Self::discrete(phi, gamma, self.c.clone(), self.d.clone(), sample_time_s)
    }

    /// The covariance of what white noise in this continuous system's states adds to them in a sample,
    /// `∫₀ᵀ e^{As} W e^{Aᵀs} ds`; `density` is W, states × states: the noise's spectral density in both directions of
    /// frequency.
    ///
    /// `e^{[−A W; 0 Aᵀ] T} = [· F; 0 Φᵀ]` gives `Φ F`.
    ///
    /// # Errors
    /// [`LtiError::NotContinuous`], [`LtiError::SampleTime`], [`LtiError::Shape`], [`LtiError::NonFinite`].
    ///
    /// # Source
    /// Van Loan, C. F. (1978), IEEE Trans. Autom. Control 23(3), 395–404.
    pub fn sampled_noise(&self, density: MatRef<'_, f64>, sample_time_s: f64) -> Result<Mat<f64>, LtiError> {
        check_sample_time(sample_time_s)?;
        if self.sample_time_s.is_some() {
            return Err(LtiError::NotContinuous);
        }
        let n = self.states();
        check_shape("noise density", (n, n), density.shape())?;
        // The covariance is linear in W, and a W unlike A in size would cost A squarings it does not need.
        let unit = column_scale(density.norm_l2(), self.a.norm_l2());
        let (back, zero) = (self.a() * Scale(-1.0), Mat::zeros(n, n));
        let (noise, forth) = (density * Scale(unit), self.a.transpose().to_owned());
        let generator = blocks([[back.as_ref(), noise.as_ref()], [zero.as_ref(), forth.as_ref()]]);
        let e = expm((generator * Scale(sample_time_s)).as_ref())?;
        let whole = e.submatrix(n, n, n, n).transpose() * e.submatrix(0, n, n, n);
        Ok(Mat::from_fn(n, n, |i, j| 0.5 * (whole[(i, j)] + whole[(j, i)]) / unit))
    }

    /// `e^{AT}` and `∫₀ᵀ e^{As} ds B`; the time may be zero.
    pub(crate) fn transition(&self, time_s: f64) -> Result<(Mat<f64>, Mat<f64>), LtiError> {
        if self.sample_time_s.is_some() {
            return Err(LtiError::NotContinuous);
        }
        let (n, m) = (self.states(), self.inputs());
        let (zero_left, zero) = (Mat::zeros(m, n), Mat::zeros(m, m));
        let (b, units) = self.b_like_a();
        let generator = blocks([[self.a(), b.as_ref()], [zero_left.as_ref(), zero.as_ref()]]);
        let e = expm((generator * Scale(time_s)).as_ref())?;
        let gamma = Mat::from_fn(n, m, |i, j| e[(i, n + j)] / units[j]);
        Ok((e.submatrix(0, 0, n, n).to_owned(), gamma))
    }

    /// `B` with inputs in units in which it is like `A` in size, and the units: what `B` alone makes large would cost
    /// `A` squarings it does not need.
    fn b_like_a(&self) -> (Mat<f64>, Vec<f64>) {
        let size = self.a.norm_l2();
        let units: Vec<f64> = (0..self.inputs()).map(|j| column_scale(self.b.col(j).norm_l2(), size)).collect();
        (Mat::from_fn(self.states(), self.inputs(), |i, j| self.b[(i, j)] * units[j]), units)
    }

    /// The continuous system whose impulse response is this one's from `time_s` on.
    pub(crate) fn started_late(&self, time_s: f64) -> Result<Self, LtiError> {
        let (phi, _) = self.transition(time_s)?;
        Self::continuous(self.a.clone(), phi * &self.b, self.c.clone(), self.d.clone())
    }

    /// The discrete system that equals this continuous one at the samples when inputs run straight between them.
    ///
    /// `e^{[AT BT 0; 0 0 I; 0 0 0]} = [Φ Γ₁ Γ₂; 0 I I; 0 0 I]` gives
    /// `x_{k+1} = Φ x_k + (Γ₁ − Γ₂) u_k + Γ₂ u_{k+1}`.
    ///
    /// # Errors
    /// [`LtiError::NotContinuous`], [`LtiError::SampleTime`], [`LtiError::NonFinite`] where the exponential overflows.
    ///
    /// # Example
    /// ```
    /// use faer::{Mat, mat};
    /// // An integrator under a ramp: y = t²/2.
    /// let integrator = lti::StateSpace::continuous(mat![[0.0]], mat![[1.0]], mat![[1.0]], mat![[0.0]])?;
    /// let ramp = Mat::from_fn(11, 1, |k, _| 0.1 * k as f64);
    /// let y = integrator.to_discrete_foh(0.1)?.simulate(ramp.as_ref(), &[0.0])?;
    /// assert!((y[(10, 0)] - 0.5).abs() < 1e-15);
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    ///
    /// # Source
    /// Franklin, G. F., Powell, J. D. and Workman, M. (1998), *Digital Control of Dynamic Systems*: the
    /// triangle hold.
    pub fn to_discrete_foh(&self, sample_time_s: f64) -> Result<FirstOrderHold, LtiError> {
        check_sample_time(sample_time_s)?;
        if self.sample_time_s.is_some() {
            return Err(LtiError::NotContinuous);
        }
        let (n, m) = (self.states(), self.inputs());
        let (b, units) = self.b_like_a();
        let (at, bt) = (&self.a * Scale(sample_time_s), b * Scale(sample_time_s));
        let (nm, mn, mm, one) = (Mat::zeros(n, m), Mat::zeros(m, n), Mat::zeros(m, m), identity(m));
        let e = expm(
            blocks([
                [at.as_ref(), bt.as_ref(), nm.as_ref()],
                [mn.as_ref(), mm.as_ref(), one.as_ref()],
                [mn.as_ref(), mm.as_ref(), mm.as_ref()],
            ])
            .as_ref(),
        )?;
        let of_inputs = |first: usize| Mat::from_fn(n, m, |i, j| e[(i, first + j)] / units[j]);
        let b1 = of_inputs(n + m);
        Ok(FirstOrderHold {
            a: e.submatrix(0, 0, n, n).to_owned(),
            b0: of_inputs(n) - &b1,
            b1,
            c: self.c.clone(),
            d: self.d.clone(),
            sample_time_s,
        })
    }
}

/// A continuous system sampled under inputs that run straight between the samples:
/// `x_{k+1} = A x_k + B₀ u_k + B₁ u_{k+1}`, `y_k = C x_k + D u_k`.
///
/// `x` is the continuous system's own state. Made by [`StateSpace::to_discrete_foh`].
#[derive(Debug, Clone, PartialEq)]
pub struct FirstOrderHold {
    a: Mat<f64>,
    b0: Mat<f64>,
    b1: Mat<f64>,
    c: Mat<f64>,
    d: Mat<f64>,
    sample_time_s: f64,
}

impl FirstOrderHold {
    /// The state matrix, `e^{AT}`.
    #[must_use]
    pub fn a(&self) -> MatRef<'_, f64> {
        self.a.as_ref()
    }

    /// Effect of the input at the start of a sample interval on the state at its end.
    #[must_use]
    pub fn b0(&self) -> MatRef<'_, f64> {
        self.b0.as_ref()
    }

    /// Effect of the input at the end of a sample interval on the state there.
    #[must_use]
    pub fn b1(&self) -> MatRef<'_, f64> {
        self.b1.as_ref()
    }

    /// The sample time, in seconds.
    #[must_use]
    pub fn sample_time_s(&self) -> f64 {
        self.sample_time_s
    }

    /// Simulates: `u` has one row a sample and one column an input, `x0` is the continuous system's state at the first
    /// sample. Returns outputs, one row a sample.
    ///
    /// # Errors
    /// [`LtiError::Shape`], [`LtiError::NonFinite`] for `x0`.
    pub fn simulate(&self, u: MatRef<'_, f64>, x0: &[f64]) -> Result<Mat<f64>, LtiError> {
        check_shape("input", (u.nrows(), self.d.ncols()), u.shape())?;
        check_state(x0, self.a.nrows())?;
        let rows = |m: &Mat<f64>| RowMajor::new(m.as_ref());
        let (a, b0, b1, c, d) = (rows(&self.a), rows(&self.b0), rows(&self.b1), rows(&self.c), rows(&self.d));
        // `carried` is A x + B₀ u of the sample before: the state but for the input that has not been seen yet.
        let (mut state, mut carried, mut first) = (x0.to_vec(), vec![0.0; x0.len()], true);
        Ok(map_rows(u, self.d.nrows(), |input, output| {
            if !first {
                state.copy_from_slice(&carried);
                b1.add_product(input, &mut state);
            }
            first = false;
            output.fill(0.0);
            c.add_product(&state, output);
            d.add_product(input, output);
            carried.fill(0.0);
            a.add_product(&state, &mut carried);
            b0.add_product(input, &mut carried);
        }))
    }

    /// The same system in ordinary form, with the state `w_k = x_k − B₁ u_k`:
    /// `w_{k+1} = A w_k + (B₀ + A B₁) u_k`, `y_k = C w_k + (D + C B₁) u_k`.
    ///
    /// # Errors
    /// [`LtiError::NonFinite`] where a product overflows.
    pub fn to_state_space(&self) -> Result<StateSpace, LtiError> {
        let b = &self.b0 + &self.a * &self.b1;
        let d = &self.d + &self.c * &self.b1;
        StateSpace::discrete(self.a.clone(), b, self.c.clone(), d, self.sample_time_s)
    }
}
