//! Checks that need several signals: saturation, speeds that should agree, the sign of the torque.

use super::sign;
use crate::align::{common_window, cut};
use crate::bench_file::BenchFile;
use crate::diagnostics::{Finding, Severity};
use crate::experiment::{ControlMode, Experiment};
use crate::prepare::log::Log;
use crate::role::Role;

/// Relative difference of mean speeds above which N_e disagrees: what both ends of a shaft turn is counted.
const ENGINE_SPEED_TOLERANCE: f64 = 0.005;
/// The same of N_d*.
const SPEED_DEMAND_TOLERANCE: f64 = 0.02;
/// Mean speed below which no ratio is formed, rad/s.
const STANDSTILL_RAD_S: f64 = 1.0;
/// A demand this close to the limit, as a share of it, is at the limit.
const AT_LIMIT: f64 = 0.001;
/// The same of a measured torque, which has noise.
const AT_LIMIT_MEASURED: f64 = 0.01;
/// Saturated stretches closer than this are one, s.
const JOINED_S: f64 = 0.02;

pub(super) fn check(experiment: &Experiment, bench_file: &BenchFile, log: &mut Log) {
    check_saturation(experiment, bench_file, log);
    check_speeds(experiment, bench_file, log);
    sign::check(experiment, bench_file, log);
}

/// Stretches, (start, end) in s, in which the torque demand is at ±`limit_nm`, or the air-gap torque where no demand
/// was recorded. Stretches less than 20 ms apart are joined.
pub fn saturated_stretches(experiment: &Experiment, limit_nm: f64) -> Vec<(f64, f64)> {
    let Some((signal, threshold)) = limited(experiment, limit_nm) else { return Vec::new() };
    let mut stretches: Vec<(f64, f64)> = Vec::new();
    for (i, _) in signal.samples.iter().enumerate().filter(|(_, value)| value.abs() >= threshold) {
        let (start_s, end_s) = (signal.time_s(i), signal.time_s(i + 1));
        match stretches.last_mut() {
            Some(last) if start_s - last.1 <= JOINED_S => last.1 = end_s,
            _ => stretches.push((start_s, end_s)),
        }
    }
    stretches
}

/// The signal that saturates first, and the magnitude at which it counts as saturated.
fn limited(experiment: &Experiment, limit_nm: f64) -> Option<(&signal::Signal, f64)> {
    let demand = experiment.signal(Role::DynoTorqueDemand).map(|signal| (signal, (1.0 - AT_LIMIT) * limit_nm));
    demand.or_else(|| {
        let measured = experiment.signal(Role::AirGapTorque)?;
        Some((measured, (1.0 - AT_LIMIT_MEASURED) * limit_nm))
    })
}

fn check_saturation(experiment: &Experiment, bench_file: &BenchFile, log: &mut Log) {
    let Some(limit_nm) = bench_file.limits.torque_nm else { return };
    let Some((signal, threshold)) = limited(experiment, limit_nm) else { return };
    let at_limit = |value: &&f64| value.abs() >= threshold;
    let share = signal.samples.iter().filter(at_limit).count() as f64 / signal.len() as f64;
    let first = signal.samples.iter().position(|value| value.abs() >= threshold);
    if let Some(first) = first {
        let severity = Severity::of_share(share);
        log.file(severity, Some(signal.time_s(first)), Finding::Saturated { share, limit_nm });
    }
}

fn check_speeds(experiment: &Experiment, bench_file: &BenchFile, log: &mut Log) {
    if !experiment.label.is_without_shaft() {
        compare_speeds(experiment, bench_file, Role::EngineSpeed, log);
    }
    if experiment.label.mode == ControlMode::Nt {
        compare_speeds(experiment, bench_file, Role::DynoSpeedDemand, log);
    }
}

fn compare_speeds(experiment: &Experiment, bench_file: &BenchFile, role: Role, log: &mut Log) {
    let Some((start_s, end_s)) = common_window(experiment, &[Role::DynoSpeed, role]) else { return };
    let mean = |role| experiment.signal(role).and_then(|signal| cut(signal, start_s, end_s).mean());
    let (Some(dyno), Some(other)) = (mean(Role::DynoSpeed), mean(role)) else { return };
    let tolerance = if role == Role::EngineSpeed { ENGINE_SPEED_TOLERANCE } else { SPEED_DEMAND_TOLERANCE };
    if dyno.abs() < STANDSTILL_RAD_S || (other / dyno - 1.0).abs() <= tolerance {
        return;
    }
    let channel = bench_file.channels.get(&role).map_or(role.key(), |mapping| mapping.name.as_str());
    let finding = Finding::SpeedsDisagree { role, ratio_to_dyno_speed: other / dyno };
    log.channel(Severity::Warning, channel, None, finding);
}
