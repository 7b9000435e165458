//! The filter inside the automation system's own shaft torque: of what past speeds its acceleration is made.

use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};
use signal::resample::{Interpolation, interpolate_at};
use signal::{Signal, SignalError};

/// Longest average, samples of N_d.
const LONGEST: usize = 64;
/// Longest further delay of an average or a lag, samples of N_d; a torque's clock may also be early by as much.
const LATEST: i64 = 8;
/// Samples of N_d left out at either end: what every candidate reaches for, twice for the start of a lag.
const MARGIN: usize = 3 * LONGEST;
/// Time constants tried: so many from half a sample to the longest average, samples.
const LAGS: usize = 48;
/// Values of the torque compared, at most.
const MOST: usize = 20_000;
/// An acceleration that varies by less than this part of its mean square is one value and rounding.
const STEADY: f64 = 1e-10;
/// Part of the spread below which what is left is rounding.
const ROUNDING: f64 = 1e-6;
/// The best must leave less than this part of the spread of T_d,shaft,calc − T_d,calc.
const EXPLAINED: f64 = 0.3;
/// It is separated from the second best by this difference of log-likelihood.
const DECIDED: f64 = 5.0;

/// Filter of the system before, or after, it differentiates the speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Filter {
    /// The mean of the last samples.
    MovingAverage {
        /// N, samples of N_d; one: no filter.
        length: usize,
    },
    /// A first-order lag.
    Lag {
        /// Time constant, s.
        #[serde(deserialize_with = "nan_if_null")]
        time_constant_s: f64,
    },
    /// A delay and nothing else.
    Delay,
}

/// How the system differentiates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Difference {
    /// (N_k − N_{k−1})/T, half a sample late.
    Backward,
    /// (N_{k+1} − N_{k−1})/2T.
    Central,
}

/// A filter with what it leaves unexplained.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FilterCandidate {
    /// The filter.
    pub filter: Filter,
    /// The difference quotient that goes best with it.
    pub difference: Difference,
    /// Delay of the filter alone, s: (N − 1)/2 samples of a moving average, the time constant of a lag.
    #[serde(deserialize_with = "nan_if_null")]
    pub filter_delay_s: f64,
    /// Delay of the acceleration in all, on the clocks as recorded: with the difference quotient and further samples,
    /// s.
    #[serde(deserialize_with = "nan_if_null")]
    pub delay_s: f64,
    /// J_d in T_d,shaft,calc = T_d,calc + J_d·filtered dω_d/dt, kg m².
    #[serde(deserialize_with = "nan_if_null")]
    pub inertia_kg_m2: f64,
    /// Standard deviation of what is left, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub residual_nm: f64,
}

/// The filter that reproduces T_d,shaft,calc, and others that do it less well.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ShaftFilter {
    /// The best.
    pub best: FilterCandidate,
    /// The best moving average of another length, the best lag, the best delay; the best first. What makes the same of
    /// the speed as the best is not among them.
    pub others: Vec<FilterCandidate>,
    /// ln of how much likelier the best is than the second, as if what is left were white, and no less than rounding.
    #[serde(deserialize_with = "nan_if_null")]
    pub log_likelihood_ahead: f64,
    /// Standard deviation of T_d,shaft,calc − T_d,calc, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub spread_nm: f64,
}

impl ShaftFilter {
    /// N, where the best is a moving average.
    #[must_use]
    pub fn moving_average_length(&self) -> Option<usize> {
        match self.best.filter {
            Filter::MovingAverage { length } => Some(length),
            Filter::Lag { .. } | Filter::Delay => None,
        }
    }

    /// Tells whether the best is separated from all others.
    #[must_use]
    pub fn is_decided(&self) -> bool {
        self.log_likelihood_ahead > DECIDED
    }
}

