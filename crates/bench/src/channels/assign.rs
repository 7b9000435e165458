//! Scores every channel for every role, and gives each role its channel.
//!
//! A score is a sum of evidence on a logarithmic scale: a clear word in the name weighs 3 to 5, a hint in the samples 1
//! or 2, and a word that speaks against a role more than any word for it.

use std::collections::BTreeSet;

use recording::Recording;

use super::evidence::{Samples, best_delay};
use super::words::{self, Found};
use super::{Ambiguity, Choice, Guess, Meaning, Reason};
use crate::role::{Quantity, Role};
use crate::units::{self, Unit, UnitError};

/// A channel needs this much evidence to be proposed.
const THRESHOLD: f64 = 1.0;
/// Channels closer than this to the chosen one make a role ambiguous.
const MARGIN: f64 = 1.0;
/// Above this share of noise-free samples a channel is a demand.
const NOISE_FREE_SHARE: f64 = 0.6;
/// Weight of a word that is only in the comment.
const COMMENT_WEIGHT: f64 = 0.5;
/// Relative difference above which the means of two speeds disagree.
const MEAN_TOLERANCE: f64 = 0.02;
/// Most torque channels compared with the demand.
const MOST_COMPARED: usize = 16;

/// A channel with what is known about it from all recordings.
struct Candidate<'r> {
    name: &'r str,
    recorded_unit: &'r str,
    quantity: Quantity,
    override_unit: Option<Unit>,
    unit_reason: Reason,
    words: Vec<(Found, bool)>,
    samples: Vec<(usize, Samples<'r>)>,
    noise_free_share: f64,
    hints: Vec<(Role, f64, Reason)>,
}

impl Candidate<'_> {
    fn says(&self, meaning: Meaning) -> bool {
        self.words.iter().any(|(found, _)| found.meaning == meaning)
    }

    fn samples_in(&self, recording: usize) -> Option<Samples<'_>> {
        self.samples.iter().find(|(index, _)| *index == recording).map(|(_, samples)| *samples)
    }

    /// Whether the samples are those of a demand; `None` without samples.
    fn is_noise_free(&self) -> Option<bool> {
        (!self.samples.is_empty()).then_some(self.noise_free_share > NOISE_FREE_SHARE)
    }
}

pub(super) fn guess(recordings: &[(&str, &Recording)]) -> Guess {
    let mut candidates = candidates(recordings);
    compare_speeds(&mut candidates);
    compare_torques(&mut candidates);
    let scores = Scores::of(&candidates);
    let chosen = scores.assign();
    let mut guess = Guess::default();
    for role in Role::ALL {
        let Some(&(_, index)) = chosen.iter().find(|(assigned, _)| *assigned == role) else {
            guess.missing.push(role);
            continue;
        };
        guess.choices.insert(role, choice(&candidates[index], role, &scores, index));
        let rivals = scores.rivals(role, index);
        if rivals.len() > 1 {
            let channels = rivals.into_iter().map(|rival| candidates[rival].name.to_owned()).collect();
            guess.ambiguous.push(Ambiguity { role, channels });
        }
    }
    compare_means(&mut guess, &candidates);
    guess
}

fn candidates<'r>(recordings: &[(&str, &'r Recording)]) -> Vec<Candidate<'r>> {
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
        hints: Vec::new(),
    })
}

/// What a channel measures, the unit to write where the recording's own is of no use, and the reason.
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

