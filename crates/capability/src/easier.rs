//! What would make a test possible: the least change of its demand.

use cycle::Reference;
use rig::experiment::Demands;
use serde::Serialize;

use crate::answer::{Answer, CanInputs, Verdict, can};
use crate::demand::{CycleDemand, Demand};
use crate::error::CapabilityError;

/// Benches drawn for each trial.
const TRIAL_SAMPLES: usize = 24;
/// Halvings of the range of a change.
const HALVINGS: usize = 5;
/// A plan and a cycle are made slower by these factors at most.
const SLOWEST: (f64, f64) = (8.0, 2.0);
/// Changes of the demand are made smaller down to this part at least.
const SMALLEST: f64 = 0.05;

/// A change of the demand.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Change {
    /// The whole test takes this many times as long.
    Slower {
        /// Above 1.
        factor: f64,
    },
    /// What is demanded changes by this part of what it did, about its first value.
    Smaller {
        /// 0 … 1.
        factor: f64,
    },
}

/// A change with the answer it gives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Easier {
    /// The change.
    pub change: Change,
    /// What the test then gets, with all benches.
    pub verdict: Verdict,
}

/// The least change of each kind with which the answer is yes; a kind that never gives one is left out.
///
/// # Errors
/// As [`can`].
pub fn easier(inputs: &CanInputs<'_>, progress: &(dyn Fn(u64, u64) + Sync)) -> Result<Vec<Easier>, CapabilityError> {
    let mut found = Vec::new();
    let slowest = if matches!(inputs.demand, Demand::Plan(..)) { SLOWEST.0 } else { SLOWEST.1 };
    // 0 is no change, 1 the largest.
    let slower = |share: f64| Change::Slower { factor: slowest.powf(share) };
    let smaller = |share: f64| Change::Smaller { factor: 1.0 - share * (1.0 - SMALLEST) };
    let kinds: [&dyn Fn(f64) -> Change; 2] = [&slower, &smaller];
    for kind in kinds {
        let is_yes = |share: f64| -> Result<bool, CapabilityError> {
            let few = CanInputs { samples: TRIAL_SAMPLES.min(inputs.samples), ..*inputs };
            Ok(with(&few, kind(share), &|_, _| {})?.answer == Answer::Yes)
        };
        if !is_yes(1.0)? {
            continue;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if is_yes(middle)? { high = middle } else { low = middle }
        }
        found.push(Easier { change: kind(high), verdict: with(inputs, kind(high), progress)? });
    }
    Ok(found)
}

/// The answer to a changed demand.
fn with(
    inputs: &CanInputs<'_>,
    change: Change,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Result<Verdict, CapabilityError> {
    match inputs.demand {
        Demand::Cycle(cycle) => {
            let reference = changed_reference(cycle.reference, change);
            let demand = Demand::Cycle(CycleDemand { reference: &reference, ..cycle });
            can(&CanInputs { demand, ..*inputs }, progress)
        }
        Demand::Plan(plan, demands) => {
            let demands = changed_demands(demands, change);
            let mut plan = plan.clone();
            if let Change::Slower { factor } = change {
                plan.duration_s *= factor;
            }
            can(&CanInputs { demand: Demand::Plan(&plan, &demands), ..*inputs }, progress)
        }
    }
}

fn changed_reference(reference: &Reference, change: Change) -> Reference {
    let series = |values: &[f64]| changed(values, change);
    Reference {
        speed_rad_s: series(&reference.speed_rad_s),
        torque_nm: series(&reference.torque_nm),
        ..reference.clone()
    }
}

fn changed_demands(demands: &Demands, change: Change) -> Demands {
    let series = |values: &[f64]| changed(values, change);
    Demands {
        speed_rad_s: series(&demands.speed_rad_s),
        dyno_torque_nm: series(&demands.dyno_torque_nm),
        engine_torque_nm: series(&demands.engine_torque_nm),
        throttle: series(&demands.throttle),
        ignition_efficiency: series(&demands.ignition_efficiency),
    }
}

/// A series that is stretched, straight between its values, or that changes less about its first value.
fn changed(values: &[f64], change: Change) -> Vec<f64> {
    let (Some(first), last) = (values.first(), values.len().saturating_sub(1)) else { return Vec::new() };
    match change {
        Change::Smaller { factor } => values.iter().map(|value| first + factor * (value - first)).collect(),
        Change::Slower { factor } => {
            let count = (values.len() as f64 * factor).round() as usize;
            let at = |k: usize| {
                let place = (k as f64 / factor).min(last as f64);
                let (low, share) = (place.floor() as usize, place.fract());
                values[low] + share * (values[(low + 1).min(last)] - values[low])
            };
            (0..count).map(at).collect()
        }
    }
}
