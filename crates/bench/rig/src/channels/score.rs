//! How much speaks for a channel in a role.
//!
//! A score is a sum of evidence on a logarithmic scale: a clear word in the name weighs 3 to 5, a hint in the samples 1
//! or 2, and a word that speaks against a role more than any word for it.

use units::Quantity;

use super::candidate::Candidate;
use crate::channels::guess::{Meaning, Reason};
use crate::role::Role;

/// A channel needs this much evidence to be proposed.
pub(super) const THRESHOLD: f64 = 1.0;
/// Channels closer than this to the chosen one make a role ambiguous.
const MARGIN: f64 = 1.5;
/// Weight of a word that is only in the comment.
const COMMENT_WEIGHT: f64 = 0.5;
/// Evidence of values that no bench reaches: against any word, but not against a word and a unit that are beyond doubt.
const IMPOSSIBLE: f64 = -4.0;

/// Evidence for a role, or `None` if the channel cannot play it at all.
pub(super) fn score(candidate: &Candidate<'_>, role: Role) -> Option<f64> {
    if candidate.quantity != role.quantity() || candidate.says(Meaning::Other) {
        return None;
    }
    if role == Role::Throttle && !candidate.says(Meaning::Throttle) {
        return None;
    }
    let said: f64 = candidate
        .words
        .iter()
        .map(|(found, in_comment)| {
            let weight = weight(role, found.meaning, candidate);
            if *in_comment { COMMENT_WEIGHT * weight } else { weight }
        })
        .sum();
    let shown = match (role.is_demand(), candidate.is_noise_free()) {
        (true, Some(true)) if candidate.says(Meaning::Demand) => 2.0,
        (true, Some(true)) => 1.0,
        (true, Some(false)) if role == Role::DynoSpeedDemand => -3.0,
        (false, Some(true)) => -2.0,
        _ => 0.0,
    };
    let hints: f64 = candidate.hints.iter().filter(|hint| hint.0 == role).map(|hint| hint.1).sum();
    let possible = if matches!(candidate.range_reason(), Some(Reason::OutOfRange { .. })) { IMPOSSIBLE } else { 0.0 };
    let base = if role.quantity() == Quantity::AngularSpeed { 1.0 } else { 0.0 };
    Some(base + said + shown + hints + possible)
}

/// Weight of a word for a role, negative against it.
pub(super) fn weight(role: Role, meaning: Meaning, candidate: &Candidate<'_>) -> f64 {
    let dyno = candidate.says(Meaning::Dynamometer);
    let on_shaft = candidate.says(Meaning::Shaft) || candidate.says(Meaning::Flange);
    match (role, meaning) {
        (Role::DynoSpeed, Meaning::Dynamometer) => 3.0,
        (Role::EngineSpeed, Meaning::Dynamometer) => -7.0,
        (Role::EngineSpeed, Meaning::Engine) if !dyno => 3.0,
        (Role::DynoSpeed | Role::DynoSpeedDemand, Meaning::Engine) if !dyno => -7.0,
        (Role::DynoSpeedDemand, Meaning::Demand) => 3.0,
        (Role::DynoSpeedDemand, Meaning::Dynamometer) => 2.0,
        (Role::DynoSpeed | Role::EngineSpeed, Meaning::Measured) => 0.5,
        (Role::DynoTorqueDemand, Meaning::Demand) => 4.0,
        (Role::DynoTorqueDemand, Meaning::Measured | Meaning::LoadCell) => -4.0,
        (_, Meaning::Demand) => -5.0,
        (Role::FlangeTorque | Role::SystemShaftTorque, Meaning::Engine) => 0.0,
        (_, Meaning::Engine) if role.quantity() == Quantity::Torque && !dyno && !on_shaft => -7.0,
        (Role::AirGapTorque, _) => air_gap_weight(meaning, candidate),
        (Role::LoadCellTorque, _) => load_cell_weight(meaning),
        (Role::SystemShaftTorque, _) => shaft_weight(meaning),
        (Role::FlangeTorque, _) => flange_weight(meaning, candidate),
        (Role::DynoTorqueDemand, Meaning::Shaft | Meaning::Flange) => -4.0,
        (Role::DynoTorqueDemand, Meaning::Dynamometer) => 1.0,
        (Role::Throttle, Meaning::Throttle) => 3.0,
        _ => 0.0,
    }
}