/// Of two measured speeds, the engine's fluctuates more: its inertia is smaller and firing acts on it.
fn compare_speeds(candidates: &mut [Candidate<'_>]) {
    let is_measured = |c: &Candidate<'_>| {
        c.quantity == Quantity::AngularSpeed && c.is_noise_free() == Some(false) && !c.says(Meaning::Demand)
    };
    let speeds: Vec<usize> = (0..candidates.len()).filter(|&i| is_measured(&candidates[i])).collect();
    let Some(recording) = common_recording(candidates, &speeds) else { return };
    let fluctuation = |&i: &usize| Some((i, candidates[i].samples_in(recording)?.fluctuation()?));
    let mut ranked: Vec<(usize, f64)> = speeds.iter().filter_map(fluctuation).collect();
    ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
    let [(calmest, _), .., (liveliest, _)] = ranked[..] else { return };
    let hint = |role, other: usize| {
        (role, 1.0, Reason::Fluctuates { more: role == Role::EngineSpeed, than: candidates[other].name.to_owned() })
    };
    let (engine, dyno) = (hint(Role::EngineSpeed, calmest), hint(Role::DynoSpeed, liveliest));
    candidates[liveliest].hints.push(engine);
    candidates[calmest].hints.push(dyno);
}

/// The first recording that holds the most of these channels.
fn common_recording(candidates: &[Candidate<'_>], of: &[usize]) -> Option<usize> {
    let recordings: BTreeSet<usize> =
        of.iter().flat_map(|&i| candidates[i].samples.iter().map(|(recording, _)| *recording)).collect();
    let count = |recording: usize| of.iter().filter(|&&i| candidates[i].samples_in(recording).is_some()).count();
    recordings.into_iter().max_by_key(|&recording| (count(recording), std::cmp::Reverse(recording)))
}

/// Torques in the order in which they follow the demand: air gap, load cell, the system's late shaft torque.
fn compare_torques(candidates: &mut [Candidate<'_>]) {
    let Some((demand, recording)) = torque_demand(candidates) else { return };
    let is_compared = |i: &usize| *i != demand && candidates[*i].quantity == Quantity::Torque;
    let torques: Vec<usize> = (0..candidates.len()).filter(is_compared).take(MOST_COMPARED).collect();
    let Some(demand_samples) = candidates[demand].samples_in(recording) else { return };
    let follow = |&i: &usize| Some((i, best_delay(demand_samples, candidates[i].samples_in(recording)?)?));
    let mut ranked: Vec<(usize, (f64, f64))> = torques.iter().filter_map(follow).collect();
    ranked.retain(|(_, (_, correlation))| *correlation > 0.5);
    ranked.sort_by(|a, b| a.1.0.total_cmp(&b.1.0).then(b.1.1.total_cmp(&a.1.1)));
    let demand_name = candidates[demand].name.to_owned();
    let last = ranked.len().saturating_sub(1);
    for (rank, (index, (delay_s, correlation))) in ranked.into_iter().enumerate() {
        let role = match rank {
            0 => Role::AirGapTorque,
            rank if rank == last && last > 1 => Role::SystemShaftTorque,
            1 => Role::LoadCellTorque,
            _ => continue,
        };
        let reason = Reason::FollowsDemand { demand: demand_name.clone(), correlation, delay_s };
        candidates[index].hints.push((role, 2.0, reason));
    }
}

/// The channel that is most likely the torque demand, and the recording in which it is held best.
fn torque_demand(candidates: &[Candidate<'_>]) -> Option<(usize, usize)> {
    let scored = (0..candidates.len()).filter_map(|i| Some((i, score(&candidates[i], Role::DynoTorqueDemand)?)));
    let (demand, _) = scored.filter(|(_, score)| *score >= THRESHOLD).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let shares = candidates[demand].samples.iter().map(|(recording, samples)| (recording, samples.noise_free_share()));
    let (recording, _) = shares.filter(|(_, share)| *share < 1.0).max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((demand, *recording))
}

/// Evidence for a role, or `None` if the channel cannot play it at all.
fn score(candidate: &Candidate<'_>, role: Role) -> Option<f64> {
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
    let base = if role.quantity() == Quantity::AngularSpeed { 1.0 } else { 0.0 };
    Some(base + said + shown + hints)
}

/// What a word says for or against a role.
fn weight(role: Role, meaning: Meaning, candidate: &Candidate<'_>) -> f64 {
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
struct Scores(Vec<(Role, usize, f64)>);

impl Scores {
    fn of(candidates: &[Candidate<'_>]) -> Self {
        let mut scores: Vec<(Role, usize, f64)> = Vec::new();
        for (index, candidate) in candidates.iter().enumerate() {
            scores.extend(Role::ALL.iter().filter_map(|&role| Some((role, index, score(candidate, role)?))));
        }
        scores.sort_by(|a, b| b.2.total_cmp(&a.2));
        Scores(scores)
    }

    /// The best pairs, each role and each channel once.
    fn assign(&self) -> Vec<(Role, usize)> {
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
    fn rivals(&self, role: Role, index: usize) -> Vec<usize> {
        let enough = (self.of_pair(role, index) - MARGIN).max(THRESHOLD);
        let close = self.for_role(role).filter(|(other, score)| *other == index || *score >= enough);
        close.map(|(other, _)| other).collect()
    }

    /// Share of the evidence for a role that speaks for one channel.
    fn confidence(&self, role: Role, index: usize) -> f64 {
        let all: f64 = self.for_role(role).map(|(_, score)| score.exp()).sum();
        self.of_pair(role, index).exp() / (all + THRESHOLD.exp())
    }
}

fn choice(candidate: &Candidate<'_>, role: Role, scores: &Scores, index: usize) -> Choice {
    let mut reasons: Vec<Reason> = Vec::new();
    for (found, in_comment) in &candidate.words {
        let is_quantity = matches!(found.meaning, Meaning::Speed | Meaning::Torque);
        if is_quantity || weight(role, found.meaning, candidate) > 0.0 {
            let (word, meaning) = (found.word.clone(), found.meaning);
            reasons.push(Reason::Word { word, meaning, in_comment: *in_comment });
        }
    }
    reasons.push(candidate.unit_reason.clone());
    match candidate.is_noise_free() {
        Some(true) if role.is_demand() => reasons.push(Reason::NoiseFree { share: candidate.noise_free_share }),
        Some(false) if !role.is_demand() => reasons.push(Reason::Noisy),
        _ => {}
    }
    reasons.extend(candidate.hints.iter().filter(|hint| hint.0 == role).map(|hint| hint.2.clone()));
    Choice {
        channel: candidate.name.to_owned(),
        recorded_unit: candidate.recorded_unit.to_owned(),
        unit: candidate.override_unit,
        confidence: scores.confidence(role, index),
        reasons,
    }
}

/// Compares the means of the speeds chosen, which turn equally fast when the shaft is on.
fn compare_means(guess: &mut Guess, candidates: &[Candidate<'_>]) {
    for (role, with) in [(Role::EngineSpeed, Role::DynoSpeed), (Role::DynoSpeedDemand, Role::DynoSpeed)] {
        let Some(other) = guess.choices.get(&with).map(|choice| choice.channel.clone()) else { continue };
        let Some(choice) = guess.choices.get_mut(&role) else { continue };
        let Some(relative) = mean_difference(candidates, &choice.channel, &other) else { continue };
        if relative <= MEAN_TOLERANCE {
            choice.reasons.push(Reason::MeanAgrees { with: other });
        } else {
            choice.reasons.push(Reason::MeanDisagrees { with: other, relative });
            choice.confidence *= 0.5;
        }
    }
}

/// Relative difference of two channels' means in SI, in the first recording that holds both.
fn mean_difference(candidates: &[Candidate<'_>], name: &str, other: &str) -> Option<f64> {
    let find = |wanted: &str| candidates.iter().find(|candidate| candidate.name == wanted);
    let (candidate, other) = (find(name)?, find(other)?);
    let factor =
        |c: &Candidate<'_>| c.override_unit.or_else(|| units::parse_unit(c.recorded_unit).ok()).map(|u| u.factor);
    let (recording, samples) = candidate.samples.iter().find(|(index, _)| other.samples_in(*index).is_some())?;
    let mean = samples.mean()? * factor(candidate)?;
    let other_mean = other.samples_in(*recording)?.mean()? * factor(other)?;
    (other_mean.abs() > 0.0).then(|| (mean - other_mean).abs() / other_mean.abs())
}
