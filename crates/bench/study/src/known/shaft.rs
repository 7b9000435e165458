//! Stiffness, damping, inertias and skews.

use part_friction::Inertia;
use rig::facts::BenchVariant;
use rig::results::{Parameter, Part, Quantity, Shaft};

use super::grade::Grade;
use super::graded::{grade, of_part, overlap, sources};
use super::result::{Known, Subject, Value};
use super::why::{FoundInertia, Why};
use crate::verdict::relative_half_width;
use crate::{Analyses, Study};

/// One frequency in a hundred lies above the bound if the shaft is right; a share beyond this speaks against it.
const MANY_ABOVE: f64 = 0.05;
/// Inertias that differ by less than this part of themselves are the same to everyone who uses them.
const ALIKE: f64 = 0.01;
/// A change of the damping beyond this part of itself is worth a sentence.
const MOVED: f64 = 0.1;

/// K and B.
pub(super) fn shaft(study: &Study, analyses: Option<&Analyses>) -> Vec<Known> {
    of_part(Part::Shaft, &study.shaft, |part| {
        [Quantity::Stiffness, Quantity::Damping]
            .iter()
            .filter_map(|quantity| Some(one(study, analyses, part, part.estimate.parameter(*quantity)?)))
            .collect()
    })
}

fn one(study: &Study, analyses: Option<&Analyses>, part: &Shaft, own: &Parameter) -> Known {
    let mut grade = grade(study, own);
    let mut why = vec![sources(study, &part.estimate)];
    let others: Vec<(&String, &Parameter)> =
        part.cross_checks.iter().filter_map(|(file, e)| Some((file, e.parameter(own.quantity)?))).collect();
    let apart = others.iter().filter(|(_, other)| !overlap(own, other));
    let apart: Vec<(String, Parameter)> = apart.map(|(file, other)| ((*file).clone(), (*other).clone())).collect();
    if !apart.is_empty() {
        grade = grade.contradicted();
    }
    why.push(Why::OtherRecordings { count: others.len(), apart });
    let spectrum = &part.residual_spectrum;
    let above = spectrum.normalised_magnitude.iter().filter(|m| **m > spectrum.bound).count();
    let share = above as f64 / spectrum.normalised_magnitude.len().max(1) as f64;
    if share > MANY_ABOVE {
        why.push(Why::BeyondNoise(share));
        grade = grade.contradicted();
    }
    if analyses.and_then(|found| found.shaft.together.as_ref()).is_some_and(|all| all.apart) {
        grade = grade.contradicted();
    }
    why.extend(timing(part, own));
    why.extend(on_inertia(study, part));
    why.extend(analyses.and_then(|found| together(found, own)));
    Known::of(own, grade, why)
}

/// Effect of the signals' timing on it.
fn timing(part: &Shaft, own: &Parameter) -> Option<Why> {
    let plain = part.ignoring_timing.parameter(own.quantity)?;
    let moved = plain.value / own.value - 1.0;
    (moved.abs() > MOVED).then(|| Why::IfStampsWereExact(plain.clone()))
}

/// On a bench with load cell, that the shaft torque is computed with J_d.
fn on_inertia(study: &Study, part: &Shaft) -> Option<Why> {
    if study.bench.variant != BenchVariant::LoadCell {
        return None;
    }
    let stated = study.bench.dynamometer_inertia();
    Some(Why::ComputedWithInertia {
        stated_kg_m2: stated.kg_m2,
        uncertainty_percent: stated.uncertainty_percent,
        estimated: part.estimate.parameter(Quantity::DynoInertia).cloned(),
    })
}

/// Tells whether a value lies in the interval, or as near to the estimate as matters.
fn holds(found: &Parameter, value: f64) -> bool {
    (found.interval.0..=found.interval.1).contains(&value) || (found.value / value - 1.0).abs() < ALIKE
}

/// Joint finding of all recordings.
fn together(found: &Analyses, own: &Parameter) -> Option<Why> {
    let all = found.shaft.together.as_ref()?;
    let common = if own.quantity == Quantity::Stiffness { &all.stiffness } else { &all.damping };
    let (recordings, parameter) = (common.by_recording.len(), common.parameter.clone());
    Some(Why::Together { recordings, apart: all.apart, parameter })
}

/// J_d and J_e.
pub(super) fn inertias(study: &Study, analyses: Option<&Analyses>) -> Vec<Known> {
    let stated = [
        (Quantity::DynoInertia, study.bench.dynamometer_inertia_kg_m2),
        (Quantity::EngineInertia, study.bench.engine_inertia_kg_m2),
    ];
    stated.map(|(quantity, kg_m2)| inertia(study, analyses, quantity, kg_m2)).into()
}

fn inertia(study: &Study, analyses: Option<&Analyses>, quantity: Quantity, stated_kg_m2: f64) -> Known {
    let seen = study.shaft.estimated().and_then(|part| part.inertias.as_ref());
    let from_shaft = seen.and_then(|(file, e)| {
        Some(FoundInertia { file: Some(file.clone()), parameter: e.parameter(quantity)?.clone() })
    });
    let is_of_dyno = quantity == Quantity::DynoInertia;
    let without_shaft = analyses.filter(|_| is_of_dyno).and_then(without_shaft);
    let found: Vec<FoundInertia> = from_shaft.into_iter().chain(without_shaft).collect();
    let width = |one: &FoundInertia| relative_half_width(&one.parameter);
    let Some(best) = found.iter().min_by(|a, b| width(a).total_cmp(&width(b))) else {
        let why = vec![Why::NotChecked(study.bench.variant)];
        return Known::new(Subject::Quantity(quantity), Grade::OnTrust, Value::Stated(stated_kg_m2), why);
    };
    let agree = found.iter().all(|one| holds(&one.parameter, stated_kg_m2));
    let by_width = grade(study, &best.parameter);
    let grade = if agree { by_width } else { by_width.contradicted() };
    let value = Value::Estimated(best.parameter.clone());
    Known::new(Subject::ByRecordings(quantity), grade, value, vec![Why::Inertia { found, agree, stated_kg_m2 }])
}

/// J_d from recordings without shaft.
fn without_shaft(analyses: &Analyses) -> Option<FoundInertia> {
    let found = analyses.friction.as_ref().ok()?;
    match &found.inertia {
        Inertia::Estimated { inertia, .. } => Some(FoundInertia { file: None, parameter: inertia.as_ref().clone() }),
        Inertia::Stated { .. } => None,
    }
}

/// How far apart the clocks of the shaft's signals are.
pub(super) fn skews(study: &Study) -> Vec<Known> {
    let Some(part) = study.shaft.estimated() else { return Vec::new() };
    let known = |quantity: &Quantity| {
        let own = part.estimate.parameter(*quantity)?;
        Some(Known::of(own, grade(study, own), vec![Why::Skew, sources(study, &part.estimate)]))
    };
    [Quantity::EngineSpeedSkew, Quantity::AirGapTorqueSkew].iter().filter_map(known).collect()
}
