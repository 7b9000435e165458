//! Amplitudes at which a sine test keeps the limits.

use bench_model::model::BenchModel;
use bench_model::prediction::{Prediction, PredictionError, PredictionInputs, predict};
use rig::ControlMode;
use rig::experiment::{Demands, ExperimentPlan, TorqueTarget, UPDATE_S, Waveform};
use serde::Serialize;

use super::quantity::{demand_samples, largest, reaches, slew};
use super::run::{self, Outcome};
use super::spread::Drawn;
use super::{ALLOWED, Proportion, Quantity};

/// Amplitudes stay this part below the ones computed: they are said with three digits.
const MARGIN: f64 = 0.99;
/// Rounds in which proposed amplitudes are run, and lowered where they do not hold.
const ROUNDS: usize = 4;
/// How much they are lowered.
const LOWERED: f64 = 0.93;

/// A sine of T_d* in a sine test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SafeSine {
    /// Its frequency, Hz.
    pub frequency_hz: f64,
    /// The amplitude planned, Nm.
    pub planned_nm: f64,
    /// The probability that a limit is reached while it runs as planned.
    pub reached: Proportion,
    /// The largest amplitude that is safe, Nm; zero where the mean alone reaches a limit.
    pub safe_nm: f64,
}

/// What to do in place of a sine test as planned.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Proposal {
    /// Every sine, in the order of the test.
    pub sines: Vec<SafeSine>,
    /// Whether the test keeps the limits with every sine at its safe amplitude or, where that is lower, the planned one:
    /// run on all benches. The time at the resonance is no matter of amplitudes, and not looked at.
    pub holds: bool,
}

/// The sines of a sine test of T_d*.
pub(super) struct Ladder<'a> {
    pub(super) frequencies_hz: &'a [f64],
    amplitude_nm: f64,
    mean_nm: f64,
    dwell_s: f64,
    hold: usize,
}

impl<'a> Ladder<'a> {
    /// Of a plan that demands them of T_d*, of a fired engine on a shaft; `None` for any other.
    pub(super) fn of(plan: &'a ExperimentPlan) -> Option<Self> {
        let Waveform::SineLadder { mean, amplitude, frequencies_hz, dwell_s } = &plan.dyno_torque_nm else {
            return None;
        };
        let is_sine_test = plan.label.mode == ControlMode::Tn
            && plan.torque_target == TorqueTarget::AirGap
            && plan.has_shaft
            && !plan.is_motored
            && *amplitude != 0.0
            && !frequencies_hz.is_empty();
        is_sine_test.then(|| Ladder {
            frequencies_hz,
            amplitude_nm: amplitude.abs(),
            mean_nm: *mean,
            dwell_s: *dwell_s,
            hold: demand_samples(UPDATE_S),
        })
    }

    /// The sine that runs at an update: the one of the update at which T_d* last changed.
    pub(super) fn rung(&self, update: usize) -> usize {
        let time_s = (update / self.hold * self.hold) as f64 * UPDATE_S;
        ((time_s / self.dwell_s + 1e-9).floor() as usize).min(self.frequencies_hz.len() - 1)
    }

    /// First update of each sine, and the end.
    fn bounds(&self, updates: usize) -> Vec<usize> {
        (0..=self.frequencies_hz.len()).map(|rung| self.first(rung, updates)).collect()
    }

    fn first(&self, rung: usize, updates: usize) -> usize {
        if rung == self.frequencies_hz.len() {
            return updates;
        }
        let near = ((rung as f64 * self.dwell_s / UPDATE_S) as usize).saturating_sub(2 * self.hold);
        (near..updates).find(|update| self.rung(*update) >= rung).unwrap_or(updates)
    }

    /// The demands with an amplitude of its own for each sine.
    fn demands(&self, demands: &Demands, amplitudes_nm: &[f64]) -> Demands {
        let mut changed = demands.clone();
        for (update, torque) in changed.dyno_torque_nm.iter_mut().enumerate() {
            *torque = self.mean_nm + (*torque - self.mean_nm) * amplitudes_nm[self.rung(update)] / self.amplitude_nm;
        }
        changed
    }
}

impl Proposal {
    /// The demands of the test with every sine at its safe amplitude or, where that is lower, the planned one; `None` where
    /// the plan is no such test.
    pub fn demands(&self, plan: &ExperimentPlan, demands: &Demands) -> Option<Demands> {
        let ladder = Ladder::of(plan).filter(|ladder| ladder.frequencies_hz.len() == self.sines.len())?;
        let amplitudes: Vec<f64> = self.sines.iter().map(|sine| sine.safe_nm.min(sine.planned_nm)).collect();
        Some(ladder.demands(demands, &amplitudes))
    }
}

