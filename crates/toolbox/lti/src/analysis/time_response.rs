//! Step and impulse responses.

use faer::Mat;
use serde::{Deserialize, Serialize};

use super::modes::{AT_REST, Mode};
use crate::delayed::Lag;
use crate::error::{LtiError, check_sample_time};
use crate::state_space::{StateSpace, check_index};
use crate::transfer_function::TransferFunction;

/// Evenly spaced times from zero on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TimeGrid {
    /// From one point to the next, in seconds.
    pub step_s: f64,
    /// Number of points.
    pub points: usize,
}

/// Time constants that a response is shown for, points across the fastest mode, and bounds of the number of points.
const SETTLED: f64 = 7.0;
const ACROSS_FASTEST: f64 = 20.0;
const FEWEST: f64 = 200.0;
const MOST: f64 = 5000.0;

/// How long a mode of little damping is followed, in radians over seven time constants.
const MOST_PERIODS: f64 = 100.0;

impl TimeGrid {
    /// The times, in seconds.
    #[must_use]
    pub fn times(&self) -> Vec<f64> {
        (0..self.points).map(|k| k as f64 * self.step_s).collect()
    }

    /// Until the slowest mode has settled or, where none settles, grown by as much; fine enough for the fastest, in at
    /// most 5000 points. A discrete system keeps its sample time.
    fn of(modes: &[Mode], delay_s: f64, sample_time_s: Option<f64>) -> Self {
        let fastest = modes.iter().map(|m| m.natural_frequency_rad_s).filter(|w| w.is_finite()).fold(0.0, f64::max);
        let seen = modes.iter().filter(|m| m.natural_frequency_rad_s.is_finite());
        let unit = if fastest > 0.0 { 1.0 / fastest } else { sample_time_s.unwrap_or(1.0) };
        let slowest = seen
            .filter(|m| m.natural_frequency_rad_s > AT_REST * fastest)
            .map(|m| m.time_constant_s().abs().min(MOST_PERIODS / m.natural_frequency_rad_s))
            .fold(unit, f64::max);
        let end = SETTLED * slowest + delay_s;
        match sample_time_s {
            Some(step_s) => Self { step_s, points: (end / step_s).clamp(20.0, MOST) as usize + 1 },
            None => {
                let intervals = (end * ACROSS_FASTEST / unit).clamp(FEWEST, MOST).ceil();
                Self { step_s: end / intervals, points: intervals as usize + 1 }
            }
        }
    }

    /// Checks that a system can be shown on this grid; a discrete one on its own samples only.
    fn check(&self, sample_time_s: Option<f64>) -> Result<(), LtiError> {
        check_sample_time(self.step_s)?;
        match sample_time_s {
            Some(own) if (own - self.step_s).abs() > 1e-9 * own => {
                Err(LtiError::SampleTimesDiffer { first: Some(own), second: Some(self.step_s) })
            }
            _ => Ok(()),
        }
    }
}

impl StateSpace {
    /// Times that show the responses of this system: until its slowest mode has settled.
    ///
    /// # Errors
    /// [`LtiError::NoConvergence`].
    pub fn time_grid(&self) -> Result<TimeGrid, LtiError> {
        Ok(TimeGrid::of(&self.modes()?, 0.0, self.sample_time_s()))
    }

    /// The outputs after a unit step of one input at time zero, from rest: one row a time, one column an output. Exact
    /// at the grid's times.
    ///
    /// # Errors
    /// [`LtiError::Index`], [`LtiError::SampleTime`] for the grid; [`LtiError::SampleTimesDiffer`] where a discrete
    /// system has another step; [`LtiError::NonFinite`] where the exponential overflows.
    pub fn step_response(&self, input: usize, grid: &TimeGrid) -> Result<Mat<f64>, LtiError> {
        let system = self.sampled(input, grid)?;
        system.simulate(Mat::full(grid.points, 1, 1.0).as_ref(), &vec![0.0; self.states()])
    }

    /// The outputs after an impulse of one input at time zero, from rest: one row a time, one column an output.
    ///
    /// For a continuous system `C e^{At} B`; feed-through would add an impulse at zero, which is not shown. For a
    /// discrete one the response to a one at the first sample.
    ///
    /// # Errors
    /// Those of [`StateSpace::step_response`].
    pub fn impulse_response(&self, input: usize, grid: &TimeGrid) -> Result<Mat<f64>, LtiError> {
        let system = self.sampled(input, grid)?;
        let mut u: Mat<f64> = Mat::zeros(grid.points, 1);
        if self.sample_time_s().is_none() {
            let start: Vec<f64> = (0..self.states()).map(|i| self.b()[(i, input)]).collect();
            return system.simulate(u.as_ref(), &start);
        }
        if grid.points > 0 {
            u[(0, 0)] = 1.0;
        }
        system.simulate(u.as_ref(), &vec![0.0; self.states()])
    }