/// Finds what reproduces T_d,shaft,calc = T_d,calc + J_d·filtered dω_d/dt: a moving average of 1 to 64 samples, a
/// first-order lag or a delay; J_d and an offset are free, since the system's J_d need not be the bench file's.
///
/// `None` where nothing leaves less than three tenths of the spread of T_d,shaft,calc − T_d,calc.
///
/// # Errors
/// Signals that are too short or do not overlap.
pub(super) fn detect(speed: &Signal, torque: &Signal, shaft: &Signal) -> Result<Option<ShaftFilter>, SignalError> {
    let search = Search::new(speed, torque, shaft)?;
    let mut all = search.averages();
    all.extend(search.lags());
    all.extend(search.delays());
    all.retain(|candidate| candidate.residual_nm.is_finite() && candidate.inertia_kg_m2 > 0.0);
    let spread_nm = search.spread_nm();
    let left_nm = |candidate: &FilterCandidate| candidate.residual_nm.max(ROUNDING * spread_nm);
    all.sort_by(|a, b| left_nm(a).total_cmp(&left_nm(b)));
    let Some(best) = all.first().copied() else { return Ok(None) };
    let others = others(&all, &best);
    let ahead = others.first().map_or(0.0, |second| left_nm(second).ln() - left_nm(&best).ln());
    let log_likelihood_ahead = search.target.len() as f64 * ahead;
    let found = ShaftFilter { best, others, log_likelihood_ahead, spread_nm };
    Ok((best.residual_nm < EXPLAINED * spread_nm).then_some(found))
}

/// The best of each kind beside the best of all; of averages, the best of another length. An average over one sample is
/// a delay, and is not compared with itself.
fn others(all: &[FilterCandidate], best: &FilterCandidate) -> Vec<FilterCandidate> {
    let is_one = |filter: &Filter| matches!(filter, Filter::MovingAverage { length: 1 } | Filter::Delay);
    let is_other = |kind: fn(&Filter) -> bool| {
        let differs = |c: &&FilterCandidate| {
            kind(&c.filter)
                && !is_same(c, best)
                && match (c.filter, best.filter) {
                    (Filter::MovingAverage { length: a }, Filter::MovingAverage { length: b }) => a != b,
                    (Filter::Lag { .. }, Filter::Lag { .. }) => false,
                    (a, b) => !(is_one(&a) && is_one(&b)),
                }
        };
        all.iter().find(differs).copied()
    };
    let kinds: [fn(&Filter) -> bool; 3] = [
        |f| matches!(f, Filter::MovingAverage { .. }),
        |f| matches!(f, Filter::Lag { .. }),
        |f| matches!(f, Filter::Delay),
    ];
    let mut others: Vec<FilterCandidate> = kinds.into_iter().filter_map(is_other).collect();
    others.sort_by(|a, b| a.residual_nm.total_cmp(&b.residual_nm));
    others
}

/// Tells whether both make the same of the speed: a central difference is the average of two backward ones.
fn is_same(a: &FilterCandidate, b: &FilterCandidate) -> bool {
    let is_central = |c: &FilterCandidate| {
        c.difference == Difference::Central && matches!(c.filter, Filter::MovingAverage { length: 1 } | Filter::Delay)
    };
    let is_average = |c: &FilterCandidate| {
        c.difference == Difference::Backward && matches!(c.filter, Filter::MovingAverage { length: 2 })
    };
    let is_as_late = (a.delay_s - b.delay_s).abs() < 1e-9;
    is_as_late && (is_central(a) && is_average(b) || is_average(a) && is_central(b))
}

/// T_d,shaft,calc − T_d,calc less its mean, and the sample of N_d that each value came with.
struct Search<'a> {
    speed: &'a Signal,
    target: Vec<f64>,
    /// Σ target².
    power: f64,
    places: Vec<usize>,
    /// By how much the torque's stamps are later than those of the samples of N_d they came with, s.
    stamped_late_s: f64,
}

impl<'a> Search<'a> {
    fn new(speed: &'a Signal, torque: &Signal, shaft: &Signal) -> Result<Self, SignalError> {
        let step = speed.sample_time_s;
        let margin = MARGIN as f64 * step;
        let from = (speed.start_s + margin).max(torque.start_s);
        let to = (speed.end_s() - margin).min(torque.end_s());
        let is_common = |t: &f64| *t >= from && *t <= to;
        let times: Vec<f64> = (0..shaft.len()).map(|i| shaft.time_s(i)).filter(is_common).take(MOST).collect();
        let way = Interpolation::BandLimited;
        let (shaft, torque) = (interpolate_at(shaft, &times, way)?, interpolate_at(torque, &times, way)?);
        let target: Vec<f64> = shaft.iter().zip(&torque).map(|(s, t)| s - t).collect();
        let mean = target.iter().sum::<f64>() / target.len() as f64;
        let target: Vec<f64> = target.iter().map(|y| y - mean).collect();
        let power = target.iter().map(|y| y * y).sum();
        let positions: Vec<f64> = times.iter().map(|t| (t - speed.start_s) / step).collect();
        // Rasters that are offset by a part of a sample are so throughout: no position is then rounded up, the next
        // down.
        let turn = |p: &f64| signal::Complex64::from_polar(1.0, std::f64::consts::TAU * p);
        let offset = positions.iter().map(turn).sum::<signal::Complex64>().arg() / std::f64::consts::TAU;
        let places = positions.iter().map(|p| (p - offset).round().max(0.0) as usize).collect();
        Ok(Search { speed, target, power, places, stamped_late_s: offset * step })
    }

