//! Torques of the dynamometer that should be equal: T_d* and what the load cell reads, each against T_d,calc.

use std::f64::consts::{PI, TAU};

use signal::{Complex64, Signal};

use crate::align::common_window;
use crate::bench_file::BenchFile;
use crate::diagnostics::{Finding, LikelyUnit, Severity};
use crate::experiment::Experiment;
use crate::prepare::log::Log;
use crate::prepare::sign::wrong_sign;
use crate::role::Role;

/// Means over so long hardly see delays and what a sensor does beyond being late, s.
const BLOCK_S: f64 = 1.0;
/// Blocks that a comparison needs.
const FEWEST_BLOCKS: usize = 5;
/// Torques change enough to show a gain where the means of either have this standard deviation, Nm.
const ENOUGH_CHANGE_NM: f64 = 2.0;
/// Torques are large enough to show a gain where one is so large, Nm.
const ENOUGH_SIZE_NM: f64 = 10.0;
/// The means of two torques with another correlation than this have nothing in common but noise.
const RELATED: f64 = 0.9;
/// Gains that differ by more than this disagree. On 40 recordings of ten simulated benches gains differ by 1.2 %,
/// offsets by 0.05 Nm; a torque of a real drive is true to some per cent.
const GAIN: f64 = 0.05;
/// Offsets disagree beyond so many Nm ...
const OFFSET_NM: f64 = 2.0;
/// ... and this part of the torque.
const OFFSET_PART: f64 = 0.03;
/// Where only the means show it, what differs by less than this is an offset.
const OF_THE_MEANS: f64 = 0.25;
/// A gain this close to that of a unit is explained by it.
const EXPLAINED: f64 = 0.03;
/// By how many times what folds to rest on a raster two torques may differ: T_d* is free of it.
const FOLDED_TIMES: f64 = 1.0;
/// The same of the load cell, which shows it another way than T_d,calc.
const FOLDED_TIMES_OF_CELL: f64 = 2.0;
/// Up to this part of half its sample rate N_d shows what folds to rest.
const SHOWN_BY_SPEED: f64 = 0.9;
/// Part of the limit at which a demand is at it.
const AT_LIMIT: f64 = 0.999;
/// Nm in a lbf ft.
const POUND_FOOT_NM: f64 = 1.355_817_948;

/// Notes each torque that is not what T_d,calc is. Without the shaft torques are short peaks, whose means depend on
/// when they are read.
pub(super) fn check(experiment: &Experiment, bench_file: &BenchFile, log: &mut Log) {
    if experiment.label.is_without_shaft() || wrong_sign(experiment, Role::AirGapTorque).is_some() {
        return;
    }
    let limit_nm = bench_file.limits.torque_nm;
    for role in [Role::DynoTorqueDemand, Role::LoadCellTorque] {
        if wrong_sign(experiment, role).is_some() {
            continue;
        }
        let times = if role == Role::LoadCellTorque { FOLDED_TIMES_OF_CELL } else { FOLDED_TIMES };
        let folded_nm = times * folded_to_rest_nm(experiment, bench_file.dynamometer_inertia_kg_m2);
        let Some((gain, offset_nm)) = disagreement(experiment, role, limit_nm, folded_nm) else { continue };
        let channel = bench_file.channels.get(&role).map_or(role.key(), |mapping| mapping.name.as_str());
        let looks_like = likely_unit(role, gain, limit_nm);
        let finding = Finding::TorquesDisagree { role, gain, offset_nm, looks_like };
        log.channel(Severity::Error, channel, None, finding);
    }
}

/// Amplitude of T_d at multiples of the sample rate of T_d,calc, Nm, where it looks like rest: ripple of the drive, and
/// orders of the engine. N_d shows it, which is faster: J_d dω_d/dt.
fn folded_to_rest_nm(experiment: &Experiment, inertia_kg_m2: f64) -> f64 {
    let signals = (experiment.signal(Role::AirGapTorque), experiment.signal(Role::DynoSpeed));
    let (Some(torque), Some(speed)) = signals else { return 0.0 };
    let multiples = (1..).map(|multiple| f64::from(multiple) / torque.sample_time_s);
    let shown = multiples.take_while(|hz| *hz < SHOWN_BY_SPEED * speed.nyquist_hz());
    shown.map(|hz| inertia_kg_m2 * TAU * hz * amplitude_at(speed, hz)).sum()
}