/// The largest amplitude of each sine that keeps the limits on one bench. The bench is linear short of the inverter's limit,
/// so what a sine adds to the rest grows with its amplitude; onset and the decay of the sine before are part of it.
pub(super) fn allowed_nm(
    inputs: &PredictionInputs<'_>,
    ladder: &Ladder<'_>,
    prediction: &Prediction,
) -> Result<Vec<f64>, PredictionError> {
    if prediction.response.limited_share > 0.0 {
        let linear = BenchModel { torque_limit_nm: None, ..inputs.model.clone() };
        return match predict(&PredictionInputs { model: &linear, ..*inputs }) {
            Ok(free) => Ok(allowed_of(inputs, ladder, &free)),
            Err(PredictionError::Unstable) => Ok(vec![0.0; ladder.frequencies_hz.len()]),
            Err(error) => Err(error),
        };
    }
    Ok(allowed_of(inputs, ladder, prediction))
}

fn allowed_of(inputs: &PredictionInputs<'_>, ladder: &Ladder<'_>, prediction: &Prediction) -> Vec<f64> {
    let (response, limits) = (&prediction.response, &inputs.limits);
    let hold = demand_samples(prediction.sample_time_s);
    let peaks = [
        (&response.shaft_torque_nm, limits.shaft_torque_nm),
        (&response.torque_demand_nm, limits.torque_nm),
        (&response.dyno_speed_rad_s, limits.speed_rad_s),
        (&response.engine_speed_rad_s, limits.speed_rad_s),
    ];
    let slews = [
        (&response.shaft_torque_nm, 1, limits.shaft_torque_slew_nm_per_s),
        (&response.torque_demand_nm, hold, limits.torque_slew_nm_per_s),
    ];
    let bounds = ladder.bounds(response.shaft_torque_nm.len());
    let allowed = |pair: &[usize]| {
        let (from, to) = (pair[0], pair[1]);
        let of_peaks = peaks.iter().filter_map(|(values, limit)| {
            let (rest, limit) = (values[0], (*limit)?);
            let change: Vec<f64> = values[from..to].iter().map(|value| value - rest).collect();
            Some((limit - rest.abs()).max(0.0) / largest(&change))
        });
        let of_slews = slews.iter().filter_map(|(values, apart, limit)| {
            let rate = slew(&values[from.saturating_sub(*apart)..to], *apart, prediction.sample_time_s);
            Some((*limit)? / rate)
        });
        // A limit of nothing over a change of nothing says nothing.
        let factor = of_peaks.chain(of_slews).filter(|factor| !factor.is_nan()).fold(f64::INFINITY, f64::min);
        factor * ladder.amplitude_nm
    };
    bounds.windows(2).map(allowed).collect()
}

/// The proposal for a sine test: the largest amplitudes with which so few benches reach a limit at any of the frequencies
/// that the test as a whole is safe.
pub(super) fn propose(
    inputs: &PredictionInputs<'_>,
    benches: &[Drawn],
    outcomes: &[Outcome],
    told: &(dyn Fn(u64, u64) + Sync),
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
        let lowered = run::outcomes(&PredictionInputs { demands: &demands, ..*inputs }, benches, told)?;
        proposal.holds = are_kept(inputs, &lowered);
        if proposal.holds {
            break;
        }
        proposal.sines.iter_mut().filter(|sine| is_lowered(sine)).for_each(|sine| sine.safe_nm *= LOWERED);
    }
    Ok(Some(proposal))
}

/// For each frequency the amplitude that a bench may have, one rank above the lowest as long as the benches that stay below
/// at any frequency are few.
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

/// Whether every limit that amplitudes can keep is kept.
fn are_kept(inputs: &PredictionInputs<'_>, outcomes: &[Outcome]) -> bool {
    let of_amplitude = Quantity::of_plan(inputs.plan).iter().filter(|of| **of != Quantity::TimeAtResonance);
    of_amplitude.filter_map(|of| Some((*of, of.limit(&inputs.limits)?))).all(|(of, limit)| {
        let reached = outcomes.iter().filter(|outcome| reaches(outcome.values[of as usize], limit)).count();
        Proportion::new(reached, outcomes.len()).estimate <= ALLOWED
    })
}