    fn spread_nm(&self) -> f64 {
        (self.power / self.target.len() as f64).sqrt()
    }

    /// ω_k, or (ω_k + ω_{k+1})/2, of which a backward difference is a central one.
    fn summed(&self, difference: Difference) -> Vec<f64> {
        let w = &self.speed.samples;
        match difference {
            Difference::Backward => w.clone(),
            Difference::Central => (0..w.len()).map(|k| 0.5 * (w[k] + w[(k + 1).min(w.len() - 1)])).collect(),
        }
    }

    fn averages(&self) -> Vec<FilterCandidate> {
        let mut all = Vec::new();
        for difference in [Difference::Backward, Difference::Central] {
            let w = self.summed(difference);
            for length in 1..=LONGEST {
                let over = length as f64 * self.speed.sample_time_s;
                let slope = |k: usize| (w[k] - w[k - length]) / over;
                let filter = Filter::MovingAverage { length };
                let lengths = (-LATEST..=LATEST).map(|late| (late, slope));
                all.extend(lengths.filter_map(|(late, slope)| {
                    self.candidate(filter, difference, 0.5 * (length as f64 - 1.0), late, slope)
                }));
            }
        }
        all
    }

    fn delays(&self) -> Vec<FilterCandidate> {
        let mut all = Vec::new();
        for difference in [Difference::Backward, Difference::Central] {
            let w = self.summed(difference);
            let slope = |k: usize| (w[k] - w[k - 1]) / self.speed.sample_time_s;
            let lates = 0..=LONGEST as i64;
            all.extend(lates.filter_map(|late| self.candidate(Filter::Delay, difference, 0.0, late, slope)));
        }
        all
    }

    fn lags(&self) -> Vec<FilterCandidate> {
        let mut all = Vec::new();
        let step = self.speed.sample_time_s;
        for difference in [Difference::Backward, Difference::Central] {
            let w = self.summed(difference);
            for i in 0..LAGS {
                let samples = 0.5 * (2.0 * LONGEST as f64).powf(i as f64 / (LAGS - 1) as f64);
                let keep = (-1.0 / samples).exp();
                let mut state = 0.0;
                let mut filtered = vec![0.0; w.len()];
                for k in 1..w.len() {
                    state = keep * state + (1.0 - keep) * (w[k] - w[k - 1]) / step;
                    filtered[k] = state;
                }
                let filter = Filter::Lag { time_constant_s: samples * step };
                // The mean age of what the lag weighs.
                let age = keep / (1.0 - keep);
                let lates = -LATEST..=LATEST;
                all.extend(lates.filter_map(|late| self.candidate(filter, difference, age, late, |k| filtered[k])));
            }
        }
        all
    }

    /// A candidate whose acceleration is late by `late` further samples, with J_d and an offset by least squares.
    fn candidate(
        &self,
        filter: Filter,
        difference: Difference,
        own_samples: f64,
        late: i64,
        acceleration: impl Fn(usize) -> f64,
    ) -> Option<FilterCandidate> {
        let step = self.speed.sample_time_s;
        let at = |place: &usize| Some(acceleration(place.checked_add_signed(-late as isize)?));
        // About one of them, so that a ramp takes no digits from what is beside it.
        let first = at(self.places.first()?)?;
        let (n, mut x, mut xx, mut xy) = (self.target.len() as f64, 0.0, 0.0, 0.0);
        for (place, target) in self.places.iter().zip(&self.target) {
            let a = at(place)? - first;
            x += a;
            xx += a * a;
            xy += a * target;
        }
        let spread = xx - x * x / n;
        if spread <= STEADY * xx {
            return None;
        }
        let inertia_kg_m2 = xy / spread;
        let half = if difference == Difference::Backward { 0.5 } else { 0.0 };
        Some(FilterCandidate {
            filter,
            difference,
            filter_delay_s: own_samples * step,
            delay_s: (own_samples + late as f64 + half) * step + self.stamped_late_s,
            inertia_kg_m2,
            residual_nm: ((self.power - inertia_kg_m2 * xy) / n).max(0.0).sqrt(),
        })
    }
}