/// Root mean square amplitude of a signal at a frequency, over blocks, each under a Hann window.
fn amplitude_at(signal: &Signal, frequency_hz: f64) -> f64 {
    let blocks = (signal.duration_s() / BLOCK_S) as usize;
    let power = |k: usize| {
        let start_s = signal.start_s + k as f64 * BLOCK_S;
        let block = signal.slice(start_s, start_s + BLOCK_S).samples;
        let (count, middle) = (block.len() as f64, mean(&block));
        let at = |(i, x): (usize, &f64)| {
            let window = (PI * (i as f64 + 0.5) / count).sin().powi(2);
            Complex64::cis(-TAU * frequency_hz * signal.sample_time_s * i as f64) * (window * (x - middle))
        };
        (block.iter().enumerate().map(at).sum::<Complex64>() * (4.0 / count)).norm_sqr()
    };
    ((0..blocks).map(power).sum::<f64>() / blocks.max(1) as f64).sqrt()
}

/// Gain and offset of a torque against T_d,calc, if they are not one and zero. They may differ by what folds to rest
/// besides.
fn disagreement(experiment: &Experiment, role: Role, limit_nm: Option<f64>, folded_nm: f64) -> Option<(f64, f64)> {
    let window = common_window(experiment, &[role, Role::AirGapTorque])?;
    let (of, calc) = (experiment.signal(role)?, experiment.signal(Role::AirGapTorque)?);
    let at_limit = |block: &[f64]| limit_nm.is_some_and(|nm| block.iter().any(|x| x.abs() >= AT_LIMIT * nm));
    let pairs = (0..((window.1 - window.0) / BLOCK_S) as usize).filter_map(|k| {
        let start_s = window.0 + k as f64 * BLOCK_S;
        let part = |signal: &Signal| signal.slice(start_s, start_s + BLOCK_S).samples;
        let (a, b) = (part(of), part(calc));
        (!a.is_empty() && !b.is_empty() && !at_limit(&a)).then(|| (mean(&a), mean(&b)))
    });
    let (a, b): (Vec<f64>, Vec<f64>) = pairs.unzip();
    if a.len() < FEWEST_BLOCKS {
        return None;
    }
    let (mean_a, mean_b) = (mean(&a), mean(&b));
    let product = |x: &[f64], y: &[f64]| {
        let (x_mean, y_mean) = (mean(x), mean(y));
        x.iter().zip(y).map(|(x, y)| (x - x_mean) * (y - y_mean)).sum::<f64>() / x.len() as f64
    };
    let (aa, bb, ab) = (product(&a, &a), product(&b, &b), product(&a, &b));
    // A torque that never changes is named as such.
    if aa == 0.0 {
        return None;
    }
    let correlation = ab / (aa * bb).sqrt();
    let by_changes = if correlation.abs() > RELATED { (aa / bb).sqrt().copysign(ab) } else { ab / bb };
    let (changes, size) = (aa.max(bb).sqrt(), mean_a.abs().max(mean_b.abs()));
    let gain = match (changes > ENOUGH_CHANGE_NM, size > ENOUGH_SIZE_NM) {
        (true, _) => by_changes,
        (false, true) if (mean_a / mean_b - 1.0).abs() > OF_THE_MEANS => mean_a / mean_b,
        (false, true) => 1.0,
        (false, false) => return None,
    };
    // Ripple in proportion to the torque folds to a gain.
    let is_gain_off = (gain - 1.0).abs() > GAIN + folded_nm / size.max(ENOUGH_SIZE_NM);
    let offset_nm = if is_gain_off { mean_a - gain * mean_b } else { mean_a - mean_b };
    let is_off = offset_nm.abs() > OFFSET_NM + OFFSET_PART * mean_b.abs() + folded_nm;
    (is_gain_off || is_off).then_some((gain, offset_nm))
}

/// The torque that is in another unit, and the unit: one that makes values smaller.
fn likely_unit(role: Role, gain: f64, limit_nm: Option<f64>) -> Option<(Role, LikelyUnit)> {
    let (wrong, gain) = if gain < 1.0 { (role, gain) } else { (Role::AirGapTorque, 1.0 / gain) };
    let is = |expected: f64| (gain / expected - 1.0).abs() < EXPLAINED;
    match limit_nm {
        Some(limit_nm) if is(100.0 / limit_nm) => Some((wrong, LikelyUnit::PercentOfLimit)),
        _ if is(1.0 / POUND_FOOT_NM) => Some((wrong, LikelyUnit::PoundFoot)),
        _ if is(1e-3) => Some((wrong, LikelyUnit::KiloNewtonMetre)),
        _ => None,
    }
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}
