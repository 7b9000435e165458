//! Features of responses: gain at rest, resonances, bandwidth, rise time, overshoot.

use lti::{ChannelPair, Complex64, LtiError, Margins, StepCharacteristics, TimeGrid};
use numerics::search;

use super::Dynamics;
use super::bands::response_over_time;
use crate::distributions::interval;
use crate::{Fit, IdentError, LinearModel, Parametric};

/// Decibels by which a resonance stands above the lower of the two valleys beside it, at least.
const PROMINENCE_DB: f64 = 0.5;
/// Resonances found at most: the ones that stand out most.
const MOST_PEAKS: usize = 6;
/// Part of the interval that the golden section leaves.
const WIDTH: f64 = 1e-4;
/// Reach of the last parabola, as a part of the interval.
const LAST: f64 = 1e-3;
/// Part of the grid's spacing to which the parabola of a resonance reaches: narrow, so that it moves as the maximum
/// does.
const STENCIL: f64 = 0.1;
/// Relative step of frequency for a slope.
const SLOPE: f64 = 1e-4;
/// A frequency so far below the slowest pole that is not at rest, where a gain that ends has ended; and the factor by
/// which one that does not end rises over a decade, at least.
const SLOW: f64 = 1e-2;
const RISES: f64 = 3.0;

/// A number read off a response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feature {
    /// Its value.
    pub value: f64,
    /// Its standard error, of its logarithm where it can only be positive; none where the model has no covariance.
    error: Option<f64>,
    is_positive: bool,
    degrees_of_freedom: f64,
}

impl Feature {
    /// The interval that holds it with probability `level`, symmetric in the logarithm for frequencies and gains.
    #[must_use]
    pub fn interval(&self, level: f64) -> Option<(f64, f64)> {
        let error = self.error?;
        if self.is_positive {
            let (low, high) = interval(0.0, error, self.degrees_of_freedom, level);
            return Some((self.value * low.exp(), self.value * high.exp()));
        }
        Some(interval(self.value, error, self.degrees_of_freedom, level))
    }
}

/// A maximum of the gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonance {
    /// Where it is, in rad/s.
    pub omega_rad_s: Feature,
    /// How large the gain is there.
    pub gain: Feature,
}

/// A step response in four numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepFeatures {
    /// Where it ends: the gain at rest.
    pub final_value: Feature,
    /// From 10 % to 90 % of it, in seconds; none where 90 % is not reached within the times given.
    pub rise_time_s: Option<Feature>,
    /// In percent of the final value.
    pub overshoot_percent: Feature,
    /// From when on it stays within 2 %, in seconds, without uncertainty: it jumps where a wave enters the band.
    pub settling_time_s: Option<f64>,
}

/// The way from an input to an output, to read features off.
#[derive(Debug)]
pub struct Features<'a, M> {
    model: &'a M,
    fit: Option<&'a Fit<M>>,
    output: usize,
    input: usize,
}

impl<'a, M: Parametric + Dynamics> Features<'a, M> {
    /// Those of an estimate, with its uncertainty.
    #[must_use]
    pub fn of_fit(fit: &'a Fit<M>, output: usize, input: usize) -> Self {
        Features { model: &fit.model, fit: Some(fit), output, input }
    }

    /// Those of a model without covariance.
    #[must_use]
    pub fn of_model(model: &'a M, output: usize, input: usize) -> Self {
        Features { model, fit: None, output, input }
    }

    /// Any number that follows smoothly from the model, of either sign.
    ///
    /// # Errors
    /// Those of the function.
    pub fn number(&self, function: impl Fn(&M) -> Result<f64, LtiError>) -> Result<Feature, IdentError> {
        let value = function(self.model)?;
        let errors = self.errors(|m| Ok(vec![function(m)?]))?;
        Ok(self.feature(value, errors.map(|e| e[0]), false))
    }

    /// The gain at rest; `None` where a pole at rest makes it infinite.
    ///
    /// # Errors
    /// Those of the model.
    pub fn dc_gain(&self) -> Result<Option<Feature>, IdentError> {
        if self.integrates()? {
            return Ok(None);
        }
        let gain = self.number(|m| Ok(self.gain_at(m, 0.0)?.re))?;
        Ok(Some(gain).filter(|gain| gain.value.is_finite()))
    }

