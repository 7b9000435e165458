//! Evidence of channels on one another: speeds that should agree, torques that follow the demand.

use std::collections::BTreeSet;

use units::Quantity;

use super::candidate::Candidate;
use super::evidence::best_delay;
use super::score::{THRESHOLD, score};
use crate::channels::guess::{Guess, Meaning, Reason};
use crate::role::Role;

/// Relative difference above which the means of two speeds disagree.
const MEAN_TOLERANCE: f64 = 0.02;
/// Relative difference of sample times above which one channel is recorded faster than another.
const RASTER_TOLERANCE: f64 = 0.1;
/// Most torque channels compared with the demand.
const MOST_COMPARED: usize = 16;

/// Of two measured speeds, the engine's fluctuates more: its inertia is smaller and firing acts on it.
pub(super) fn compare_speeds(candidates: &mut [Candidate<'_>]) {
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
    compare_rasters(candidates, recording, &ranked.iter().map(|(i, _)| *i).collect::<Vec<_>>());
    candidates[liveliest].hints.push(engine);
    candidates[calmest].hints.push(dyno);
}

/// Of two measured speeds, the dynamometer's is recorded faster: its controller needs it.
fn compare_rasters(candidates: &mut [Candidate<'_>], recording: usize, speeds: &[usize]) {
    let sample_time = |&i: &usize| Some((i, candidates[i].samples_in(recording)?.sample_time_s()?));
    let mut ranked: Vec<(usize, f64)> = speeds.iter().filter_map(sample_time).collect();
    ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
    let [(fastest, fast_s), .., (slowest, slow_s)] = ranked[..] else { return };
    if slow_s <= (1.0 + RASTER_TOLERANCE) * fast_s {
        return;
    }
    for (index, other, role) in [(fastest, slowest, Role::DynoSpeed), (slowest, fastest, Role::EngineSpeed)] {
        let reason = Reason::Sampled { faster: role == Role::DynoSpeed, than: candidates[other].name.to_owned() };
        candidates[index].hints.push((role, 0.5, reason));
    }
}

/// The first recording that holds the most of these channels.
fn common_recording(candidates: &[Candidate<'_>], of: &[usize]) -> Option<usize> {
    let recordings: BTreeSet<usize> =
        of.iter().flat_map(|&i| candidates[i].samples.iter().map(|(recording, _)| *recording)).collect();
    let count = |recording: usize| of.iter().filter(|&&i| candidates[i].samples_in(recording).is_some()).count();
    recordings.into_iter().max_by_key(|&recording| (count(recording), std::cmp::Reverse(recording)))
}

/// Torques in the order in which they follow the demand: air gap, load cell, the system's late shaft torque.
pub(super) fn compare_torques(candidates: &mut [Candidate<'_>]) {
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

/// Compares the means of the speeds chosen, which turn equally fast when the shaft is on.
pub(super) fn compare_means(guess: &mut Guess, candidates: &[Candidate<'_>]) {
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
    let (recording, samples) = candidate.samples.iter().find(|(index, _)| other.samples_in(*index).is_some())?;
    let mean = candidate.unit()?.to_si(samples.mean()?);
    let other_mean = other.unit()?.to_si(other.samples_in(*recording)?.mean()?);
    (other_mean.abs() > 0.0).then(|| (mean - other_mean).abs() / other_mean.abs())
}
