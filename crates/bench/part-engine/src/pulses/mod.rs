//! The firing pulses of the engine, of all recordings with a shaft together: how strong each harmonic of the working
//! cycle is, over mean torque and speed, with its covariance.
//!
//! Where the recordings show nothing, the pulses are those of the class, see [`EnginePulses::prior`]. The mean torque
//! of the engine is T_d + (J_d + J_e) dω/dt and the friction of the dynamometer's bearings. Its mean
//! is taken, as it is stated, as run-outs show it or as the class has it, and its spread counts as an error.

mod fit;
mod windows;

use std::f64::consts::SQRT_2;

use numerics::{order, parallel};
use part_shaft::Parts;
use part_shaft::shaft_inputs::stated_gate;
use part_torque::torque_smoother::{Prepared, needed};
use rig::dyno_friction::{EstimatedFriction, ExpectedFriction};
use rig::engine_pulses::{EnginePulses, PulseHarmonic};
use rig::estimation::EstimateError;
use rig::experiment::Test;
use rig::prepare::believable;
use rig::results::Reason;
use rig::{Experiment, Role};
use signal::distributions::normal_quantile;
use signal::{Complex64, Signal};

use crate::source::{TwoMasses, Values};
use fit::{Class, Joined, Recording};
use windows::{Late, Record, Seen, firings_counted};

/// Harmonics up to this multiple of the firing order are looked for one by one, beyond it the multiples of the firing
/// order alone.
const ONE_BY_ONE: usize = 2;
/// The largest variation from cycle to cycle that is believed.
const MOST_VARIATION: f64 = 0.2;
/// Pairs of windows that show it.
const FEWEST_PAIRS: usize = 20;

/// The pulses that recordings show; `is_sound` says which of them may be used. `friction` is that of the dynamometer as
/// run-outs show it, if there are any.
///
/// # Errors
/// No shaft, or no recording that shows the engine's pulses; without a reason where nothing fires.
pub fn engine_pulses(
    parts: &Parts<'_>,
    friction: Option<&EstimatedFriction>,
    is_sound: &dyn Fn(&Experiment) -> bool,
) -> Result<EnginePulses, Vec<Reason>> {
    if parts.bench.cylinders == 0 {
        return Err(Vec::new());
    }
    let masses = TwoMasses::of(parts)?;
    let values = Values::of(&masses.values);
    let engine = parts.bench.engine();
    let cylinders = engine.cylinders as usize;
    let is_used = |experiment: &&Experiment| !experiment.label.is_without_shaft() && is_sound(experiment);
    let all: Vec<&Experiment> = parts.experiments.iter().copied().filter(is_used).collect();
    // Ignition angles set the torque of engines with spark ignition alone.
    let prior = match all.iter().any(|experiment| is_by_ignition(experiment)) {
        true => EnginePulses::prior_of_spark_ignition(engine, values.engine_inertia),
        false => EnginePulses::prior(engine, values.engine_inertia),
    };
    let class = Class::of(&prior);
    let places: Vec<usize> = looked_for(cylinders, prior.harmonics.len()).collect();
    let orders: Vec<f64> = places.iter().map(|place| prior.harmonics[*place].order).collect();
    let limit_nm = parts.bench.limits.torque_nm.unwrap_or_else(|| largest_torque_nm(&all));
    let friction = ExpectedFriction::of(parts.bench, limit_nm, friction);
    let looks = parallel::map(&all, |experiment| seen(experiment, parts, &values, friction, &orders));
    let mut reasons = Vec::new();
    let mut seen: Vec<(Recording, Vec<Seen>)> = Vec::new();
    for (experiment, look) in all.iter().zip(looks) {
        match look {
            Ok(windows) => {
                let is_by_ignition = is_by_ignition(experiment);
                let doubt_nm = friction.deviation_nm(mean_of(&windows, |seen| seen.speed_rad_s));
                let recording = Recording::of(&experiment.file, &windows, &places, &class, is_by_ignition, doubt_nm);
                seen.push((recording, windows));
            }
            Err(error) => reasons.push(Reason::from(error)),
        }
    }
    seen.sort_by(|(a, _), (b, _)| b.weight(cylinders).total_cmp(&a.weight(cylinders)));
    let (recordings, seen): (Vec<Recording>, Vec<Vec<Seen>>) = seen.into_iter().unzip();
    let joined = Joined::of(&recordings, cylinders);
    // Of the others, windows are noise.
    let with_pulses = || recordings.iter().zip(&seen).filter(|(one, _)| joined.recordings.contains(&one.file));
    let windows: Vec<&Seen> = with_pulses().flat_map(|(_, windows)| windows).collect();
    let at = (mean_of(windows.iter().copied(), |seen| seen.torque_nm), mean_of(windows, |seen| seen.speed_rad_s));
    let harmonics = joined.pulses(&prior, &values, friction.deviation_nm(at.1), at);
    if !harmonics.get(cylinders - 1).is_some_and(|firing| firing.is_estimated) {
        return Err(reasons);
    }
    // Of the places looked for, those up to the firing order are the first. What ignition angles do is no variation.
    let of_charge = with_pulses().filter(|(recording, _)| !recording.is_by_ignition);
    let of_charge = of_charge.map(|(_, windows)| windows.as_slice());
    let cycle_variation =
        variation(of_charge, cylinders - 1, &harmonics[cylinders - 1]).unwrap_or(prior.cycle_variation);
    Ok(EnginePulses { cycle_variation, recordings: joined.recordings, harmonics, ..prior })
}