    /// The way from one input to all outputs, discrete on the grid.
    fn sampled(&self, input: usize, grid: &TimeGrid) -> Result<Self, LtiError> {
        check_index("input", input, self.inputs())?;
        grid.check(self.sample_time_s())?;
        let (b, d) = (self.b().subcols(input, 1).to_owned(), self.d().subcols(input, 1).to_owned());
        let system = Self::new(self.a().to_owned(), b, self.c().to_owned(), d, self.sample_time_s())?;
        if self.sample_time_s().is_some() { Ok(system) } else { system.to_discrete_zoh(grid.step_s) }
    }
}

impl TransferFunction {
    /// Times that show the responses of this system: until its slowest mode has settled.
    ///
    /// # Errors
    /// [`LtiError::NoConvergence`].
    pub fn time_grid(&self) -> Result<TimeGrid, LtiError> {
        Ok(TimeGrid::of(&self.modes()?, self.delay_s(), self.sample_time_s()))
    }

    /// The output after a unit step at time zero, from rest, one value a time; exact for any delay of a continuous
    /// system.
    ///
    /// # Errors
    /// [`LtiError::SampleTime`] for the grid, [`LtiError::SampleTimesDiffer`] where a discrete system has another step,
    /// [`LtiError::FractionalDelay`] where its delay is not whole samples, [`LtiError::Improper`], [`LtiError::Delay`].
    ///
    /// # Example
    /// ```
    /// let lag = lti::TransferFunction::continuous(vec![2.0], vec![1.0, 1.0])?.with_delay(0.25)?;
    /// let y = lag.step_response(&lti::TimeGrid { step_s: 0.1, points: 11 })?;
    /// assert!(y[2] == 0.0 && (y[10] - 2.0 * (1.0 - (-0.75_f64).exp())).abs() < 1e-14);
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    pub fn step_response(&self, grid: &TimeGrid) -> Result<Vec<f64>, LtiError> {
        let (lag, system) = self.without_delay(grid)?;
        if self.sample_time_s().is_none() {
            let late = system.to_discrete_delayed(&[self.delay_s()], grid.step_s)?;
            let ones = Mat::full(grid.points, 1, 1.0);
            return Ok(column(&late.simulate(ones.as_ref(), &vec![0.0; system.states()], &[0.0])?, 0));
        }
        Ok(column(&system.step_response(0, &shortened(grid, lag.whole()))?, lag.whole().min(grid.points)))
    }

    /// The output after an impulse at time zero, from rest, one value a time; see [`StateSpace::impulse_response`].
    ///
    /// # Errors
    /// Those of [`TransferFunction::step_response`].
    pub fn impulse_response(&self, grid: &TimeGrid) -> Result<Vec<f64>, LtiError> {
        let (lag, mut system) = self.without_delay(grid)?;
        let mut before = lag.whole();
        if lag.fraction() > 0.0 {
            system = system.started_late((1.0 - lag.fraction()) * grid.step_s)?;
            before += 1;
        }
        Ok(column(&system.impulse_response(0, &shortened(grid, before))?, before.min(grid.points)))
    }

    fn without_delay(&self, grid: &TimeGrid) -> Result<(Lag, StateSpace), LtiError> {
        grid.check(self.sample_time_s())?;
        let lag = Lag::new(self.delay_s(), grid.step_s)?;
        match self.sample_time_s() {
            Some(sample_time_s) if lag.fraction() > 0.0 => {
                Err(LtiError::FractionalDelay { delay_s: self.delay_s(), sample_time_s })
            }
            _ => Ok((lag, self.clone().with_delay(0.0)?.to_state_space()?)),
        }
    }
}

fn shortened(grid: &TimeGrid, by: usize) -> TimeGrid {
    TimeGrid { points: grid.points.saturating_sub(by), ..*grid }
}

/// Zeros, then the one column of a table.
fn column(table: &Mat<f64>, zeros: usize) -> Vec<f64> {
    std::iter::repeat_n(0.0, zeros).chain((0..table.nrows()).map(|k| table[(k, 0)])).collect()
}
