//! The noise levels of greatest likelihood.
//!
//! Searched for are logarithms: of the density that drives the torque's slope, of the density of what is wrong with
//! T_d, of the lines' damping ratio, of each line's density, and of every further speed's noise over that of the first,
//! in parts of the guesses. All covariances have a scale in common.

use std::f64::consts::TAU;

use faer::Mat;
use ident::smoothing::likeliest;
use ident::{Bounds, IdentError};
use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};

use super::TorqueSmoother;
use super::states::{DAMPING, Levels, TORQUE, WANDERING};
use crate::torque_smoother::observations::Observations;

/// ln of the density of the slope's noise where searches start, (Nm/s)²/s.
const STARTS: [f64; 5] = [9.0, 13.0, 17.0, 21.0, 25.0];
/// The same of the error of T_d, Nm²/Hz.
const TORQUE_START: f64 = 1e-4;
/// Amplitude of a line where the search starts, Nm.
const START_LINE_NM: f64 = 5.0;
/// Damping ratio of a line where the search starts.
const START_LINE_DAMPING: f64 = 0.01;
/// Largest correlation of innovations that is taken at its word: the standard deviations are ten times as large.
const LARGEST_CORRELATION: f64 = 0.98;
/// Range of every logarithm; a damping ratio stays below one.
const LARGEST: f64 = 30.0;

/// The noise levels of greatest likelihood.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NoiseLevels {
    /// Standard deviation of a sample of each speed, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speeds_rad_s: Vec<f64>,
    /// Spectral density of the error of T_d, Nm/√Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub torque_nm_per_root_hz: f64,
    /// Spectral density of the noise in the second derivative of the torque, Nm/s²/√Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub wandering_nm_s2_per_root_hz: f64,
    /// Firing frequency and multiples, Hz, with the amplitude that the model expects, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub lines: Vec<(f64, f64)>,
    /// True where the search reached a maximum.
    pub converged: bool,
    /// Covariance of each speed's innovations at lag one over their variance: near zero where the model is right.
    #[serde(deserialize_with = "nan_if_null")]
    pub innovations_correlation: Vec<f64>,
    /// By what the smoother's standard deviations are multiplied, √((1 + ρ)/(1 − ρ)) with ρ the largest positive of
    /// these correlations: one or more.
    #[serde(deserialize_with = "nan_if_null")]
    pub widening: f64,
}

