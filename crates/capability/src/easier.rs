//! What would make a test possible: the least change of each kind.

use serde::Serialize;

use crate::answer::{self, can};
use crate::change::{Change, kinds};
use crate::error::CapabilityError;
use crate::outcome::CanInputs;
use crate::verdict::{Answer, Verdict};

/// Benches drawn for each trial, and for the verdict of a change that was found, at most.
const SAMPLES: (usize, usize) = (24, 100);
/// Steps in which the range of a change is looked at first, and parts of such a step.
const STEPS: u32 = 4;
const PARTS: u32 = 32;
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
    let share = |part: u32| f64::from(part) / f64::from(STEPS * PARTS);
    let is_yes = |part: u32| is_yes(inputs, kind(share(part)));
    let mut enough = None;
    for step in 1..=STEPS {
        if is_yes(step * PARTS)? {
            enough = Some(step * PARTS);
            break;
        }
    }
    let Some(enough) = enough else { return Ok(None) };
    // No answer is a yes where the nominal bench fails, which takes one run to see.
    let of_nominal = first(enough - PARTS, enough, |part| nominal_keeps(inputs, kind(share(part))))?;
    let least =
        if of_nominal == enough || is_yes(of_nominal)? { of_nominal } else { first(of_nominal, enough, is_yes)? };
    confirmed(inputs, kind, share(least))
}

/// The first part at which something is so, by halving: it is not so at `low`, and it is at `high`.
fn first(
    mut low: u32,
    mut high: u32,
    is_so: impl Fn(u32) -> Result<bool, CapabilityError>,
) -> Result<u32, CapabilityError> {
    while high - low > 1 {
        let middle = low.midpoint(high);
        if is_so(middle)? { high = middle } else { low = middle }
    }
    Ok(high)
}

/// A change that a few benches call enough, made larger until more of them do.
fn confirmed(
    inputs: &CanInputs<'_>,
    kind: &dyn Fn(f64) -> Change,
    mut share: f64,
) -> Result<Option<Easier>, CapabilityError> {
    let mut larger = ENLARGED;
    loop {
        let change = kind(share);
        let all = CanInputs { samples: SAMPLES.1.min(inputs.samples), ..*inputs };
        let verdict = change.with(&all, |changed| can(changed, &|_, _| {}))?;
        if verdict.answer == Answer::Yes {
            return Ok(Some(Easier { change, verdict }));
        }
        if share >= 1.0 {
            return Ok(None);
        }
        share = (share + larger).min(1.0);
        larger *= 2.0;
    }
}

/// Whether the nominal bench keeps everything.
fn nominal_keeps(inputs: &CanInputs<'_>, change: Change) -> Result<bool, CapabilityError> {
    Ok(change.keeps_margins(inputs) && change.with(inputs, answer::nominal_keeps)?)
}

/// Whether a few benches call it a yes.
fn is_yes(inputs: &CanInputs<'_>, change: Change) -> Result<bool, CapabilityError> {
    if !change.keeps_margins(inputs) {
        return Ok(false);
    }
    let few = CanInputs { samples: SAMPLES.0.min(inputs.samples), ..*inputs };
    change.with(&few, answer::is_yes)
}
