//! Intervals from the profile of the errors.
//!
//! Beside zeros, and where inputs are held, the errors as a function of a delay are flat, bent at whole samples, and
//! have several minima. A covariance knows one of them. Time constants of short data are no better. So transfer
//! functions have profiles of their delays, and process models those of all parameters. The profile of a parameter is
//! the smallest sum of squares with it held; the interval is all values that this does not refute, from the first to
//! the last.
//!
//! # Source
//! Bates & Watts, *Nonlinear Regression Analysis and Its Applications*, 1988, ch. 6; Venzon & Moolgavkar, *A method for
//! computing profile-likelihood-based confidence intervals*, Appl. Statist. 37, 1988.

use super::channel::ContinuousChannel;
use super::estimate::{Ends, OutputFit, Settings, errors, fit_output, quantile};
use super::record::Record;
use crate::{Bounds, Dataset, IdentError, NonlinearOptions, Parametric};
use fitting::nonlinear::lowest_point;

/// Steps of a search with a parameter held. It is over where one lowers the cost by less than this part of what an
/// interval allows, or by next to nothing.
const STEPS: usize = 40;
const FLAT: f64 = 1e-3;
const UNSEEN: f64 = 1e-9;

/// Samples beyond an end in which further minima are looked for.
const BEYOND: f64 = 4.0;

/// Growth of the steps towards an end, and their shrinkage where one of a delay has gone too far.
const GROWTH: f64 = 1.6;
const SHRINKAGE: f64 = 4.0;

/// An end is between two points whose rise, over that of the limit, is no further from one than this, or after so many
/// halvings.
const NEAR: f64 = 0.25;
const BETWEEN: usize = 12;

/// From so many rows on the covariance alone counts: a profile would take longer than the search. That of parameters
/// which are no delays bends less.
const LONG: usize = 100_000;
const LONG_WITHOUT_DELAY: usize = 5_000;

/// Rounds in which a profile may lead to a better estimate.
const PROFILES: usize = 4;

/// A profile that lies this much lower than the estimate has found a better one, as a part of what an interval allows.
const BETTER: f64 = 0.01;

/// Result of a profile.
enum Shown {
    Ends(Vec<Ends>),
    /// Parameters with smaller errors than those of the estimate.
    Better(Vec<f64>),
}

/// A cost with the parameters that have it.
type Point = (f64, Vec<f64>);

struct Profile<'a, C> {
    data: &'a Dataset,
    records: &'a [Record<'a>],
    found: &'a OutputFit<C>,
    settings: Settings,
    parameter: usize,
    is_delay: bool,
    /// The largest cost that is not refuted, and the least that is no better estimate.
    limit: f64,
    better: f64,
}