    /// Returns true if a pole at rest shows between this input and output: the gain then rises without end towards low
    /// frequencies.
    fn integrates(&self) -> Result<bool, IdentError> {
        let system = self.model.system()?;
        if !system.has_pole_at_rest()? {
            return Ok(false);
        }
        let clock_s = system.sample_time_s();
        let moving = lti::settled(&system.poles()?, clock_s).into_iter().filter(|(_, is_at_rest)| !is_at_rest);
        let rates = moving.map(|(pole, _)| lti::Mode::new(pole, clock_s).natural_frequency_rad_s);
        let slowest = rates.filter(|rate| rate.is_finite()).fold(f64::INFINITY, f64::min);
        let omega = SLOW * if slowest.is_finite() { slowest } else { clock_s.map_or(1.0, f64::recip) };
        let (near, nearer) = (self.gain_at(self.model, omega)?.norm(), self.gain_at(self.model, 0.1 * omega)?.norm());
        Ok(nearer > RISES * near)
    }

    /// The lowest frequency in rad/s from which on the gain is less than 1/√2 of that at rest, looked for on a rising
    /// grid; `None` where there is none, or no gain at rest.
    ///
    /// Its error is `∂ln ω = ∂(ln|H(ω)| − ln|H(0)|)/(d ln|H|/d ln ω)`.
    ///
    /// # Errors
    /// Those of the model.
    pub fn bandwidth_rad_s(&self, omega_rad_s: &[f64]) -> Result<Option<Feature>, IdentError> {
        let at_rest = self.gain_at(self.model, 0.0)?.norm();
        let level = at_rest * std::f64::consts::FRAC_1_SQRT_2;
        let gains = self.model.frequency_response(self.output, self.input, omega_rad_s)?.response;
        let below = gains.iter().position(|h| h.norm() < level).filter(|k| *k > 0 && level.is_finite() && level > 0.0);
        let Some(k) = below else { return Ok(None) };
        let is_above = |omega: f64| Ok::<bool, LtiError>(self.gain_at(self.model, omega)?.norm() >= level);
        let (low, _) = search::try_bisect((omega_rad_s[k - 1], omega_rad_s[k]), is_above)?;
        let size = |m: &M, omega: f64| Ok::<f64, LtiError>(self.gain_at(m, omega)?.norm().ln());
        let slope = (size(self.model, low * (1.0 + SLOPE))? - size(self.model, low * (1.0 - SLOPE))?) / (2.0 * SLOPE);
        let errors = self.errors(|m| Ok(vec![size(m, low)? - size(m, 0.0)?]))?;
        Ok(Some(self.feature(low, errors.map(|e| e[0] / slope.abs()), true)))
    }

    /// The maxima of the gain that stand out, by rising frequency, looked for on a rising grid.
    ///
    /// Each is the top of a parabola of `ln|H|` over `ln ω` through three near points, whose change with the parameters
    /// is its uncertainty.
    ///
    /// # Errors
    /// Those of the model.
    pub fn resonances(&self, omega_rad_s: &[f64]) -> Result<Vec<Resonance>, IdentError> {
        let gains = self.model.frequency_response(self.output, self.input, omega_rad_s)?.response;
        let decibel: Vec<f64> = gains.iter().map(|h| 20.0 * h.norm().log10()).collect();
        let mut found = prominent(&decibel);
        found.truncate(MOST_PEAKS);
        found.sort_unstable();
        found.into_iter().map(|k| self.resonance(&omega_rad_s[k - 1..=k + 1])).collect()
    }

    /// How far the loop that this way closes with a negative sign is from its stability limit, looked for on a rising
    /// grid.
    ///
    /// # Errors
    /// Those of the model.
    pub fn margins(&self, omega_rad_s: &[f64]) -> Result<Margins, IdentError> {
        self.gain_at(self.model, 0.0)?;
        let nowhere = Complex64::new(f64::NAN, f64::NAN);
        let clock_s = self.model.system()?.sample_time_s();
        Ok(Margins::new(omega_rad_s, clock_s, |omega| self.gain_at(self.model, omega).unwrap_or(nowhere)))
    }

    fn resonance(&self, around: &[f64]) -> Result<Resonance, IdentError> {
        let step = 0.5 * STENCIL * (around[2] / around[0]).ln();
        let omega = self.highest(around)?;
        let gain = self.gain_at(self.model, omega)?.norm();
        let errors = self.errors(|m| self.top(m, omega, step).map(|(shift, height)| vec![shift, height]))?;
        Ok(Resonance {
            omega_rad_s: self.feature(omega, errors.as_ref().map(|e| e[0]), true),
            gain: self.feature(gain, errors.as_ref().map(|e| e[1]), true),
        })
    }

    /// Where the gain is largest between the ends of a grid's three points of which the middle one is the highest: by
    /// golden section, which no shape of the peak leads astray, and a parabola where rounding ends it.
    fn highest(&self, around: &[f64]) -> Result<f64, IdentError> {
        let loss = |log_omega: f64| Ok::<f64, LtiError>(-self.gain_at(self.model, log_omega.exp())?.norm());
        let (bounds, length) = ((around[0].ln(), around[2].ln()), (around[2] / around[0]).ln());
        let (omega, step) = (search::try_minimum(bounds, WIDTH * length, loss)?.exp(), LAST * length);
        Ok(omega * self.top(self.model, omega, step)?.0.clamp(-step, step).exp())
    }

