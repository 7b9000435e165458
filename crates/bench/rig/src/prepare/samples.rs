//! Checks of one channel's values: dead, clipped, or of a magnitude that its unit cannot mean.

use signal::Signal;
use signal::quality::{QualityOptions, check_quality};
use signal::updates::resolution;
use units::{self, Quantity, Unit};

use crate::bench_file::BenchFile;
use crate::diagnostics::{Finding, Severity};
use crate::experiment::{ControlMode, Excitation, ExperimentLabel};
use crate::prepare::log::Log;
use crate::prepare::source::{Source, longest};
use crate::role::Role;

/// Few benches turn faster: a channel labelled rad/s that does may hold rpm.
const FAST_RAD_S: f64 = 700.0;
/// A value this many times a limit of the bench file is not believed.
const BEYOND_LIMIT: f64 = 2.0;
/// Steps of a measured speed beyond this are coarse, rad/s: 0.3 rpm. In steps of 1 rpm, k was estimated 30 % wrong.
const COARSE_RAD_S: f64 = 0.03;
/// N_d is slow beyond this, s: every 2 ms, the skew of T_d,calc was estimated 3 ms wrong and K by 1.3 %.
const SLOW_S: f64 = 0.0015;
/// The stamps of N_d are in ms beyond this, s.
const STAMPS_IN_MS_S: f64 = 0.2;
/// Share of the samples at the largest or smallest value above which a measured signal is called clipped.
const CLIPPED_SHARE: f64 = 0.005;

/// Tells whether a channel's values can be used; notes their faults.
pub(super) fn are_usable(
    source: &Source<'_>,
    stretches: &[Signal],
    label: &ExperimentLabel,
    bench_file: &BenchFile,
    log: &mut Log,
) -> bool {
    let Some(signal) = longest(stretches) else { return false };
    let Ok(quality) = check_quality(&signal.samples, &QualityOptions::default()) else { return false };
    if quality.constant {
        return is_constant_usable(source, signal, label, log);
    }
    if !is_plausible(source, signal, bench_file.limits.speed_rad_s, log) {
        return false;
    }
    note_steps(source, signal, log);
    for runs in [&quality.clipped_low, &quality.clipped_high] {
        let count: usize = runs.iter().map(|run| run.len()).sum();
        let share = count as f64 / signal.len() as f64;
        let first = runs.first().and_then(|run| Some((signal.time_s(run.start), *signal.samples.get(run.start)?)));
        if let Some((time_s, value)) = first.filter(|_| share > CLIPPED_SHARE && is_measured(source.role)) {
            log.channel(Severity::of_share(share), source.channel, Some(time_s), Finding::Clipped { value, share });
        }
    }
    true
}

/// Notes a measured speed in coarse steps, and N_d at a slow rate.
fn note_steps(source: &Source<'_>, signal: &Signal, log: &mut Log) {
    if !source.role.may_be_angle() {
        return;
    }
    if let Some(step) = resolution(&signal.samples).filter(|step| *step > COARSE_RAD_S) {
        let finding = Finding::CoarseResolution { role: source.role, step };
        log.channel(Severity::Warning, source.channel, None, finding);
    }
    let sample_time_s = signal.sample_time_s;
    if source.role == Role::DynoSpeed && sample_time_s > SLOW_S {
        let is_in_ms = sample_time_s > STAMPS_IN_MS_S;
        let severity = if is_in_ms { Severity::Error } else { Severity::Warning };
        log.channel(severity, source.channel, None, Finding::SlowRaster { sample_time_s, is_in_ms });
    }
}

pub(super) fn is_measured(role: Role) -> bool {
    !role.is_demand() && role != Role::Throttle
}

/// Notes a signal that never changes where it should. A measured one is dead and is refused.
fn is_constant_usable(source: &Source<'_>, signal: &Signal, label: &ExperimentLabel, log: &mut Log) -> bool {
    let value = signal.samples.first().copied().unwrap_or_default();
    if !should_move(source.role, label) {
        return true;
    }
    let is_dead = is_measured(source.role);
    let severity = if is_dead { Severity::Error } else { Severity::Warning };
    log.channel(severity, source.channel, None, Finding::Constant { value });
    !is_dead
}

/// Tells whether a role's signal changes in an experiment.
fn should_move(role: Role, label: &ExperimentLabel) -> bool {
    match role {
        Role::DynoSpeedDemand => label.mode == ControlMode::Nt && label.excitation == Excitation::Speed,
        Role::EngineSpeed | Role::SystemShaftTorque | Role::FlangeTorque => !label.is_without_shaft(),
        Role::Throttle => false,
        _ => true,
    }
}

/// Tells whether a signal's magnitude is possible. What is possible but rare is noted.
pub(super) fn is_plausible(
    source: &Source<'_>,
    signal: &Signal,
    speed_limit_rad_s: Option<f64>,
    log: &mut Log,
) -> bool {
    let magnitudes = signal.samples.iter().map(|value| value.abs()).enumerate();
    let Some((index, largest)) = magnitudes.max_by(|a, b| a.1.total_cmp(&b.1)) else { return false };
    let stated = speed_limit_rad_s.filter(|_| source.role.quantity() == Quantity::AngularSpeed);
    let impossible = stated
        .map(|limit| BEYOND_LIMIT * limit)
        .or(source.role.quantity().largest_at_a_bench())
        .unwrap_or(f64::INFINITY);
    let rare = if source.unit.spelling == "rad/s" { FAST_RAD_S.min(impossible) } else { impossible };
    if largest <= rare || (largest <= impossible && stated.is_some()) {
        return true;
    }
    let looks_like = plausible_unit(source.unit, largest, rare);
    let finding = Finding::ImplausibleMagnitude { role: source.role, largest, looks_like };
    let refused = largest > impossible;
    let severity = if refused { Severity::Error } else { Severity::Warning };
    log.channel(severity, source.channel, Some(signal.time_s(index)), finding);
    !refused
}

/// The usual unit in which the recorded number would be plausible.
fn plausible_unit(unit: Unit, largest: f64, possible: f64) -> Option<String> {
    let recorded = unit.from_si(largest);
    let usual = ["rpm", "Nm", "%", "mNm", "deg/s"].into_iter().filter_map(|spelling| units::parse_unit(spelling).ok());
    let mut same = usual.filter(|other| other.quantity == unit.quantity && other.spelling != unit.spelling);
    same.find(|other| other.to_si(recorded) <= possible).map(|other| other.spelling.to_owned())
}