impl TorqueSmoother<'_> {
    /// The likeliest levels, from so much of the recording's middle.
    ///
    /// # Errors
    /// Those of the search.
    pub fn levels(&self, used_s: f64) -> Result<Levels, IdentError> {
        let middle = self.observed.middle(used_s);
        let part = TorqueSmoother { mechanics: self.mechanics, observed: &middle };
        let starts = STARTS.map(|wandering| part.start_logarithms(wandering));
        let bounds = part.bounds();
        let at = |p: &[f64]| part.system(p, 1.0);
        let found = likeliest(&starts, &bounds, at, middle.torque.as_ref(), middle.speeds.as_ref())?;
        Ok(Levels { logarithms: found.parameters, scale: found.scale, converged: found.termination.converged() })
    }

    fn bounds(&self) -> Vec<Bounds> {
        let bound = |at: usize| {
            let is_damping = at == DAMPING && !self.observed.lines_hz.is_empty();
            Bounds::new(-LARGEST, if is_damping { 0.0 } else { LARGEST })
        };
        (0..self.start_logarithms(STARTS[0]).len()).map(bound).collect()
    }

    fn start_logarithms(&self, wandering: f64) -> Vec<f64> {
        let lines = &self.observed.lines_hz;
        let mut all = vec![wandering, TORQUE_START.ln()];
        if !lines.is_empty() {
            all.push(START_LINE_DAMPING.ln());
        }
        // A damped oscillator of density q holds the power q/(2 ζω) in each of its two states.
        let line = |(k, hz): (usize, &f64)| {
            let amplitude = START_LINE_NM / (k + 1) as f64;
            (amplitude.powi(2) * START_LINE_DAMPING * TAU * hz).ln()
        };
        all.extend(lines.iter().enumerate().map(line));
        all.extend(self.observed.noise_rad_s.iter().skip(1).map(|_| 0.0));
        all
    }

    /// Each speed's variance over its guess, the first one's being one.
    pub(super) fn noise_ratios<'b>(&self, logarithms: &'b [f64]) -> impl Iterator<Item = f64> + 'b {
        let further = self.observed.noise_rad_s.len() - 1;
        std::iter::once(1.0).chain(logarithms[logarithms.len() - further..].iter().map(|l| l.exp()))
    }

    /// The levels in units people use, with what the innovations say of them.
    ///
    /// # Errors
    /// Those of the filter.
    pub fn noise(&self, levels: &Levels) -> Result<NoiseLevels, IdentError> {
        let Levels { logarithms, scale, converged } = levels;
        let (system, start) = self.system(logarithms, *scale)?;
        let innovations = system.innovations(&start, self.observed.torque.as_ref(), self.observed.speeds.as_ref())?;
        let density = |logarithm: f64| (scale * logarithm.exp()).sqrt();
        let line = |(k, hz): (usize, &f64)| {
            let power = scale * (logarithms[DAMPING + 1 + k] - logarithms[DAMPING]).exp() / (2.0 * TAU * hz);
            (*hz, (2.0 * power).sqrt())
        };
        let ratios = self.observed.noise_rad_s.iter().zip(self.noise_ratios(logarithms));
        let correlations: Vec<f64> = self.by_speed(&innovations).iter().map(|own| lag_one(own)).collect();
        Ok(NoiseLevels {
            speeds_rad_s: ratios.map(|(noise, ratio)| (scale * ratio).sqrt() * noise).collect(),
            torque_nm_per_root_hz: density(logarithms[TORQUE]),
            wandering_nm_s2_per_root_hz: density(logarithms[WANDERING]),
            lines: self.observed.lines_hz.iter().enumerate().map(line).collect(),
            converged: *converged,
            widening: widening(&correlations),
            innovations_correlation: correlations,
        })
    }

    /// Innovations, which come in the order in which speeds were read, by speed.
    fn by_speed(&self, innovations: &[f64]) -> Vec<Vec<f64>> {
        let speeds = &self.observed.speeds;
        let mut by_speed = vec![Vec::with_capacity(speeds.nrows()); speeds.ncols()];
        let read = (0..speeds.nrows()).flat_map(|k| (0..speeds.ncols()).map(move |j| (k, j)));
        let read = read.filter(|at| speeds[*at].is_finite());
        read.zip(innovations).for_each(|((_, j), value)| by_speed[j].push(*value));
        by_speed
    }
}

/// By what the smoother's standard deviations are to be multiplied: innovations that hang together count less than as
/// many white ones, (1 − ρ)/(1 + ρ) of them where each has the correlation ρ with the next and takes no more from those
/// before. A once-a-turn error of an encoder does that.
///
/// # Source
/// Bartlett, *Some aspects of the time-correlation problem*, Journal of the Royal Statistical Society 98, 1935.
fn widening(correlations: &[f64]) -> f64 {
    let largest = correlations.iter().copied().fold(0.0, f64::max).min(LARGEST_CORRELATION);
    ((1.0 + largest) / (1.0 - largest)).sqrt()
}

/// Covariance of one value and the next over the variance.
fn lag_one(values: &[f64]) -> f64 {
    let power: f64 = values.iter().map(|v| v * v).sum();
    values.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / power
}

impl Observations {
    /// So much of the middle.
    fn middle(&self, duration_s: f64) -> Observations {
        let rows = ((duration_s / self.sample_time_s) as usize).min(self.speeds.nrows());
        let from = (self.speeds.nrows() - rows) / 2;
        let first = (from..from + rows).map(|k| self.speeds[(k, 0)]).find(|n| n.is_finite()).unwrap_or(0.0);
        Observations {
            speeds: Mat::from_fn(rows, self.speeds.ncols(), |k, j| self.speeds[(from + k, j)] - first),
            torque: Mat::from_fn(rows, 1, |k, _| self.torque[(from + k, 0)]),
            first_rad_s: self.first_rad_s + first,
            start_s: self.start_s + from as f64 * self.sample_time_s,
            ..self.clone()
        }
    }
}
