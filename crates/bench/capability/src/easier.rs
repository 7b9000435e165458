//! Changes that would make a test possible: the least one of each kind.

use std::collections::BTreeMap;

use numerics::parallel;
use serde::{Deserialize, Serialize};
use signal::proportion::Proportion;
use work::Context;

use crate::answer::{Trial, nominal_keeps};
use crate::change::{Change, Kind, kinds};
use crate::error::CapabilityError;
use crate::outcome::CanInputs;
use crate::verdict::{is_share_of_yes, most_misses};

/// Benches that a change is looked for with, at most.
const FIRST_SAMPLES: usize = 24;
/// Benches that confirm the one that was found, at most.
const CONFIRMING_SAMPLES: usize = 100;
/// Steps in which the range of a change is looked at first, and parts of such a step.
const STEPS: u32 = 4;
const PARTS: u32 = 32;
/// The largest change.
const LARGEST: u32 = STEPS * PARTS;
/// By how many parts a change is made larger first which a few benches call enough and more do not; then twice as much
/// again and again.
const ENLARGED: u32 = 3;
/// Benches between which nobody looks whether too many have missed something already; no answer depends on the number
/// of threads.
const AT_ONCE: usize = 8;

/// A change with which the answer is yes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Easier {
    /// The change.
    pub change: Change,
    /// How many benches then keep everything.
    pub kept: Proportion,
}

/// The least change of each kind with which the answer is yes; a kind that never gives one is left out. Each kind is a
/// part of a step of the work.
///
/// # Errors
/// As [`crate::can`].
pub fn easier(inputs: &CanInputs<'_>, context: &Context) -> Result<Vec<Easier>, CapabilityError> {
    let least = |kind: &Kind| Search::of(inputs, kind).least();
    let found = parallel::map_as_step(context, "looking for what would make it possible", &kinds(inputs), least);
    Ok(found.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// The search for the least change of a kind.
struct Search<'a> {
    inputs: CanInputs<'a>,
    kind: &'a Kind,
    /// Which benches keep everything with so many parts of the largest change, as far as they were run.
    tried: BTreeMap<u32, Vec<Option<bool>>>,
    /// Benches that missed something, the last one first: they decide soonest.
    hard: Vec<usize>,
}

impl<'a> Search<'a> {
    fn of(inputs: &CanInputs<'a>, kind: &'a Kind) -> Self {
        let inputs = CanInputs { samples: CONFIRMING_SAMPLES.min(inputs.samples), ..*inputs };
        Search { inputs, kind, tried: BTreeMap::new(), hard: Vec::new() }
    }

    fn change(&self, part: u32) -> Change {
        (self.kind)(f64::from(part) / f64::from(LARGEST))
    }

    /// The nominal bench shows in one run where to look; then a few benches, and at last all of them.
    fn least(mut self) -> Result<Option<Easier>, CapabilityError> {
        let Some(of_nominal) = self.of_nominal()? else { return Ok(None) };
        let Some(mut part) = self.of_few(of_nominal)? else { return Ok(None) };
        let mut larger = ENLARGED;
        loop {
            if let Some(kept) = self.kept(part, self.inputs.samples)? {
                let kept = Proportion::new(kept, self.inputs.samples);
                return Ok(Some(Easier { change: self.change(part), kept }));
            }
            if part == LARGEST {
                return Ok(None);
            }
            part = (part + larger).min(LARGEST);
            larger *= 2;
        }
    }

    /// The least change with which the nominal bench keeps everything.
    fn of_nominal(&self) -> Result<Option<u32>, CapabilityError> {
        let keeps = |part: u32| {
            let change = self.change(part);
            Ok(change.keeps_margins(&self.inputs) && change.with(&self.inputs, nominal_keeps)?)
        };
        for step in 1..=STEPS {
            if keeps(step * PARTS)? {
                return first((step - 1) * PARTS, step * PARTS, keeps).map(Some);
            }
        }
        Ok(None)
    }

    /// The least change from there on with which a few benches call it a yes: larger ones, each twice as far away,
    /// until one does.
    fn of_few(&mut self, from: u32) -> Result<Option<u32>, CapabilityError> {
        let few = FIRST_SAMPLES.min(self.inputs.samples);
        let (mut no, mut further) = (from - 1, 0);
        loop {
            let part = (from + further).min(LARGEST);
            if self.kept(part, few)?.is_some() {
                return first(no, part, |part| Ok(self.kept(part, few)?.is_some())).map(Some);
            }
            if part == LARGEST {
                return Ok(None);
            }
            (no, further) = (part, (2 * further).max(1));
        }
    }

    /// How many of the first benches keep everything; `None` if these are too few for a yes, which shows before all
    /// have run.
    fn kept(&mut self, part: u32, of: usize) -> Result<Option<usize>, CapabilityError> {
        let change = self.change(part);
        if !change.keeps_margins(&self.inputs) {
            return Ok(None);
        }
        let known = self.tried.entry(part).or_insert_with(|| vec![None; self.inputs.samples]);
        let hard = &mut self.hard;
        let mut order: Vec<usize> = hard.iter().copied().filter(|place| *place < of).collect();
        order.extend((0..of).filter(|place| !hard.contains(place)));
        order.retain(|place| known[*place].is_none());
        let misses = |known: &[Option<bool>]| known[..of].iter().filter(|keeps| **keeps == Some(false)).count();
        if misses(known) <= most_misses(of) && !order.is_empty() {
            change.with(&self.inputs, |changed| {
                let trial = Trial::of(changed)?;
                for places in order.chunks(AT_ONCE) {
                    for (place, keeps) in places.iter().zip(trial.keep(places)?) {
                        known[*place] = Some(keeps);
                        if !keeps {
                            hard.retain(|one| one != place);
                            hard.insert(0, *place);
                        }
                    }
                    if misses(known) > most_misses(of) {
                        break;
                    }
                }
                Ok::<(), CapabilityError>(())
            })?;
        }
        let kept = of - misses(known);
        Ok(is_share_of_yes(kept, of).then_some(kept))
    }
}

/// The first part at which something is so, by halving: it is not so at `low`, and it is at `high`.
fn first(
    mut low: u32,
    mut high: u32,
    mut is_so: impl FnMut(u32) -> Result<bool, CapabilityError>,
) -> Result<u32, CapabilityError> {
    while high - low > 1 {
        let middle = low.midpoint(high);
        if is_so(middle)? { high = middle } else { low = middle }
    }
    Ok(high)
}
