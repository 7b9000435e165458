//! Where the search for a transfer function begins.

use numerics::vector::{dot, sum_of_squares};

use super::companion::Companion;
use super::projection::Basis;
use super::record::{Record, liveliest};
use super::sampled::Sampled;
use super::srivc::{Estimate, Structure, stable_filter};
use crate::{IdentError, Termination};
use fitting::StructureError;

/// Samples that a starting value may rest on, and a comparison of delays.
const SAMPLES: usize = 30_000;
const SAMPLES_PER_DELAY: usize = 8_000;

/// Corner frequencies tried for the first filter.
const CORNERS: usize = 8;

/// Rounds of instrumental variables.
const ROUNDS: usize = 12;

/// Rounds where a rough value is enough.
const QUICK_ROUNDS: usize = 3;

/// Rounds until instrumental variables have settled, at most.
const SETTLING_ROUNDS: usize = 100;

/// The part by which the error still changes when they have; an error that is this part of the output is none.
const SETTLED: f64 = 1e-12;

/// Best corners that are refined.
const REFINED: usize = 3;

/// Delays compared, at most, for one input.
const DELAYS: usize = 25;

/// A starting value with what it leaves of the output.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub(crate) estimate: Estimate,
    pub(crate) delays: Vec<f64>,
    pub(crate) cost: f64,
}

/// The best starting values at the delays given, best first.
pub(crate) fn candidates(structure: &Structure<'_>, records: &[Record<'_>]) -> Result<Vec<Candidate>, IdentError> {
    explore(structure, &liveliest(records, SAMPLES), ROUNDS)
}

/// The best model after a few rounds over these records.
pub(crate) fn quick_candidate(structure: &Structure<'_>, records: &[Record<'_>]) -> Result<Candidate, IdentError> {
    explore(structure, records, QUICK_ROUNDS)?.into_iter().next().ok_or(StructureError::NoStart.into())
}

fn explore(structure: &Structure<'_>, records: &[Record<'_>], rounds: usize) -> Result<Vec<Candidate>, IdentError> {
    let length = records.iter().map(|r| r.output.len() - r.first).max().unwrap_or(0).max(8) as f64;
    let (low, high) = (4.0 / length, 2.0_f64);
    let mut found = Vec::with_capacity(CORNERS);
    for i in 0..CORNERS {
        let lambda = low * (high / low).powf(i as f64 / (CORNERS - 1) as f64);
        let judged = structure.least_squares(records, lambda).and_then(|e| judge(structure, records, e));
        found.extend(judged.ok().filter(|c| c.cost.is_finite()));
    }
    found.sort_by(|x, y| x.cost.total_cmp(&y.cost));
    found.truncate(REFINED);
    for candidate in &mut found {
        refine(structure, records, candidate, rounds);
    }
    found.sort_by(|x, y| x.cost.total_cmp(&y.cost));
    if found.is_empty() {
        return Err(StructureError::NoStart.into());
    }
    Ok(found)
}

/// Rounds of instrumental variables; the best of them stays.
fn refine(structure: &Structure<'_>, records: &[Record<'_>], best: &mut Candidate, rounds: usize) {
    let mut last = best.estimate.clone();
    for _ in 0..rounds {
        let next = structure.refine(records, &last).and_then(|e| judge(structure, records, e));
        let Ok(next) = next else { return };
        if !next.cost.is_finite() {
            return;
        }
        last = next.estimate.clone();
        let settled = (next.cost - best.cost).abs() <= 1e-6 * best.cost;
        if next.cost < best.cost {
            *best = next;
        }
        if settled {
            return;
        }
    }
}

/// Instrumental variables after as many rounds as they needed.
pub(crate) struct Settled {
    pub(crate) candidate: Candidate,
    /// True if further rounds would change nothing.
    has_settled: bool,
}

impl Settled {
    pub(crate) fn termination(&self) -> Termination {
        if self.has_settled { Termination::SmallStep } else { Termination::IterationLimit }
    }
}

/// Rounds of instrumental variables over all of the data until they settle, from the best starting value.
pub(crate) fn settle(structure: &Structure<'_>, records: &[Record<'_>]) -> Result<Settled, IdentError> {
    let start = candidates(structure, records)?.swap_remove(0);
    let mut candidate = judge(structure, records, start.estimate)?;
    let nothing = SETTLED * records.iter().map(Record::energy).sum::<f64>();
    for _ in 0..SETTLING_ROUNDS {
        let next = judge(structure, records, structure.refine(records, &candidate.estimate)?)?;
        let has_settled = (next.cost - candidate.cost).abs() <= SETTLED * next.cost || next.cost <= nothing;
        candidate = next;
        if has_settled {
            return Ok(Settled { candidate, has_settled });
        }
    }
    Ok(Settled { candidate, has_settled: false })
}

