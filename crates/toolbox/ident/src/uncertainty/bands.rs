//! Frequency, step and impulse responses with their bands.

use lti::{ChannelPair, Complex64, LtiError, TimeGrid};

use super::{Derived, Dynamics, Ellipse};
use crate::distributions::{interval, student_t_quantile};
use crate::{Fit, IdentError, Intersample, LinearModel, Parametric};

/// A frequency response with its uncertainty to first order.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyBand {
    /// The response at the estimate.
    pub response: lti::FrequencyResponse,
    /// Covariance of real and imaginary parts at each frequency.
    pub covariance: Vec<[[f64; 2]; 2]>,
    /// Degrees of freedom behind it.
    pub degrees_of_freedom: f64,
}

impl FrequencyBand {
    /// The interval of the magnitude at each frequency, symmetric in decibels.
    #[must_use]
    pub fn magnitude(&self, level: f64) -> Vec<(f64, f64)> {
        let t = student_t_quantile(0.5 + level / 2.0, self.degrees_of_freedom);
        let band = |(h, d): (&Complex64, (f64, f64))| {
            let factor = (t * d.0).exp();
            (h.norm() / factor, h.norm() * factor)
        };
        self.response.response.iter().zip(self.relative_deviations()).map(band).collect()
    }

    /// The interval of the unwrapped phase at each frequency, in degrees: half a turn at most to either side.
    #[must_use]
    pub fn phase_deg(&self, level: f64) -> Vec<(f64, f64)> {
        let t = student_t_quantile(0.5 + level / 2.0, self.degrees_of_freedom);
        let reach = |d: (f64, f64)| (t * d.1).to_degrees().min(180.0);
        let phase = self.response.phase_deg();
        phase.iter().zip(self.relative_deviations()).map(|(p, d)| (p - reach(d), p + reach(d))).collect()
    }

    /// The region of the complex gain at each frequency.
    #[must_use]
    pub fn ellipses(&self, level: f64) -> Vec<Ellipse> {
        let pairs = self.response.response.iter().zip(&self.covariance);
        pairs.map(|(h, c)| Ellipse::new(*h, *c, self.degrees_of_freedom, level)).collect()
    }

    /// Deviations of `ln |H|` and of the phase in radians, infinite where the gain is zero.
    fn relative_deviations(&self) -> Vec<(f64, f64)> {
        let relative = |(h, c): (&Complex64, &[[f64; 2]; 2])| {
            let (size, along) = (h.norm(), Complex64::cis(h.arg()));
            let variance = |x: f64, y: f64| (x * x * c[0][0] + 2.0 * x * y * c[0][1] + y * y * c[1][1]).max(0.0);
            let part = |variance: f64| if size > 0.0 { variance.sqrt() / size } else { f64::INFINITY };
            (part(variance(along.re, along.im)), part(variance(-along.im, along.re)))
        };
        self.response.response.iter().zip(&self.covariance).map(relative).collect()
    }
}

/// A response over time with its uncertainty to first order.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeBand {
    /// Instants, in seconds.
    pub time_s: Vec<f64>,
    /// The response at the estimate.
    pub values: Vec<f64>,
    /// Its standard error at each instant.
    pub standard_errors: Vec<f64>,
    /// Degrees of freedom behind them.
    pub degrees_of_freedom: f64,
}

impl TimeBand {
    /// The interval that holds the response at each single instant with probability `level`.
    #[must_use]
    pub fn intervals(&self, level: f64) -> Vec<(f64, f64)> {
        let pairs = self.values.iter().zip(&self.standard_errors);
        pairs.map(|(value, error)| interval(*value, *error, self.degrees_of_freedom, level)).collect()
    }
}

impl<M: Parametric + Dynamics> Fit<M> {
    /// The frequency response from an input to an output at angular frequencies in rad/s, with its bands.
    ///
    /// # Errors
    /// Those of the model; [`IdentError::NotFinite`] on a pole.
    ///
    /// # Source
    /// Ljung 1999, (9.57)–(9.59).
    pub fn frequency_band(
        &self,
        output: usize,
        input: usize,
        omega_rad_s: &[f64],
    ) -> Result<FrequencyBand, IdentError> {
        let response = self.model.frequency_response(output, input, omega_rad_s)?;
        let derived = self.derive(|m| {
            let gains = m.frequency_response(output, input, omega_rad_s)?.response;
            Ok(gains.iter().flat_map(|h| [h.re, h.im]).collect())
        })?;
        let covariance = |k: usize| {
            let (re, im) = (2 * k, 2 * k + 1);
            let cross = derived.covariance_of(re, im);
            [[derived.covariance_of(re, re), cross], [cross, derived.covariance_of(im, im)]]
        };
        let covariance = (0..omega_rad_s.len()).map(covariance).collect();
        Ok(FrequencyBand { response, covariance, degrees_of_freedom: self.degrees_of_freedom })
    }
}

impl<M: Parametric + LinearModel> Fit<M> {
    /// The response of an output from rest to an input that is one from the first time on, held between the grid's
    /// times; these are the samples of a discrete model.
    ///
    /// # Errors
    /// Those of the model, another step than a discrete model's among them; [`lti::LtiError::Index`];
    /// [`IdentError::NotFinite`] where an unstable model overflows.
    pub fn step_band(&self, output: usize, input: usize, grid: &TimeGrid) -> Result<TimeBand, IdentError> {
        self.time_band(ChannelPair { output, input }, grid, |_| 1.0)
    }

    /// The response of an output from rest to an input that is one at the first time and zero from the next on: the
    /// coefficients `g(k)` of `Σ_k g(k) u(t − k)`, Ljung 1999, (2.6).
    ///
    /// # Errors
    /// Those of [`Fit::step_band`].
    pub fn impulse_band(&self, output: usize, input: usize, grid: &TimeGrid) -> Result<TimeBand, IdentError> {
        self.time_band(ChannelPair { output, input }, grid, |t| f64::from(u8::from(t == 0)))
    }

    fn time_band(
        &self,
        channel: ChannelPair,
        grid: &TimeGrid,
        course: impl Fn(usize) -> f64,
    ) -> Result<TimeBand, IdentError> {
        let derived: Derived = self.derive(|m| response_over_time(m, channel, grid, &course))?;
        Ok(TimeBand {
            time_s: grid.times(),
            standard_errors: derived.standard_errors(),
            values: derived.values,
            degrees_of_freedom: self.degrees_of_freedom,
        })
    }
}

/// The response of an output from rest to an input that runs so over the grid, held between its times.
pub(super) fn response_over_time(
    model: &impl LinearModel,
    ChannelPair { output, input }: ChannelPair,
    grid: &TimeGrid,
    course: impl Fn(usize) -> f64,
) -> Result<Vec<f64>, LtiError> {
    let channel = model.innovations(grid.step_s, Intersample::ZeroOrderHold)?.system().channel(output, input)?;
    let u = faer::Mat::from_fn(grid.points, 1, |t, _| course(t));
    let y = channel.simulate(u.as_ref(), &vec![0.0; channel.states()])?;
    Ok(y.col_as_slice(0).to_vec())
}
