//! What would make a test possible: the least change of each kind.

use bench_model::prediction::PredictionError;
use serde::Serialize;

use crate::answer::{can, nominal_keeps};
use crate::change::{Change, kinds};
use crate::error::CapabilityError;
use crate::outcome::CanInputs;
use crate::verdict::{Answer, Verdict};

/// Benches drawn for each trial, and for the verdict of a change that was found, at most.
const SAMPLES: (usize, usize) = (24, 100);
/// Halvings of the range of a change.
const HALVINGS: usize = 5;
/// How much larger, as a share of the largest, a change is made first which a few benches called enough and more do not; then twice as
/// much again and again.
const ENLARGED: f64 = 0.02;

/// A change with the answer it gives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Easier {
    /// The change.
    pub change: Change,
    /// What the test then gets.
    pub verdict: Verdict,
}

/// The least change of each kind with which the answer is yes; a kind that never gives one is left out. `progress` hears how many kinds
/// of how many were tried.
///
/// # Errors
/// As [`can`].
pub fn easier(inputs: &CanInputs<'_>, progress: &(dyn Fn(u64, u64) + Sync)) -> Result<Vec<Easier>, CapabilityError> {
    let kinds = kinds(inputs);
    let mut found = Vec::new();
    for (kind, done) in kinds.iter().zip(0_u64..) {
        progress(done, kinds.len() as u64);
        found.extend(least(inputs, kind)?);
    }
    Ok(found)
}

/// The least change of a kind, between none and the largest.
fn least(inputs: &CanInputs<'_>, kind: &dyn Fn(f64) -> Change) -> Result<Option<Easier>, CapabilityError> {
    let is_yes = |share: f64| is_yes(inputs, kind(share));
    let coarse = [0.25, 0.5, 0.75, 1.0];
    let mut high = None;
    for share in coarse {
        if is_yes(share)? {
            high = Some(share);
            break;
        }
    }
    let Some(mut high) = high else { return Ok(None) };
    let mut low = high - coarse[0];
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if is_yes(middle)? { high = middle } else { low = middle }
    }
    let mut larger = ENLARGED;
    loop {
        let change = kind(high);
        let all = CanInputs { samples: SAMPLES.1.min(inputs.samples), ..*inputs };
        let verdict = change.with(&all, |changed| can(changed, &|_, _| {}))?;
        if verdict.answer == Answer::Yes {
            return Ok(Some(Easier { change, verdict }));
        }
        if high >= 1.0 {
            return Ok(None);
        }
        high = (high + larger).min(1.0);
        larger *= 2.0;
    }
}

/// Whether a few benches call it a yes; most that do not are known by the nominal one.
fn is_yes(inputs: &CanInputs<'_>, change: Change) -> Result<bool, CapabilityError> {
    if !change.keeps_margins(inputs) {
        return Ok(false);
    }
    let few = CanInputs { samples: SAMPLES.0.min(inputs.samples), ..*inputs };
    change.with(&few, |changed| {
        if !nominal_keeps(changed)? {
            return Ok(false);
        }
        match can(changed, &|_, _| {}) {
            Err(CapabilityError::Prediction(PredictionError::Unstable)) => Ok(false),
            other => Ok(other?.answer == Answer::Yes),
        }
    })
}