/// Judges an estimate by the output it leaves, initial states and offset taken off, with unstable poles mirrored.
fn judge(structure: &Structure<'_>, records: &[Record<'_>], estimate: Estimate) -> Result<Candidate, IdentError> {
    let length = records.iter().map(|r| r.output.len()).max().unwrap_or(1).max(1);
    let mut a = vec![0.0; structure.integrators];
    a.extend(stable_filter(&estimate.a[structure.integrators..], 1e-3 / length as f64)?);
    let estimate = Estimate { a, b: estimate.b };
    let sampled = SampledEstimate::new(structure, &estimate)?;
    let cost = records.iter().map(|record| sampled.left_over(record)).sum();
    Ok(Candidate { estimate, delays: structure.delays.to_vec(), cost })
}

/// A starting value sampled once for all records.
struct SampledEstimate {
    /// Sampled states of each channel, and `c` and `d` of its output.
    channels: Vec<(Sampled, Vec<f64>, f64)>,
    /// The poles by themselves.
    free: (Sampled, Vec<f64>),
    offset: bool,
}

impl SampledEstimate {
    fn new(structure: &Structure<'_>, estimate: &Estimate) -> Result<Self, IdentError> {
        let channel = |(b, delay): (&Vec<f64>, &f64)| -> Result<_, IdentError> {
            let companion = Companion::monic(&estimate.a, b, *delay);
            let (c, d) = companion.output();
            Ok((companion.sampled(structure.intersample)?, c, d))
        };
        let poles = Companion::monic(&estimate.a, &[1.0], 0.0);
        Ok(SampledEstimate {
            channels: estimate.b.iter().zip(structure.delays).map(channel).collect::<Result<_, _>>()?,
            free: (poles.sampled(structure.intersample)?, poles.output().0),
            offset: structure.offset,
        })
    }

    fn left_over(&self, record: &Record<'_>) -> f64 {
        let mut error = self.simulated_error(record);
        let length = record.output.len() - record.first;
        let (poles, c) = &self.free;
        let mut columns = poles.free_responses(c, length);
        if self.offset {
            columns.push(vec![1.0; length]);
        }
        columns.iter_mut().for_each(|c| record.keep(c));
        Basis::new(columns).take_out(&mut error);
        sum_of_squares(&error)
    }

    fn simulated_error(&self, record: &Record<'_>) -> Vec<f64> {
        let mut error = record.output[record.first..].to_vec();
        for (u, (sampled, c, d)) in record.inputs.iter().zip(&self.channels) {
            sampled.run(u, record.first, &mut vec![0.0; c.len()], |k, z, v, _| {
                error[k - record.first] -= dot(c, z) + d * v;
            });
        }
        record.keep(&mut error);
        error
    }
}

/// The best starting values over delays within bounds, in samples; each input's delay is searched in turn with those of
/// the others held.
pub(crate) fn candidates_over_delays(
    structure: &Structure<'_>,
    records: &[Record<'_>],
    bounds: &[(f64, f64)],
) -> Result<Vec<Candidate>, IdentError> {
    let short = liveliest(records, SAMPLES_PER_DELAY);
    let mut delays: Vec<f64> = bounds.iter().map(|(low, high)| 0.5 * (low + high)).collect();
    let mut ranked = Vec::new();
    let sweeps = if bounds.len() > 1 { 2 } else { 1 };
    for _ in 0..sweeps {
        for (k, bound) in bounds.iter().enumerate() {
            let mut tried = Vec::new();
            for delay in grid(*bound) {
                delays[k] = delay;
                let at = Structure { delays: &delays, ..structure.clone() };
                tried.extend(explore(&at, &short, QUICK_ROUNDS).ok().and_then(|c| c.into_iter().next()));
            }
            tried.sort_by(|x: &Candidate, y| x.cost.total_cmp(&y.cost));
            let best = tried.first().ok_or(StructureError::NoStart)?;
            delays = best.delays.clone();
            ranked = tried;
        }
    }
    ranked.truncate(REFINED);
    // A minimum over a range is none above that at its ends, however few rounds show there.
    for (k, (low, high)) in bounds.iter().enumerate().filter(|(_, (low, high))| low < high) {
        for end in [*low, *high] {
            let mut at_end = delays.clone();
            at_end[k] = end;
            let at = Structure { delays: &at_end, ..structure.clone() };
            ranked.extend(explore(&at, &short, ROUNDS).ok().and_then(|c| c.into_iter().next()));
        }
    }
    let full = liveliest(records, SAMPLES);
    let mut found = Vec::new();
    for candidate in ranked {
        let at = Structure { delays: &candidate.delays, ..structure.clone() };
        let mut judged = judge(&at, &full, candidate.estimate)?;
        refine(&at, &full, &mut judged, ROUNDS);
        found.push(judged);
    }
    found.sort_by(|x, y| x.cost.total_cmp(&y.cost));
    Ok(found)
}

/// Delays in the middle of sample intervals, where the errors are smooth in the delay.
pub(crate) fn grid((low, high): (f64, f64)) -> Vec<f64> {
    if high <= low {
        return vec![low];
    }
    let step = ((high - low) / DELAYS as f64).ceil().max(1.0);
    let count = ((high - low) / step).ceil().max(1.0) as usize;
    (0..count).map(|i| (low + (i as f64 + 0.5) * step).min(0.5 * (low + i as f64 * step + high))).collect()
}
