//! Gives each role its channel.

use recording::Recording;

use super::candidate::{Candidate, candidates};
use super::compare::{compare_means, compare_speeds, compare_torques};
use super::score::{Scores, weight};
use crate::channels::guess::{Ambiguity, Choice, Guess, Meaning, Reason};
use crate::role::Role;

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
    reasons.extend(candidate.range_reason());
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