fn air_gap_weight(meaning: Meaning, candidate: &Candidate<'_>) -> f64 {
    match meaning {
        Meaning::AirGap => 4.0,
        Meaning::Calculated => 2.0,
        Meaning::Dynamometer => 1.0,
        Meaning::Measured if !candidate.says(Meaning::AirGap) => -2.0,
        Meaning::LoadCell | Meaning::Shaft | Meaning::Flange => -5.0,
        _ => 0.0,
    }
}

fn load_cell_weight(meaning: Meaning) -> f64 {
    match meaning {
        Meaning::LoadCell => 4.0,
        Meaning::Measured => 2.0,
        Meaning::Dynamometer => 1.0,
        Meaning::Calculated => -3.0,
        Meaning::AirGap | Meaning::Shaft | Meaning::Flange => -5.0,
        _ => 0.0,
    }
}

fn shaft_weight(meaning: Meaning) -> f64 {
    match meaning {
        Meaning::Shaft => 4.0,
        Meaning::Calculated => 1.0,
        Meaning::Measured => -1.0,
        Meaning::Flange | Meaning::AirGap | Meaning::LoadCell => -5.0,
        _ => 0.0,
    }
}

fn flange_weight(meaning: Meaning, candidate: &Candidate<'_>) -> f64 {
    match meaning {
        Meaning::Flange => 5.0,
        Meaning::Shaft => 1.0,
        Meaning::Measured if candidate.says(Meaning::Shaft) => 3.0,
        Meaning::Calculated => -4.0,
        Meaning::AirGap | Meaning::LoadCell => -5.0,
        _ => 0.0,
    }
}

/// Every channel's score for every role.
pub(super) struct Scores(Vec<(Role, usize, f64)>);

impl Scores {
    pub(super) fn of(candidates: &[Candidate<'_>]) -> Self {
        let mut scores: Vec<(Role, usize, f64)> = Vec::new();
        for (index, candidate) in candidates.iter().enumerate() {
            scores.extend(Role::ALL.iter().filter_map(|&role| Some((role, index, score(candidate, role)?))));
        }
        scores.sort_by(|a, b| b.2.total_cmp(&a.2));
        Scores(scores)
    }

    /// The best pairs, each role and each channel once.
    pub(super) fn assign(&self) -> Vec<(Role, usize)> {
        let mut chosen: Vec<(Role, usize)> = Vec::new();
        for &(role, index, score) in &self.0 {
            let is_free = chosen.iter().all(|(other, taken)| *other != role && *taken != index);
            if is_free && score >= THRESHOLD {
                chosen.push((role, index));
            }
        }
        chosen
    }

    fn for_role(&self, role: Role) -> impl Iterator<Item = (usize, f64)> {
        self.0.iter().filter(move |entry| entry.0 == role).map(|entry| (entry.1, entry.2))
    }

    fn of_pair(&self, role: Role, index: usize) -> f64 {
        self.for_role(role).find(|(other, _)| *other == index).map_or(f64::NEG_INFINITY, |(_, score)| score)
    }

    /// The chosen channel and those about as good, best first.
    pub(super) fn rivals(&self, role: Role, index: usize) -> Vec<usize> {
        let enough = (self.of_pair(role, index) - MARGIN).max(THRESHOLD);
        let close = self.for_role(role).filter(|(other, score)| *other == index || *score >= enough);
        close.map(|(other, _)| other).collect()
    }

    /// Share of the evidence for a role that speaks for one channel.
    pub(super) fn confidence(&self, role: Role, index: usize) -> f64 {
        let all: f64 = self.for_role(role).map(|(_, score)| score.exp()).sum();
        self.of_pair(role, index).exp() / (all + THRESHOLD.exp())
    }
}
