//! Doubts of recordings by the pulses of the engine, the ripple of the drive, and a torque that is ahead of its demand.

use numerics::parallel::map;
use part_engine::firing::Firing;
use part_engine::pulse_path::{Answer, off_shaft};
use part_torque::demand_clock::advance_s;
use part_torque::ripple_clock::{Ripple, ripple};
use rig::experiment::Sought;
use rig::facts::BenchVariant;
use rig::results::Shaft;
use rig::{Excitation, Experiment, Finding, Role, Severity};

use crate::findings::Findings;

/// Doubts the stated engine where most recordings show another, else the recordings that do; and where pulses do not
/// come as often as the speed says, the recording. Answers with how often they come, where that is seen.
pub(super) fn doubt_firing(findings: &mut Findings<'_>) -> Vec<(String, f64)> {
    let stated = findings.bench.engine().firings_per_turn();
    let experiments = findings.experiments;
    let with_shaft: Vec<&Experiment> = experiments.iter().filter(|e| !e.label.is_without_shaft()).collect();
    let seen = map(&with_shaft, |one| Firing::of(one, stated));
    let engines = with_shaft.iter().zip(&seen).filter_map(|(one, seen)| Some((*one, seen.contradiction?)));
    let engines: Vec<(&Experiment, Option<f64>)> = engines.collect();
    let others: Vec<(&Experiment, f64)> = engines.iter().filter_map(|(one, found)| Some((*one, (*found)?))).collect();
    let disagrees = |found: f64| Finding::FiringOrderDisagrees { stated, found };
    match others.first() {
        Some((_, found)) if 2 * others.len() > engines.len() => {
            findings.doubt_bench(Severity::Error, disagrees(*found));
        }
        _ => others.iter().for_each(|(one, found)| findings.doubt(&one.file, Severity::Error, disagrees(*found))),
    }
    let named = |one: &&Experiment| others.iter().any(|(other, _)| other.file == one.file);
    let ratios = with_shaft.iter().zip(&seen).filter_map(|(one, seen)| Some((*one, seen.pulses_over_speed?)));
    let ratios: Vec<(&Experiment, f64)> = ratios.filter(|(one, _)| !named(one)).collect();
    for (experiment, ratio) in ratios.iter().filter(|(_, ratio)| Firing::is_off_speed(*ratio)) {
        findings.doubt(&experiment.file, Severity::Error, Finding::PulsesOffSpeed { ratio: *ratio });
    }
    ratios.into_iter().map(|(experiment, ratio)| (experiment.file.clone(), ratio)).collect()
}

/// Doubts the clock of each recording whose ripple is beside twice the mains, if its engine's pulses are as far off
/// their speed, or if the others are all alike: as far off as this one, or right. `pulses` says how often these come
/// over what the speed says.
pub(super) fn doubt_clocks(findings: &mut Findings<'_>, pulses: &[(String, f64)]) {
    let of = |file: &String| pulses.iter().find(|(of, _)| of == file).map(|(_, ratio)| *ratio);
    let seen = findings.experiments.iter().filter_map(|one| Some((&one.file, ripple(one, of(&one.file))?)));
    let seen: Vec<(&String, Ripple)> = seen.collect();
    for (i, (file, one)) in seen.iter().enumerate().filter(|(_, (_, one))| one.is_off()) {
        let others = seen.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, (_, other))| other.ratio());
        if one.is_certain(&others.collect::<Vec<f64>>()) {
            let finding = Finding::ClockRate { found_hz: one.found_hz, mains_hz: one.mains_hz };
            findings.doubt(file, Severity::Error, finding);
        }
    }
}

/// Doubts each recording at a constant speed demand in which the pulses do not pass as K and B say.
pub(super) fn doubt_pulse_path(
    findings: &mut Findings<'_>,
    experiments: &[&Experiment],
    shaft: &Shaft,
    answer: Option<Answer>,
) {
    if findings.bench.variant != BenchVariant::LoadCell {
        return;
    }
    let firings_per_turn = findings.bench.engine().firings_per_turn();
    let inertia_kg_m2 = findings.bench.dynamometer_inertia_kg_m2;
    let is_at_a_speed = |experiment: &&Experiment| experiment.label.excitation == Excitation::Torque;
    for experiment in Sought::Shaft.candidates(experiments).into_iter().filter(is_at_a_speed) {
        if let Some((frequency_hz, ratio)) = off_shaft(experiment, shaft, answer, inertia_kg_m2, firings_per_turn) {
            findings.doubt(&experiment.file, Severity::Error, Finding::PulsesOffShaft { frequency_hz, ratio });
        }
    }
}

/// Doubts each recording in which T_d,calc is ahead of T_d*; `lag_s` is how late the torque control makes it beside its
/// pure delay.
pub(super) fn doubt_demand_clock(findings: &mut Findings<'_>, lag_s: f64) {
    for experiment in findings.experiments {
        if let Some(advance_s) = advance_s(experiment, lag_s) {
            let finding = Finding::EarlySignal { role: Role::AirGapTorque, advance_s };
            findings.doubt(&experiment.file, Severity::Error, finding);
        }
    }
}
