//! The firing pulses of the engine, of all recordings with a shaft together: how strong each harmonic of the working cycle is, over mean torque
//! and speed, with its covariance.
//!
//! Where the recordings show nothing, the pulses are those of the class, see [`EnginePulses::prior`]. The mean
//! torque of the engine is T_d + (J_d + J_e) dω/dt: it lacks the friction of the dynamometer's bearings, whose size counts as its error.

mod fit;
mod windows;

use numerics::{order, parallel};
use part_shaft::Parts;
use part_shaft::shaft_inputs::stated_gate;
use part_torque::torque_smoother::{Prepared, needed};
use rig::engine_pulses::{EnginePulses, PulseHarmonic};
use rig::estimation::EstimateError;
use rig::prepare::believable;
use rig::results::Reason;
use rig::{Experiment, Role};
use signal::Signal;
use signal::distributions::normal_quantile;

use crate::source::{TwoMasses, Values};
use fit::{Joined, Recording};
use windows::{Record, Seen, firings_counted};

/// Harmonics up to this multiple of the firing order are looked for one by one, beyond it the multiples of the firing order alone.
const ONE_BY_ONE: usize = 2;
/// The largest variation from cycle to cycle that is believed.
const MOST_VARIATION: f64 = 0.2;
/// The most friction that a dynamometer's bearings have, over its torque limit: at rest, and for each rad/s. The mean torque of the engine is
/// known without it.
const MOST_FRICTION: (f64, f64) = (4e-3, 5e-5);

/// The pulses that the recordings show.
///
/// # Errors
/// No shaft, or no recording that shows the engine's pulses.
pub fn engine_pulses(parts: &Parts<'_>) -> Result<EnginePulses, Vec<Reason>> {
    let masses = TwoMasses::of(parts)?;
    let values = Values::of(&masses.values);
    let engine = parts.bench.engine();
    let cylinders = engine.cylinders as usize;
    let prior = EnginePulses::prior(engine, values.engine_inertia);
    let scales = fit::scales(&prior);
    let places: Vec<usize> = looked_for(cylinders, prior.harmonics.len()).collect();
    let orders: Vec<f64> = places.iter().map(|place| prior.harmonics[*place].order).collect();
    let all: Vec<&Experiment> = parts.experiments.iter().copied().filter(|e| !e.label.is_without_shaft()).collect();
    let looks = parallel::map(&all, |experiment| seen(experiment, parts, &values, &orders));
    let mut reasons = Vec::new();
    let mut seen: Vec<(Recording, Vec<Seen>)> = Vec::new();
    for (experiment, look) in all.iter().zip(looks) {
        match look {
            Ok(windows) => seen.push((Recording::of(&experiment.file, &windows, &places, &scales), windows)),
            Err(error) => reasons.push(Reason::from(error)),
        }
    }
    seen.sort_by(|(a, _), (b, _)| b.weight(cylinders).total_cmp(&a.weight(cylinders)));
    let (recordings, windows): (Vec<Recording>, Vec<Vec<Seen>>) = seen.into_iter().unzip();
    let windows: Vec<Seen> = windows.into_iter().flatten().collect();
    let joined = Joined::of(&recordings, cylinders);
    let mean = |of: fn(&Seen) -> f64| windows.iter().map(of).sum::<f64>() / windows.len().max(1) as f64;
    let at = (mean(|seen| seen.torque_nm), mean(|seen| seen.speed_rad_s));
    let most_nm = windows.iter().map(|seen| seen.torque_nm.abs()).fold(0.0, f64::max);
    let friction_nm = parts.bench.limits.torque_nm.unwrap_or(most_nm) * friction(at.1);
    let harmonics = joined.pulses(&prior, (&values, friction_nm), at);
    if !harmonics.get(cylinders - 1).is_some_and(|firing| firing.is_estimated) {
        return Err(reasons);
    }
    // Of the places looked for, those up to the firing order are the first.
    let cycle_variation =
        variation(&windows, cylinders - 1, &harmonics[cylinders - 1]).unwrap_or(prior.cycle_variation);
    Ok(EnginePulses { cycle_variation, recordings: joined.recordings, harmonics, ..prior })
}

/// Root mean square of a dynamometer's friction at a speed, over its torque limit. Nothing of it is known but that each part is below its most,
/// so it is as probable anywhere below.
fn friction(speed_rad_s: f64) -> f64 {
    let [dry, viscous] = [MOST_FRICTION.0, MOST_FRICTION.1 * speed_rad_s];
    ((dry * dry + viscous * viscous) / 3.0 + 0.5 * dry * viscous).sqrt()
}

/// Places of the harmonics that are looked for.
fn looked_for(cylinders: usize, count: usize) -> impl Iterator<Item = usize> {
    (0..count).filter(move |place| *place < ONE_BY_ONE * cylinders || (place + 1).is_multiple_of(cylinders))
}

/// What the windows of a recording show.
fn seen(
    experiment: &Experiment,
    parts: &Parts<'_>,
    values: &Values,
    orders: &[f64],
) -> Result<Vec<Seen>, EstimateError> {
    believable(experiment)?;
    let engine_speed = needed(experiment, Role::EngineSpeed)?;
    let encoder = (parts.controllers.best().map(|fit| fit.encoder), stated_gate(parts.bench));
    let dyno = Prepared::new(experiment, parts.torque_controls.best(), encoder)?;
    let gate_s = dyno.encoder.gate_s;
    let torque = every(&dyno.torque, (dyno.speed.sample_time_s / dyno.torque.sample_time_s).round() as usize);
    let record = Record {
        dyno_speed: (&dyno.speed, 0.5 * gate_s),
        engine_speed: (engine_speed, 0.5 * gate_s + values.engine_late_s),
        torque: (torque.as_ref().unwrap_or(&dyno.torque), values.torque_late_s),
        gate_s,
    };
    Ok(record.seen(orders, values))
}

/// One of so many samples; `None` where every one is wanted.
fn every(signal: &Signal, step: usize) -> Option<Signal> {
    let samples = signal.samples.iter().copied().step_by(step.max(1)).collect();
    (step > 1).then(|| Signal::new(signal.start_s, signal.sample_time_s * step as f64, samples).ok()).flatten()
}

/// Standard deviation of a firing from cycle to cycle: how far the windows' amplitudes at the firing order are from those of the harmonic, as if
/// noise had no part of it. A window averages its firings.
fn variation(windows: &[Seen], place: usize, firing: &PulseHarmonic) -> Option<f64> {
    let off = |seen: &Seen| {
        let wave = (*seen.waves.get(place)?)?.torque_nm;
        let expected_nm = firing.value.at(seen.torque_nm, seen.speed_rad_s).norm();
        Some((wave.norm() / expected_nm - 1.0).abs()).filter(|off| off.is_finite())
    };
    let mut all: Vec<f64> = windows.iter().filter_map(off).collect();
    all.sort_by(f64::total_cmp);
    let of_windows = order::quantile_of_sorted(&all, 0.5)? / normal_quantile(0.75);
    Some((of_windows * firings_counted(firing.order).sqrt()).min(MOST_VARIATION))
}
