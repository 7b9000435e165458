//! The best binary demand that a search finds.

use signal::excitation::{Prbs, Random, Timing};

use super::DesignTask;
use super::trial::{HeldDemand, Trials};
use crate::excitation_design::error::DesignError;

/// Longest clocks tried, in steps of the demand.
const LONGEST_CLOCK: usize = 8;
/// Random sequences for each clock.
const RANDOM_SEQUENCES: u64 = 4;
/// Changes that are tried on the best of them.
const CHANGES: usize = 400;
/// Periods after which peaks are those of the steady state.
const SETTLED_PERIODS: usize = 2;

/// A demand with two values and no mean, at no particular level.
struct Candidate {
    demand: HeldDemand,
    /// The criterion once it is at the limits.
    value: f64,
}

/// Looks for the binary demand with the lowest criterion at the limits: among maximal-length and random sequences of
/// all clocks, and the signs of `wanted`, whose spectrum is the best one; then by moving single edges of the best,
/// again and again.
pub(super) fn search(
    task: &DesignTask,
    trials: &mut Trials<'_>,
    wanted: &HeldDemand,
) -> Result<HeldDemand, DesignError> {
    let mut best: Option<Candidate> = None;
    for high in candidates(task, wanted)? {
        if let Some(candidate) = judged(task, trials, &high)?
            && best.as_ref().is_none_or(|b| candidate.value < b.value)
        {
            best = Some(candidate);
        }
    }
    let Some(mut best) = best else {
        return Err(DesignError::Task { requirement: "the period is too short for a binary demand" });
    };
    let mut random = Random::new(1);
    for _ in 0..CHANGES {
        let high = changed(&best.demand, &mut random);
        if let Some(candidate) = judged(task, trials, &high)?
            && candidate.value < best.value
        {
            best = candidate;
        }
    }
    Ok(best.demand)
}

fn candidates(task: &DesignTask, wanted: &HeldDemand) -> Result<Vec<Vec<bool>>, DesignError> {
    let steps = task.steps();
    let mut all = vec![wanted.values.iter().map(|v| *v > 0.0).collect::<Vec<bool>>()];
    for clock in 1..=LONGEST_CLOCK.min(steps / 4) {
        let order = ((steps / clock + 1) as f64).log2().floor() as usize;
        if (2..=31).contains(&order) {
            let prbs = Prbs { order, hold: clock, levels: [-1.0, 1.0], seed: 1 };
            let timing = Timing { sample_time_s: task.hold_s, length: prbs.period() };
            all.push(prbs.generate(timing)?.samples.iter().map(|v| *v > 0.0).collect());
        }
        for seed in 0..RANDOM_SEQUENCES {
            let mut random = Random::new(100 * clock as u64 + seed);
            let ticks: Vec<bool> = (0..steps.div_ceil(clock)).map(|_| random.uniform() < 0.5).collect();
            all.push((0..steps).map(|k| ticks[k / clock]).collect());
        }
    }
    Ok(all)
}

/// A sequence with one edge moved by a step, or one step turned over.
fn changed(demand: &HeldDemand, random: &mut Random) -> Vec<bool> {
    let mut high: Vec<bool> = demand.values.iter().map(|v| *v > 0.0).collect();
    let n = high.len();
    let start = ((random.uniform() * n as f64) as usize).min(n - 1);
    let is_edge = |k: &usize| high[*k % n] != high[(*k + 1) % n];
    let place = if random.uniform() < 0.8 { (start..start + n).find(is_edge).unwrap_or(start) } else { start };
    let place = (place + usize::from(random.uniform() < 0.5)) % n;
    high[place] = !high[place];
    high
}

/// The sequence as a demand without mean; none where it never changes or determines nothing.
fn judged(task: &DesignTask, trials: &mut Trials<'_>, high: &[bool]) -> Result<Option<Candidate>, DesignError> {
    let share = high.iter().filter(|h| **h).count() as f64 / high.len() as f64;
    if share == 0.0 || share == 1.0 {
        return Ok(None);
    }
    let demand = HeldDemand { values: high.iter().map(|h| if *h { 1.0 - share } else { -share }).collect() };
    let Some(nominal) = task.models.first() else { return Ok(None) };
    let (peak, _) = demand.peaks_on(task, nominal, SETTLED_PERIODS)?.binding(task);
    if !(peak > 0.0 && peak.is_finite()) {
        return Ok(None);
    }
    let demand = demand.scaled(1.0 / peak);
    match trials.criterion(&demand) {
        Ok(value) => Ok(Some(Candidate { demand, value })),
        Err(DesignError::NotDetermined { .. }) => Ok(None),
        Err(other) => Err(other),
    }
}
