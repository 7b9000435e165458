//! The samples of a torque signal that an estimate may use.

use ident::IdentError;
use signal::Signal;

use super::held::HeldDemand;
use crate::torque_control::bounds::EARLIEST_S;

/// Time for which a demand at its limit, or an unknown past, still shows in the torque, s.
pub(crate) const MEMORY_S: f64 = 0.1;

/// A demand within this fraction of the limit counts as limited.
const AT_LIMIT: f64 = 1.0 - 1e-6;

/// Torque samples with what is needed to compare them with a model.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Observed {
    /// Instants, s.
    pub(crate) times_s: Vec<f64>,
    /// Torque, Nm.
    pub(crate) values: Vec<f64>,
    /// Place of each sample on the signal's own raster.
    pub(crate) places: Vec<usize>,
    /// Sample time of the raster, s.
    pub(crate) sample_time_s: f64,
    /// Phases of ripple are counted from here, s.
    pub(crate) reference_s: f64,
}

impl Observed {
    /// The samples of `torque` at the indices `range` at which `usable` holds.
    pub(crate) fn new(torque: &Signal, usable: &[bool], range: std::ops::Range<usize>) -> Self {
        let middle = 0.5 * (range.start + range.end) as f64;
        let end = range.end.min(torque.len());
        let places: Vec<usize> = (range.start..end).filter(|i| usable[*i]).collect();
        Observed {
            times_s: places.iter().map(|i| torque.time_s(*i)).collect(),
            values: places.iter().map(|i| torque.samples[*i]).collect(),
            sample_time_s: torque.sample_time_s,
            reference_s: torque.start_s + middle * torque.sample_time_s,
            places,
        }
    }

    /// Samples at these instants of a raster, without ripple.
    pub(crate) fn of_samples(times_s: &[f64], values: Vec<f64>, sample_time_s: f64) -> Self {
        let first = times_s.first().copied().unwrap_or(0.0);
        // The float-to-integer cast saturates.
        let place = |t: &f64| ((t - first) / sample_time_s).round() as usize;
        let places = times_s.iter().map(place).collect();
        Observed { times_s: times_s.to_vec(), values, places, sample_time_s, reference_s: first }
    }

    pub(crate) fn len(&self) -> usize {
        self.values.len()
    }

    /// The longest stretch without a missing sample, as a range of positions.
    pub(crate) fn longest_run(&self) -> std::ops::Range<usize> {
        let (mut best, mut start) = (0..0, 0);
        for i in 1..=self.places.len() {
            let broken = i == self.places.len() || self.places[i] != self.places[i - 1] + 1;
            if broken {
                if i - start > best.len() {
                    best = start..i;
                }
                start = i;
            }
        }
        best
    }

    /// Only the samples at these positions.
    pub(crate) fn part(&self, range: std::ops::Range<usize>) -> Observed {
        Observed {
            times_s: self.times_s[range.clone()].to_vec(),
            values: self.values[range.clone()].to_vec(),
            places: self.places[range].to_vec(),
            ..*self
        }
    }
}

/// Which samples of `torque` depend on a recorded and unlimited demand alone.
pub(crate) fn usable_samples(demand: &Signal, torque: &Signal, limit_nm: Option<f64>) -> Vec<bool> {
    let limited_until = limited_until(demand, limit_nm);
    let index = |time_s: f64| (time_s - demand.start_s) / demand.sample_time_s + 1e-6;
    let usable = |i: usize| {
        let time = torque.time_s(i);
        let inside = time >= demand.start_s + MEMORY_S && time + EARLIEST_S <= demand.end_s() + demand.sample_time_s;
        let last = (index(time + EARLIEST_S).max(0.0) as usize).min(demand.len().saturating_sub(1));
        inside && limited_until.get(last).is_some_and(|until| time > *until)
    };
    (0..torque.len()).map(usable).collect()
}

/// For each sample of the demand: until when an earlier or present limitation shows.
fn limited_until(demand: &Signal, limit_nm: Option<f64>) -> Vec<f64> {
    let limit = limit_nm.unwrap_or(f64::INFINITY) * AT_LIMIT;
    let mut until = f64::NEG_INFINITY;
    let extend = |(i, u): (usize, &f64)| {
        if u.abs() >= limit {
            until = demand.time_s(i) + demand.sample_time_s + MEMORY_S;
        }
        until
    };
    demand.samples.iter().enumerate().map(extend).collect()
}

/// The demand at the instants of the samples.
pub(crate) fn demand_at(demand: &HeldDemand, times_s: &[f64]) -> Vec<f64> {
    times_s.iter().map(|t| demand.at(*t)).collect()
}

pub(super) fn check_finite(what: &'static str, values: &[f64]) -> Result<(), IdentError> {
    match values.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(IdentError::NotFinite { what, index }),
        None => Ok(()),
    }
}
