//! Bode plots and step responses of an estimate in one call, as numbers to be drawn.

use lti::{ChannelPair, TimeGrid};

use super::{Dynamics, TimeBand};
use crate::{Fit, IdentError, LinearModel, Parametric};

/// Frequencies of a Bode plot, at least.
const FREQUENCIES: usize = 200;
/// Confidence of the bands.
const LEVEL: f64 = 0.95;
/// Time constants for which a growing response is followed.
const RUN_AWAY: f64 = 20.0;
/// Points of a growing discrete response, at least.
const FEWEST: usize = 5;

/// A Bode plot of one channel with its confidence band, one entry a frequency in every list.
#[derive(Debug, Clone, PartialEq)]
pub struct BodeChart {
    /// From which input to which output.
    pub channel: ChannelPair,
    /// Frequencies, in hertz.
    pub freq_hz: Vec<f64>,
    /// Magnitude at the estimate, in decibels.
    pub magnitude_db: Vec<f64>,
    /// Its interval.
    pub magnitude_band_db: Vec<(f64, f64)>,
    /// Unwrapped phase at the estimate, in degrees.
    pub phase_deg: Vec<f64>,
    /// Its interval.
    pub phase_band_deg: Vec<(f64, f64)>,
    /// The probability with which each single interval holds the true value.
    pub level: f64,
}

/// A step response of one channel with its confidence band, one entry an instant in every list.
#[derive(Debug, Clone, PartialEq)]
pub struct StepChart {
    /// From which input to which output.
    pub channel: ChannelPair,
    /// Instants, in seconds.
    pub time_s: Vec<f64>,
    /// The response at the estimate, in units of the output.
    pub response: Vec<f64>,
    /// Its interval.
    pub band: Vec<(f64, f64)>,
    /// The probability with which each single interval holds the true value.
    pub level: f64,
}

impl<M: Parametric + Dynamics> Fit<M> {
    /// The Bode plot of every channel, output by output, with 95 % bands: from a decade below the slowest pole to a
    /// decade above the fastest, or to the Nyquist frequency, denser about resonances. [`Fit::bode_at`] takes
    /// frequencies of one's own.
    ///
    /// # Errors
    /// Those of [`Fit::frequency_band`].
    ///
    /// # Example
    /// ```
    /// let u: Vec<f64> = (0..200).map(|t| if (t * t / 7) % 2 == 0 { 1.0 } else { -1.0 }).collect();
    /// let mut y = vec![0.0; 200];
    /// (1..200).for_each(|t| y[t] = 0.8 * y[t - 1] + 0.5 * u[t - 1] + 0.01 * (t as f64 * 1.7).sin());
    /// let fit = ident::OutputError::new(1, 1, 1).fit(&ident::Dataset::siso(0.1, &u, &y)?)?;
    /// let bode = &fit.bode()?[0];
    /// let (low, high) = bode.magnitude_band_db[0];
    /// assert!((bode.magnitude_db[0] - 20.0 * 2.5_f64.log10()).abs() < 0.1 && low < bode.magnitude_db[0] && high > low);
    /// assert_eq!(bode.freq_hz.last(), Some(&5.0));
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    pub fn bode(&self) -> Result<Vec<BodeChart>, IdentError> {
        self.bode_at(&self.model.system()?.frequency_grid(FREQUENCIES)?, LEVEL)
    }

    /// The Bode plot of every channel at angular frequencies in rad/s, with bands that hold with probability `level`.
    ///
    /// # Errors
    /// Those of [`Fit::frequency_band`].
    pub fn bode_at(&self, omega_rad_s: &[f64], level: f64) -> Result<Vec<BodeChart>, IdentError> {
        let system = self.model.system()?;
        let decibel = |gain: f64| 20.0 * gain.log10();
        let chart = |channel: ChannelPair| {
            let band = self.frequency_band(channel.output, channel.input, omega_rad_s)?;
            let magnitude = band.magnitude(level);
            Ok(BodeChart {
                channel,
                freq_hz: band.response.freq_hz(),
                magnitude_db: band.response.magnitude_db(),
                magnitude_band_db: magnitude.iter().map(|(low, high)| (decibel(*low), decibel(*high))).collect(),
                phase_deg: band.response.phase_deg(),
                phase_band_deg: band.phase_deg(level),
                level,
            })
        };
        ChannelPair::all(system.outputs(), system.inputs()).map(chart).collect()
    }
}

impl<M: Parametric + Dynamics + LinearModel> Fit<M> {
    /// The step response of every channel, output by output, with 95 % bands: until the slowest mode has settled after
    /// the longest delay, or an unstable model has run away. [`Fit::step_at`] takes times of one's own.
    ///
    /// # Errors
    /// Those of [`Fit::step_band`].
    pub fn step(&self) -> Result<Vec<StepChart>, IdentError> {
        self.step_at(&step_times(&self.model)?, LEVEL)
    }

    /// The step response of every channel on a time grid, with bands that hold with probability `level`.
    ///
    /// # Errors
    /// Those of [`Fit::step_band`].
    pub fn step_at(&self, grid: &TimeGrid, level: f64) -> Result<Vec<StepChart>, IdentError> {
        let chart = |channel: ChannelPair| {
            let band = self.step_band(channel.output, channel.input, grid)?;
            let intervals = band.intervals(level);
            let TimeBand { time_s, values, .. } = band;
            Ok(StepChart { channel, time_s, response: values, band: intervals, level })
        };
        let model = &self.model;
        ChannelPair::all(LinearModel::outputs(model), LinearModel::inputs(model)).map(chart).collect()
    }
}

/// Times that show the step responses of a model.
fn step_times(model: &impl Dynamics) -> Result<TimeGrid, IdentError> {
    let system = model.system()?;
    let delays = ChannelPair::all(system.outputs(), system.inputs());
    let delays_s: Vec<f64> = delays.map(|c| model.delay_s(c.output, c.input)).collect::<Result<_, _>>()?;
    let longest_s = delays_s.into_iter().fold(0.0, f64::max);
    let natural = system.time_grid()?;
    let grid = match system.growing_mode()? {
        None => natural,
        Some(mode) => {
            let until_s = RUN_AWAY * -mode.time_constant_s();
            let step_s = match system.sample_time_s() {
                Some(step_s) => step_s,
                None => natural.step_s.min(until_s / natural.points as f64),
            };
            let points = natural.points.min((until_s / step_s).ceil() as usize + 1).max(FEWEST);
            TimeGrid { step_s, points }
        }
    };
    Ok(TimeGrid { points: grid.points + (longest_s / grid.step_s).ceil() as usize, ..grid })
}
