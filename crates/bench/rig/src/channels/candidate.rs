//! The channels of a campaign with what their names, units and samples say.

use recording::Recording;
use units::{self, Quantity, Unit, UnitError};

use super::evidence::Samples;
use super::words::{self, Found};
use crate::channels::guess::{Meaning, Reason};
use crate::role::Role;

/// Above this share of noise-free samples a channel is a demand.
const NOISE_FREE_SHARE: f64 = 0.6;

/// A channel with what is known about it from all recordings.
pub(super) struct Candidate<'r> {
    pub(super) name: &'r str,
    pub(super) recorded_unit: &'r str,
    pub(super) quantity: Quantity,
    pub(super) override_unit: Option<Unit>,
    pub(super) unit_reason: Reason,
    pub(super) words: Vec<(Found, bool)>,
    pub(super) samples: Vec<(usize, Samples<'r>)>,
    pub(super) noise_free_share: f64,
    range: Option<(f64, f64)>,
    pub(super) hints: Vec<(Role, f64, Reason)>,
}

impl Candidate<'_> {
    pub(super) fn says(&self, meaning: Meaning) -> bool {
        self.words.iter().any(|(found, _)| found.meaning == meaning)
    }

    pub(super) fn samples_in(&self, recording: usize) -> Option<Samples<'_>> {
        self.samples.iter().find(|(index, _)| *index == recording).map(|(_, samples)| *samples)
    }

    /// The unit recorded, or the one proposed in its stead.
    pub(super) fn unit(&self) -> Option<Unit> {
        self.override_unit.or_else(|| units::parse_unit(self.recorded_unit).ok())
    }

    /// Evidence that the range of the samples gives on the unit. `None` without samples, without a unit, or of a
    /// quantity that may have any value.
    pub(super) fn range_reason(&self) -> Option<Reason> {
        let (unit, (smallest, largest)) = (self.unit()?, self.range?);
        let magnitude = smallest.abs().max(largest.abs());
        Some(if unit.to_si(magnitude) <= self.quantity.largest_at_a_bench()? {
            Reason::InRange { range: (smallest, largest), unit: unit.spelling }
        } else {
            Reason::OutOfRange { largest: magnitude, unit: unit.spelling }
        })
    }

    /// Tells whether the samples are those of a demand; `None` without samples.
    pub(super) fn is_noise_free(&self) -> Option<bool> {
        (!self.samples.is_empty()).then_some(self.noise_free_share > NOISE_FREE_SHARE)
    }
}

pub(super) fn candidates<'r>(recordings: &[(&str, &'r Recording)]) -> Vec<Candidate<'r>> {
    let mut candidates: Vec<Candidate<'r>> = Vec::new();
    for (index, (_, recording)) in recordings.iter().enumerate() {
        for channel in &recording.channels {
            let samples = Samples::of(recording, channel).map(|samples| (index, samples));
            match candidates.iter_mut().find(|known| known.name == channel.name) {
                Some(known) if known.samples_in(index).is_none() => known.samples.extend(samples),
                Some(_) => {}
                None => candidates.extend(candidate(channel, samples)),
            }
        }
    }
    for candidate in &mut candidates {
        let shares = candidate.samples.iter().map(|(_, samples)| samples.noise_free_share());
        candidate.noise_free_share = shares.fold(0.0, f64::max);
        let ranges = candidate.samples.iter().filter_map(|(_, samples)| samples.range());
        candidate.range = ranges.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    }
    candidates
}

fn candidate<'r>(channel: &'r recording::Channel, samples: Option<(usize, Samples<'r>)>) -> Option<Candidate<'r>> {
    let mut words: Vec<(Found, bool)> = words::of_name(&channel.name).into_iter().map(|found| (found, false)).collect();
    for found in words::of_comment(&channel.comment) {
        if !words.iter().any(|(known, _)| known.meaning == found.meaning) {
            words.push((found, true));
        }
    }
    let (quantity, override_unit, unit_reason) = quantity_of(channel, &words, samples.map(|(_, samples)| samples))?;
    Some(Candidate {
        name: &channel.name,
        recorded_unit: &channel.unit,
        quantity,
        override_unit,
        unit_reason,
        words,
        samples: samples.into_iter().collect(),
        noise_free_share: 0.0,
        range: None,
        hints: Vec::new(),
    })
}

/// Returns the quantity of a channel, the unit to write where the recording's own is of no use, and the reason.
fn quantity_of(
    channel: &recording::Channel,
    words: &[(Found, bool)],
    samples: Option<Samples<'_>>,
) -> Option<(Quantity, Option<Unit>, Reason)> {
    let error = match units::parse_unit(&channel.unit) {
        Ok(unit) => {
            let reason = Reason::Unit { unit: channel.unit.clone(), quantity: unit.quantity };
            return Some((unit.quantity, None, reason));
        }
        Err(error) => error,
    };
    // A letter such as T may mean torque or temperature: with a unit that is unknown only a whole word will do.
    let shortest = if error == UnitError::Empty { 1 } else { 5 };
    let (found, quantity) = words.iter().find_map(|(found, _)| {
        let quantity = match found.meaning {
            Meaning::Speed => Quantity::AngularSpeed,
            Meaning::Torque => Quantity::Torque,
            Meaning::Throttle => Quantity::Ratio,
            _ => return None,
        };
        (found.word.len() >= shortest).then_some((found, quantity))
    })?;
    let unit = unit_by_magnitude(&channel.name, quantity, samples);
    let reason = match unit {
        Some(unit) => Reason::Magnitude { unit: unit.spelling },
        None => Reason::Word { word: found.word.clone(), meaning: found.meaning, in_comment: false },
    };
    Some((quantity, unit, reason))
}

/// The unit of a channel that states none: the one in its name, or the one its magnitude leaves no doubt about.
fn unit_by_magnitude(name: &str, quantity: Quantity, samples: Option<Samples<'_>>) -> Option<Unit> {
    let parts = name.split(['_', ' ', '[', ']', '(', ')', '\\']);
    let in_name = parts.filter(|part| part.len() > 1).find_map(|part| units::parse_unit_of(part, quantity).ok());
    let by_magnitude = || {
        let mean = samples?.mean()?.abs();
        let spelling = match quantity {
            Quantity::AngularSpeed if mean > 700.0 => "rpm",
            Quantity::Torque if (5.0..2000.0).contains(&mean) => "Nm",
            _ => return None,
        };
        units::parse_unit(spelling).ok()
    };
    in_name.or_else(by_magnitude)
}