/// The estimate with the ends of its intervals by profiles, at the better minimum that these may lead to. Where none
/// can be estimated there, or another is better still, it has the intervals of the covariance and is not the least.
pub(crate) fn profiled<C: ContinuousChannel>(
    data: &Dataset,
    records: &[Record<'_>],
    mut found: OutputFit<C>,
    settings: Settings,
) -> OutputFit<C> {
    for _ in 0..PROFILES {
        match ends(data, records, &found, settings) {
            Shown::Ends(ends) => return OutputFit { ends, ..found },
            Shown::Better(theta) => match fit_from(data, records, &found, &theta, settings) {
                Ok(better) => found = better,
                Err(_) => break,
            },
        }
    }
    OutputFit { is_least: false, ..found }
}

/// The estimate that a search from these parameters comes to.
fn fit_from<C: ContinuousChannel>(
    data: &Dataset,
    records: &[Record<'_>],
    found: &OutputFit<C>,
    theta: &[f64],
    settings: Settings,
) -> Result<OutputFit<C>, IdentError> {
    let start = found.model.with_parameters(theta)?;
    fit_output(data, records, &[start], &found.bounds, settings)
}

/// The ends of every parameter that the channels want a profile of, that was searched and does not rest on a bound.
fn ends<C: ContinuousChannel>(
    data: &Dataset,
    records: &[Record<'_>],
    found: &OutputFit<C>,
    settings: Settings,
) -> Shown {
    let minimum = &found.minimum;
    let rows = minimum.residuals.len();
    let (white, quantile) = (minimum.cost / found.remaining(), quantile(found));
    let mut all = Vec::new();
    for (channel, first) in found.model.channels().iter().zip(found.model.offsets()) {
        for own in channel.profiled_parameters() {
            let (parameter, is_delay) = (first + own, channel.delay_parameter() == Some(own));
            let Bounds { lower, upper } = found.bounds[parameter];
            let is_short = rows < if is_delay { LONG } else { LONG_WITHOUT_DELAY };
            if lower == upper || minimum.at_bound[parameter] || !is_short {
                continue;
            }
            let by_colour = found.covariance[(parameter, parameter)]
                / (white * minimum.unscaled_covariance[(parameter, parameter)]);
            let by_colour = if by_colour.is_finite() { by_colour } else { 1.0 };
            let allowed = by_colour * quantile * quantile * white;
            let (limit, better) = (minimum.cost + allowed, minimum.cost - BETTER * allowed);
            match (Profile { data, records, found, settings, parameter, is_delay, limit, better }).ends() {
                Ok((low, high)) => all.push(Ends { parameter, low, high }),
                Err(better) => return Shown::Better(better),
            }
        }
    }
    Shown::Ends(all)
}

impl<C: ContinuousChannel> Profile<'_, C> {
    /// From the first to the last value that is not refuted.
    ///
    /// # Errors
    /// Better parameters than those of the estimate.
    fn ends(&self) -> Result<(f64, f64), Vec<f64>> {
        Ok((self.end(-1.0)?, self.end(1.0)?))
    }

    fn sample_time_s(&self) -> f64 {
        self.data.sample_time_s()
    }

    /// The last step towards an end is no longer, so that no minimum of a delay is passed over there.
    fn last_step(&self) -> f64 {
        if self.is_delay { 0.5 * self.sample_time_s() } else { f64::INFINITY }
    }

    fn end(&self, sign: f64) -> Result<f64, Vec<f64>> {
        let minimum = &self.found.minimum;
        let by_covariance = self.found.covariance[(self.parameter, self.parameter)].max(0.0).sqrt();
        let mut step = if self.is_delay {
            (2.0 * by_covariance).clamp(1e-6 * self.sample_time_s(), self.last_step())
        } else {
            2.0 * by_covariance
        };
        let mut inside: Point = (minimum.cost, minimum.parameters.clone());
        loop {
            let outside = match self.walk(&mut inside, sign, step)? {
                Some(outside) => outside,
                None => return Ok(inside.1[self.parameter]),
            };
            match if self.is_delay { self.further(&outside, sign)? } else { None } {
                Some(further) => (inside, step) = (further, self.last_step()),
                None => return self.between(inside, outside),
            }
        }
    }

    /// Moves on to the last point before the profile is above its limit, and returns the first beyond; none at a bound.
    /// Where the profile is low over many samples the steps grow, and become short again before its end.
    fn walk(&self, inside: &mut Point, sign: f64, mut step: f64) -> Result<Option<Point>, Vec<f64>> {
        let mut longest = f64::INFINITY;
        loop {
            let at = inside.1[self.parameter];
            let next = self.found.bounds[self.parameter].clamp(at + sign * step);
            if next == at {
                return Ok(None);
            }
            let tried = self.held_at(&inside.1, next)?;
            if tried.0 <= self.limit {
                *inside = tried;
                step = (GROWTH * step).min(longest);
            } else if step <= self.last_step() {
                return Ok(Some(tried));
            } else {
                longest = (step / SHRINKAGE).max(self.last_step());
                step = longest;
            }
        }
    }

    /// A point beyond that is not refuted either, where there is one: the errors are smooth from one sample to the next
    /// alone, so each has a minimum of its own.
    fn further(&self, outside: &Point, sign: f64) -> Result<Option<Point>, Vec<f64>> {
        let t = self.sample_time_s();
        let bounds = self.found.bounds[self.parameter];
        let mut before = outside.1.clone();
        let first = (before[self.parameter] / t).floor();
        for k in 0..=BEYOND as usize {
            let at = (first + sign * k as f64 + 0.5) * t;
            if (at - outside.1[self.parameter]) * sign <= 0.0 || bounds.clamp(at) != at {
                continue;
            }
            let tried = self.held_at(&before, at)?;
            if tried.0 <= self.limit {
                return Ok(Some(tried));
            }
            before = tried.1;
        }
        Ok(None)
    }

    /// Where the profile passes its limit.
    fn between(&self, mut inside: Point, mut outside: Point) -> Result<f64, Vec<f64>> {
        for _ in 0..BETWEEN {
            if self.rise(&inside) >= 1.0 - NEAR || self.rise(&outside) <= 1.0 + NEAR {
                break;
            }
            let tried = self.held_at(&inside.1, self.passed(&inside, &outside))?;
            let side = if tried.0 > self.limit { &mut outside } else { &mut inside };
            *side = tried;
        }
        Ok(self.passed(&inside, &outside))
    }

    /// Where the root of the rise of the errors, straight where they are quadratic, passes that of the limit.
    fn passed(&self, inside: &Point, outside: &Point) -> f64 {
        let (from, to) = (inside.1[self.parameter], outside.1[self.parameter]);
        let share = (1.0 - self.rise(inside)) / (self.rise(outside) - self.rise(inside));
        // Nothing is known of the errors where there is no model.
        from + (to - from) * if outside.0.is_finite() && share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 }
    }

    fn rise(&self, point: &Point) -> f64 {
        let cost = self.found.minimum.cost;
        ((point.0 - cost).max(0.0) / (self.limit - cost)).sqrt()
    }

    /// The least errors with the parameter held there, from these parameters.
    ///
    /// # Errors
    /// Parameters that are better than the estimate.
    fn held_at(&self, start: &[f64], value: f64) -> Result<Point, Vec<f64>> {
        let (mut theta, mut bounds) = (start.to_vec(), self.found.bounds.clone());
        theta[self.parameter] = value;
        bounds[self.parameter] = Bounds::new(value, value);
        let mut problem = errors(&self.found.model, self.records, self.data, self.settings);
        let allowed = (self.limit - self.found.minimum.cost) / self.limit.max(f64::MIN_POSITIVE);
        let cost_tolerance = (FLAT * allowed).max(UNSEEN);
        let search = NonlinearOptions { iteration_limit: STEPS, cost_tolerance, ..self.settings.search };
        let tried = match lowest_point(&mut problem, &theta, &bounds, search) {
            // The errors count there whether they determine the other parameters or not.
            Ok(lowest) => (lowest.cost, lowest.parameters),
            // Where there is no model, or one without finite errors, nothing is possible.
            Err(_) => (f64::INFINITY, theta),
        };
        if tried.0 < self.better { Err(tried.1) } else { Ok(tried) }
    }
}
