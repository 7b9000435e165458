//! Systems behind input delays that need not be whole samples.

use faer::{Mat, MatRef};

use crate::error::{LtiError, check_delay, check_sample_time, check_shape, check_state};
use crate::matrix::{RowMajor, map_rows};
use crate::state_space::StateSpace;

/// A continuous system behind input delays, sampled under held inputs; exact at the samples for any delay.
///
/// A delay of `(w + f)·T`, `w` whole and `0 ≤ f < 1`, makes the held input change within the sample interval:
/// `x_{k+1} = Φ x_k + Γ_before u_{k−w−1} + Γ_now u_{k−w}` with `Γ_now = ∫₀^{(1−f)T} e^{As} ds B` and
/// `Γ_before = e^{A(1−f)T} ∫₀^{fT} e^{As} ds B`; `y_k = C x_k + D u(t_k − delay)`. Each input has its own delay.
/// Made by [`StateSpace::to_discrete_delayed`].
///
/// # Source
/// Åström, K. J. and Wittenmark, B. (1997), *Computer-Controlled Systems*, ch. 2: sampling a system
/// with a delay.
#[derive(Debug, Clone, PartialEq)]
pub struct DelayedStateSpace {
    a: Mat<f64>,
    now: Mat<f64>,
    before: Mat<f64>,
    c: Mat<f64>,
    d: Mat<f64>,
    lags: Vec<Lag>,
    sample_time_s: f64,
}

/// Longest delay, in samples.
const MAX_SAMPLES: f64 = 1e9;

/// One input's delay in samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lag {
    whole: usize,
    fraction: f64,
}

impl Lag {
    /// Splits a delay; one within a billionth of a sample of a whole number counts as whole.
    pub(crate) fn new(delay_s: f64, sample_time_s: f64) -> Result<Self, LtiError> {
        check_delay(delay_s)?;
        let samples = delay_s / sample_time_s;
        if samples > MAX_SAMPLES {
            return Err(LtiError::Delay { delay_s });
        }
        if (samples - samples.round()).abs() < 1e-9 {
            return Ok(Self { whole: samples.round() as usize, fraction: 0.0 });
        }
        Ok(Self { whole: samples.floor() as usize, fraction: samples.fract() })
    }

    /// Whole samples.
    pub(crate) fn whole(self) -> usize {
        self.whole
    }

    /// Fraction of a sample beyond them, in 0 .. 1.
    pub(crate) fn fraction(self) -> f64 {
        self.fraction
    }

    /// Samples back to the value seen at a sample instant.
    fn back(self) -> usize {
        self.whole + usize::from(self.fraction > 0.0)
    }
}

impl StateSpace {
    /// This continuous system behind input delays, one an input, in seconds, sampled under held inputs.
    ///
    /// # Errors
    /// [`LtiError::NotContinuous`], [`LtiError::SampleTime`], [`LtiError::Delay`] (negative, or longer than 1e9
    /// samples), [`LtiError::Shape`] unless there is
    /// one delay an input.
    ///
    /// # Example
    /// ```
    /// use faer::{Mat, mat};
    /// // An integrator behind 0.25 s: from a unit step at 0 it has gathered t − 0.25.
    /// let integrator = lti::StateSpace::continuous(mat![[0.0]], mat![[1.0]], mat![[1.0]], mat![[0.0]])?;
    /// let y = integrator
    ///     .to_discrete_delayed(&[0.25], 0.1)?
    ///     .simulate(Mat::full(11, 1, 1.0).as_ref(), &[0.0], &[0.0])?;
    /// assert!((y[(10, 0)] - 0.75).abs() < 1e-14 && (y[(3, 0)] - 0.05).abs() < 1e-14);
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    pub fn to_discrete_delayed(&self, delays_s: &[f64], sample_time_s: f64) -> Result<DelayedStateSpace, LtiError> {
        check_sample_time(sample_time_s)?;
        check_shape("delays", (self.inputs(), 1), (delays_s.len(), 1))?;
        let lags = delays_s.iter().map(|d| Lag::new(*d, sample_time_s)).collect::<Result<Vec<Lag>, LtiError>>()?;
        let (a, mut now) = self.transition(sample_time_s)?;
        let mut before = Mat::zeros(self.states(), self.inputs());
        for (j, lag) in lags.iter().enumerate().filter(|(_, lag)| lag.fraction > 0.0) {
            let (rest, late) = self.transition((1.0 - lag.fraction) * sample_time_s)?;
            let (_, early) = self.transition(lag.fraction * sample_time_s)?;
            now.col_mut(j).copy_from(late.col(j));
            before.col_mut(j).copy_from(&rest * early.col(j));
        }
        let (c, d) = (self.c().to_owned(), self.d().to_owned());
        Ok(DelayedStateSpace { a, now, before, c, d, lags, sample_time_s })
    }
}

