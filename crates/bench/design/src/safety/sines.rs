//! Amplitudes at which a sine test keeps the limits.

use bench_model::prediction::{PredictionError, PredictionInputs};
use numerics::null::nan_if_null;
use rig::experiment::{Demands, ExperimentPlan};
use serde::{Deserialize, Serialize};
use signal::proportion::Proportion;
use work::Context;

use super::ladder::Ladder;
use super::quantity::reaches;
use super::run::{self, Outcome};
use super::spread::Drawn;
use super::{ALLOWED, Quantity};

/// Amplitudes stay this part below the ones computed: they are said with three digits.
const MARGIN: f64 = 0.99;
/// Rounds in which proposed amplitudes are run, and lowered where they do not hold.
const ROUNDS: usize = 4;
/// How much they are lowered.
const LOWERED: f64 = 0.93;

/// A sine of T_d* in a sine test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SafeSine {
    /// Its frequency, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub frequency_hz: f64,
    /// The amplitude planned, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub planned_nm: f64,
    /// The probability that a limit is reached while it runs as planned.
    pub reached: Proportion,
    /// The largest amplitude that is safe, Nm; zero where the mean alone reaches a limit.
    #[serde(deserialize_with = "nan_if_null")]
    pub safe_nm: f64,
}

/// Proposal in place of a sine test as planned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Proposal {
    /// Every sine, in the order of the test.
    pub sines: Vec<SafeSine>,
    /// True where the test keeps the limits with every sine at its safe amplitude or, where that is lower, the planned
    /// one: run on all benches. The time at the resonance is no matter of amplitudes, and not looked at.
    pub holds: bool,
}

impl Proposal {
    /// The demands of the test with every sine at its safe amplitude or, where that is lower, the planned one; `None`
    /// where the plan is no such test.
    pub fn demands(&self, plan: &ExperimentPlan, demands: &Demands) -> Option<Demands> {
        let ladder = Ladder::of(plan).filter(|ladder| ladder.frequencies_hz.len() == self.sines.len())?;
        let amplitudes: Vec<f64> = self.sines.iter().map(|sine| sine.safe_nm.min(sine.planned_nm)).collect();
        Some(ladder.demands(demands, &amplitudes))
    }
}

/// The proposal for a sine test: the largest amplitudes with which so few benches reach a limit at any of the
/// frequencies that the test as a whole is safe.
pub(super) fn propose(
    inputs: &PredictionInputs<'_>,
    benches: &[Drawn],
    outcomes: &[Outcome],
    context: &Context,
) -> Result<Option<Proposal>, PredictionError> {
    let Some(ladder) = Ladder::of(inputs.plan) else { return Ok(None) };
    let is_bound = outcomes.iter().all(|outcome| outcome.allowed_nm.iter().all(|allowed| allowed.is_finite()));
    if !is_bound {
        return Ok(None);
    }
    let safe = jointly_safe(outcomes, ladder.frequencies_hz.len());
    let sine = |(rung, safe_nm): (usize, f64)| SafeSine {
        frequency_hz: ladder.frequencies_hz[rung],
        planned_nm: ladder.amplitude_nm,
        reached: Proportion::new(
            outcomes.iter().filter(|outcome| outcome.allowed_nm[rung] <= ladder.amplitude_nm).count(),
            outcomes.len(),
        ),
        safe_nm: MARGIN * safe_nm,
    };
    let mut proposal = Proposal { sines: safe.into_iter().enumerate().map(sine).collect(), holds: false };
    let is_lowered = |sine: &SafeSine| sine.safe_nm < sine.planned_nm;
    if !proposal.sines.iter().any(is_lowered) {
        proposal.holds = are_kept(inputs, outcomes);
        return Ok(Some(proposal));
    }
    for _ in 0..ROUNDS {
        let Some(demands) = proposal.demands(inputs.plan, inputs.demands) else { break };
        let lowered = run::outcomes(&PredictionInputs { demands: &demands, ..*inputs }, benches, context)?;
        proposal.holds = are_kept(inputs, &lowered);
        if proposal.holds {
            break;
        }
        proposal.sines.iter_mut().filter(|sine| is_lowered(sine)).for_each(|sine| sine.safe_nm *= LOWERED);
    }
    Ok(Some(proposal))
}

/// For each frequency the amplitude that a bench may have, one rank above the lowest as long as the benches that stay
/// below at any frequency are few.
fn jointly_safe(outcomes: &[Outcome], rungs: usize) -> Vec<f64> {
    let mut ranked: Vec<Vec<f64>> =
        (0..rungs).map(|rung| outcomes.iter().map(|outcome| outcome.allowed_nm[rung]).collect()).collect();
    ranked.iter_mut().for_each(|allowed| allowed.sort_by(f64::total_cmp));
    let at_rank = |rank: usize| -> Vec<f64> { ranked.iter().map(|allowed| allowed[rank]).collect() };
    let is_safe = |amplitudes: &[f64]| {
        let is_beyond = |outcome: &&Outcome| outcome.allowed_nm.iter().zip(amplitudes).any(|(a, safe)| a < safe);
        Proportion::new(outcomes.iter().filter(is_beyond).count(), outcomes.len()).upper <= ALLOWED
    };
    let ranks = (0..outcomes.len()).map(at_rank);
    ranks.take_while(|amplitudes| is_safe(amplitudes)).last().unwrap_or_else(|| at_rank(0))
}

/// Tells whether every limit that amplitudes can keep is kept.
fn are_kept(inputs: &PredictionInputs<'_>, outcomes: &[Outcome]) -> bool {
    let of_amplitude = Quantity::of_plan(inputs.plan).iter().filter(|of| **of != Quantity::TimeAtResonance);
    of_amplitude.filter_map(|of| Some((*of, of.limit(&inputs.limits)?))).all(|(of, limit)| {
        let reached = outcomes.iter().filter(|outcome| reaches(outcome.values[of as usize], limit)).count();
        Proportion::new(reached, outcomes.len()).estimate <= ALLOWED
    })
}