/// The mean over windows; zero of none.
fn mean_of<'a>(windows: impl IntoIterator<Item = &'a Seen>, of: fn(&Seen) -> f64) -> f64 {
    let (sum, count) = windows.into_iter().fold((0.0, 0_u32), |(sum, count), seen| (sum + of(seen), count + 1));
    sum / f64::from(count.max(1))
}

/// The largest air-gap torque that was recorded, Nm.
fn largest_torque_nm(experiments: &[&Experiment]) -> f64 {
    let torques = experiments.iter().filter_map(|experiment| needed(experiment, Role::AirGapTorque).ok());
    torques.flat_map(|torque| &torque.samples).fold(0.0, |most, torque| most.max(torque.abs()))
}

/// Tells whether ignition angles set the engine's torque.
fn is_by_ignition(experiment: &Experiment) -> bool {
    experiment.label.test == Test::Bs
}

/// Places of the harmonics that are looked for.
fn looked_for(cylinders: usize, count: usize) -> impl Iterator<Item = usize> {
    (0..count).filter(move |place| *place < ONE_BY_ONE * cylinders || (place + 1).is_multiple_of(cylinders))
}

/// Findings of the windows of a recording.
fn seen(
    experiment: &Experiment,
    parts: &Parts<'_>,
    values: &Values,
    friction: ExpectedFriction,
    orders: &[f64],
) -> Result<Vec<Seen>, EstimateError> {
    believable(experiment)?;
    let engine_speed = needed(experiment, Role::EngineSpeed)?;
    let encoder = parts.controllers.best().map(|fit| fit.encoder);
    let dyno = Prepared::new(experiment, parts.torque_controls.best(), encoder, stated_gate(parts.bench))?;
    let gate_s = dyno.encoder.gate_s;
    let torque = every(&dyno.torque, (dyno.speed.sample_time_s / dyno.torque.sample_time_s).round() as usize);
    let record = Record {
        dyno_speed: Late { signal: &dyno.speed, late_s: 0.5 * gate_s },
        engine_speed: Late { signal: engine_speed, late_s: 0.5 * gate_s + values.engine_late_s },
        torque: Late { signal: torque.as_ref().unwrap_or(&dyno.torque), late_s: values.torque_late_s },
        friction,
        gate_s,
    };
    Ok(record.seen(orders, values))
}

/// One of so many samples; `None` where every one is wanted.
fn every(signal: &Signal, step: usize) -> Option<Signal> {
    let samples = signal.samples.iter().copied().step_by(step.max(1)).collect();
    (step > 1).then(|| Signal::new(signal.start_s, signal.sample_time_s * step as f64, samples).ok()).flatten()
}

/// Standard deviation of a firing from cycle to cycle: how far the amplitudes at the firing order are apart in windows
/// that share nothing, over what the mean torque makes of them, as if noise had no part of it. A window averages its
/// firings. Its own mean torque varies with them, and cannot show what was demanded: the recording counts in which the
/// amplitudes are least apart, since its torque is the steadiest.
fn variation<'a>(recordings: impl Iterator<Item = &'a [Seen]>, place: usize, firing: &PulseHarmonic) -> Option<f64> {
    let [re, im] = firing.value.of_torque;
    let apart = |windows: &[Seen]| {
        let (one, other) = (&windows[0], &windows[2]);
        let torque_nm = 0.5 * (one.torque_nm + other.torque_nm);
        let predicted = |speed_rad_s: f64| firing.value.at(torque_nm, speed_rad_s);
        let beyond =
            |seen: &Seen| Some((*seen.waves.get(place)?)?.torque_nm.norm() - predicted(seen.speed_rad_s).norm());
        let middle = predicted(0.5 * (one.speed_rad_s + other.speed_rad_s));
        let of_torque_nm = (middle * Complex64::new(re, -im)).re / middle.norm() * torque_nm;
        Some(((beyond(one)? - beyond(other)?) / of_torque_nm).abs()).filter(|apart| apart.is_finite())
    };
    let of_recording = |windows: &[Seen]| {
        let mut all: Vec<f64> = windows.windows(3).filter_map(apart).collect();
        all.sort_by(f64::total_cmp);
        order::quantile_of_sorted(&all, 0.5).filter(|_| all.len() >= FEWEST_PAIRS)
    };
    let least = recordings.filter_map(of_recording).min_by(f64::total_cmp)?;
    let of_windows = least / normal_quantile(0.75) / SQRT_2;
    Some((of_windows * firings_counted(firing.order).sqrt()).min(MOST_VARIATION))
}