impl DelayedStateSpace {
    /// The sample time, in seconds.
    #[must_use]
    pub fn sample_time_s(&self) -> f64 {
        self.sample_time_s
    }

    /// Simulates: `u` has one row a sample and one column an input, held until the next row; `x0` is the state at the
    /// first sample; `u_before` is what each input was before the first row. Returns outputs, one row a sample.
    ///
    /// # Errors
    /// [`LtiError::Shape`], [`LtiError::NonFinite`] for `x0`.
    pub fn simulate(&self, u: MatRef<'_, f64>, x0: &[f64], u_before: &[f64]) -> Result<Mat<f64>, LtiError> {
        let inputs = self.lags.len();
        check_shape("input", (u.nrows(), inputs), u.shape())?;
        check_shape("input before the record", (inputs, 1), (u_before.len(), 1))?;
        check_state(x0, self.a.nrows())?;
        let rows = |m: &Mat<f64>| RowMajor::new(m.as_ref());
        let (a, now, before, c, d) = (rows(&self.a), rows(&self.now), rows(&self.before), rows(&self.c), rows(&self.d));
        let past = |k: usize, back: usize, j: usize| k.checked_sub(back).map_or(u_before[j], |i| u[(i, j)]);
        let (mut state, mut next) = (x0.to_vec(), vec![0.0; x0.len()]);
        let (mut seen, mut newer, mut older) = (vec![0.0; inputs], vec![0.0; inputs], vec![0.0; inputs]);
        let mut k = 0;
        Ok(map_rows(u, self.d.nrows(), |_, output| {
            for (j, lag) in self.lags.iter().enumerate() {
                seen[j] = past(k, lag.back(), j);
                newer[j] = past(k, lag.whole, j);
                older[j] = past(k, lag.whole + 1, j);
            }
            output.fill(0.0);
            c.add_product(&state, output);
            d.add_product(&seen, output);
            next.fill(0.0);
            a.add_product(&state, &mut next);
            now.add_product(&newer, &mut next);
            before.add_product(&older, &mut next);
            std::mem::swap(&mut state, &mut next);
            k += 1;
        }))
    }

    /// The same system in ordinary form, past inputs as further states: `x` first, then for each input in turn
    /// `u_{k−1}, u_{k−2}, …` as far back as it is needed.
    ///
    /// # Errors
    /// [`LtiError::NonFinite`] never in practice: the matrices were finite.
    pub fn to_state_space(&self) -> Result<StateSpace, LtiError> {
        let (n, inputs, outputs) = (self.a.nrows(), self.lags.len(), self.d.nrows());
        let total = n + self.lags.iter().map(|lag| lag.back()).sum::<usize>();
        let (mut a, mut b) = (Mat::zeros(total, total), Mat::zeros(total, inputs));
        let (mut c, mut d) = (Mat::zeros(outputs, total), Mat::zeros(outputs, inputs));
        a.submatrix_mut(0, 0, n, n).copy_from(&self.a);
        c.submatrix_mut(0, 0, outputs, n).copy_from(&self.c);
        let mut first = n;
        for (j, lag) in self.lags.iter().enumerate() {
            // Adds a column of gains on the input `back` samples ago.
            let place = |gain: faer::ColRef<'_, f64>, back: usize, state: &mut Mat<f64>, input: &mut Mat<f64>| {
                let column = if back == 0 { input.col_mut(j) } else { state.col_mut(first + back - 1) };
                let mut top = column.subrows_mut(0, gain.nrows());
                top += gain;
            };
            place(self.now.col(j), lag.whole, &mut a, &mut b);
            if lag.fraction > 0.0 {
                place(self.before.col(j), lag.whole + 1, &mut a, &mut b);
            }
            place(self.d.col(j), lag.back(), &mut c, &mut d);
            for back in 0..lag.back() {
                if back == 0 {
                    b[(first, j)] = 1.0;
                } else {
                    a[(first + back, first + back - 1)] = 1.0;
                }
            }
            first += lag.back();
        }
        StateSpace::discrete(a, b, c, d, self.sample_time_s)
    }
}