    /// The top of the parabola about a frequency: how far away in `ln ω`, and `ln|H|` there.
    fn top(&self, model: &M, omega: f64, step: f64) -> Result<(f64, f64), LtiError> {
        let at = [omega * (-step).exp(), omega, omega * step.exp()];
        let gains = model.frequency_response(self.output, self.input, &at)?.response;
        let [a, b, c] = [0, 1, 2].map(|k| gains[k].norm().ln());
        let (slope, curvature) = (0.5 * (c - a), a - 2.0 * b + c);
        let shift = -slope / curvature;
        Ok((shift * step, b + 0.5 * slope * shift))
    }

    fn gain_at(&self, model: &M, omega: f64) -> Result<Complex64, LtiError> {
        Ok(model.frequency_response(self.output, self.input, &[omega])?.response[0])
    }

    /// Standard errors of a function of the model; `None` without covariance, or where it is not smooth there.
    fn errors(&self, function: impl Fn(&M) -> Result<Vec<f64>, LtiError>) -> Result<Option<Vec<f64>>, IdentError> {
        let Some(fit) = self.fit else { return Ok(None) };
        match fit.derive(function) {
            Ok(derived) => Ok(Some(derived.standard_errors())),
            Err(IdentError::NotFinite { .. }) => Ok(None),
            Err(other) => Err(other),
        }
    }

    fn feature(&self, value: f64, error: Option<f64>, is_positive: bool) -> Feature {
        let degrees_of_freedom = self.fit.map_or(f64::INFINITY, |fit| fit.degrees_of_freedom);
        Feature { value, error: error.filter(|e| e.is_finite()), is_positive, degrees_of_freedom }
    }
}

impl<M: Parametric + Dynamics + LinearModel> Features<'_, M> {
    /// The step response from rest in a few numbers, read off a grid; `None` where it does not end at a value other
    /// than zero.
    ///
    /// # Errors
    /// Those of the model, and of [`Fit::step_band`].
    pub fn step(&self, grid: &TimeGrid) -> Result<Option<StepFeatures>, IdentError> {
        let Some(final_value) =
            self.dc_gain()?.filter(|_| self.model.system().is_ok_and(|s| s.is_stable() == Ok(true)))
        else {
            return Ok(None);
        };
        let seen = |m: &M| {
            let y = response_over_time(m, ChannelPair { output: self.output, input: self.input }, grid, |_| 1.0)?;
            Ok::<_, LtiError>(StepCharacteristics::new(&grid.times(), &y, self.gain_at(m, 0.0)?.re))
        };
        let Some(step) = seen(self.model)? else { return Ok(None) };
        let of = |part: fn(&StepCharacteristics) -> Option<f64>| {
            self.errors(move |m| Ok(vec![seen(m)?.as_ref().and_then(part).unwrap_or(f64::NAN)]))
        };
        let rise = step.rise_time_s.map(|rise| Ok::<_, IdentError>((rise, of(|s| s.rise_time_s.map(f64::ln))?)));
        let overshoot = of(|s| Some(s.overshoot_percent))?;
        Ok(Some(StepFeatures {
            final_value,
            rise_time_s: rise.transpose()?.map(|(rise, e)| self.feature(rise, e.map(|e| e[0]), true)),
            overshoot_percent: self.feature(step.overshoot_percent, overshoot.map(|e| e[0]), false),
            settling_time_s: step.settling_time_s,
        }))
    }
}

/// Inner maxima with prominence, the most prominent first.
fn prominent(decibel: &[f64]) -> Vec<usize> {
    let inner = 1..decibel.len().saturating_sub(1);
    let is_top = |k: &usize| decibel[*k] > decibel[k - 1] && decibel[*k] >= decibel[k + 1];
    let mut all: Vec<(usize, f64)> = inner.filter(is_top).map(|k| (k, prominence(decibel, k))).collect();
    all.retain(|(_, height)| *height >= PROMINENCE_DB);
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all.into_iter().map(|(k, _)| k).collect()
}

/// How far one has to come down from a top, on the way to anything higher or to the end, at least.
fn prominence(decibel: &[f64], top: usize) -> f64 {
    let valley = |way: &mut dyn Iterator<Item = &f64>| {
        way.take_while(|v| **v <= decibel[top]).copied().fold(decibel[top], f64::min)
    };
    let left = valley(&mut decibel[..top].iter().rev());
    let right = valley(&mut decibel[top + 1..].iter());
    decibel[top] - left.max(right)
}
