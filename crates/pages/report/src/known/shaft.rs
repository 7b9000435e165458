//! Stiffness, damping, inertias and skews.

use part_friction::Inertia;
use rig::facts::BenchVariant;
use rig::results::{Parameter, Quantity, Shaft};
use study::{Analyses, Study};

use super::grade::{Grade, Known, grade, of_part, overlap, relative_width, source};
use crate::wording::{self, number};

/// One frequency in a hundred lies above the bound if the shaft is right; a share beyond this speaks against it.
const MANY_ABOVE: f64 = 0.05;
/// Inertias that differ by less than this part of themselves are the same to everyone who uses them.
const ALIKE: f64 = 0.01;
/// A change of the damping beyond this part of itself is worth a sentence.
const MOVED: f64 = 0.1;

/// K and B.
pub(super) fn shaft(study: &Study, analyses: Option<&Analyses>) -> Vec<Known> {
    of_part(&study.shaft, "K, B", "stiffness and damping of the shaft", |part| {
        [Quantity::Stiffness, Quantity::Damping]
            .iter()
            .filter_map(|quantity| one(study, analyses, part, part.estimate.parameter(*quantity)?))
            .collect()
    })
}

fn one(study: &Study, analyses: Option<&Analyses>, part: &Shaft, own: &Parameter) -> Option<Known> {
    let mut grade = grade(study, own);
    let mut why = vec![source(study, &part.estimate)];
    let others: Vec<(&str, &Parameter)> =
        part.cross_checks.iter().filter_map(|(file, e)| Some((file.as_str(), e.parameter(own.quantity)?))).collect();
    let apart: Vec<&(&str, &Parameter)> = others.iter().filter(|(_, other)| !overlap(own, other)).collect();
    why.push(agreement(others.len(), &apart));
    if !apart.is_empty() {
        grade = grade.contradicted();
    }
    let spectrum = &part.residual_spectrum;
    let above = spectrum.normalised_magnitude.iter().filter(|m| **m > spectrum.bound).count();
    let share = above as f64 / spectrum.normalised_magnitude.len().max(1) as f64;
    if share > MANY_ABOVE {
        why.push(format!(
            "At {} of the frequencies the residual of the shaft is larger than noise explains.",
            number::share(share)
        ));
        grade = grade.contradicted();
    }
    if analyses.and_then(|found| found.shaft.together.as_ref()).is_some_and(|all| all.apart) {
        grade = grade.contradicted();
    }
    why.extend(timing(part, own));
    why.extend(on_inertia(study, part));
    why.extend(analyses.and_then(|found| together(found, own)));
    Some(Known::of(own, grade, why))
}

fn agreement(count: usize, apart: &[&(&str, &Parameter)]) -> String {
    let listed: Vec<String> =
        apart.iter().map(|(file, other)| format!("{file} ({})", number::parameter(*other))).collect();
    match (count, listed.as_slice()) {
        (0, _) => "No second recording checks it.".to_owned(),
        (1, []) => "The one other recording that shows it agrees: the intervals overlap.".to_owned(),
        (2, []) => "Both other recordings that show it agree: the intervals overlap.".to_owned(),
        (n, []) => format!("All {n} other recordings that show it agree: the intervals overlap."),
        (n, _) => {
            format!(
                "Of {n} other recordings that show it, {} not agree: {}.",
                if listed.len() == 1 { "one does".to_owned() } else { format!("{} do", listed.len()) },
                wording::join(&listed, "and")
            )
        }
    }
}

/// Effect of the signals' timing on it.
fn timing(part: &Shaft, own: &Parameter) -> Option<String> {
    let plain = part.ignoring_timing.parameter(own.quantity)?;
    let moved = plain.value / own.value - 1.0;
    let (plain, symbol) = (plain.written(), own.quantity.symbol());
    (moved.abs() > MOVED).then(|| {
        format!(
            "{symbol} depends on the timing of the signals, which is estimated with it. If the time stamps were exact, {symbol} would be {}.",
            number::significant_with_unit(plain.value, 3, plain.notation.unit)
        )
    })
}

/// On a bench with load cell, that the shaft torque is computed with J_d.
fn on_inertia(study: &Study, part: &Shaft) -> Option<String> {
    if study.bench.variant != BenchVariant::LoadCell {
        return None;
    }
    let stated = study.bench.dynamometer_inertia();
    let value = number::measure(stated.kg_m2, "kg m²");
    let how = match part.estimate.parameter(Quantity::DynoInertia) {
        Some(own) => format!(
            "estimated with it: {}. The bench file states {value}, used with a standard uncertainty of {} %",
            number::parameter(own),
            stated.uncertainty_percent
        ),
        None => format!("taken as exact: {value}, as the bench file states it"),
    };
    Some(format!("The shaft’s torque is not measured but computed with J_d, which is {how}."))
}

/// Tells whether a value lies in the interval, or as near to the estimate as matters.
fn holds(found: &Parameter, value: f64) -> bool {
    (found.interval.0..=found.interval.1).contains(&value) || (found.value / value - 1.0).abs() < ALIKE
}

/// Joint finding of all recordings.
fn together(found: &Analyses, own: &Parameter) -> Option<String> {
    let all = found.shaft.together.as_ref()?;
    let common = if own.quantity == Quantity::Stiffness { &all.stiffness } else { &all.damping };
    let verdict =
        if all.apart { "which differ in K and B by more than their own intervals allow" } else { "which agree" };
    Some(format!(
        "All {} recordings together, {verdict}, give {} = {}.",
        common.by_recording.len(),
        own.quantity.symbol(),
        number::parameter(&common.parameter)
    ))
}

/// J_d and J_e.
pub(super) fn inertias(study: &Study, analyses: Option<&Analyses>) -> Vec<Known> {
    let stated = [
        (Quantity::DynoInertia, study.bench.dynamometer_inertia_kg_m2),
        (Quantity::EngineInertia, study.bench.engine_inertia_kg_m2),
    ];
    stated.map(|(quantity, kg_m2)| inertia(study, analyses, quantity, kg_m2)).into()
}

fn inertia(study: &Study, analyses: Option<&Analyses>, quantity: Quantity, kg_m2: f64) -> Known {
    let (symbol, name) = (quantity.symbol(), quantity.name());
    let stated = number::measure(kg_m2, "kg m²");
    let seen = study.shaft.estimated().and_then(|part| part.inertias.as_ref());
    let from_shaft = seen.and_then(|(file, e)| Some((file.clone(), e.parameter(quantity)?)));
    let checks: Vec<(String, &Parameter)> = from_shaft
        .into_iter()
        .chain((quantity == Quantity::DynoInertia).then(|| without_shaft(analyses?)).flatten())
        .collect();
    let best = checks.iter().min_by(|a, b| relative_width(a.1).total_cmp(&relative_width(b.1)));
    let Some((_, best)) = best else {
        let remedy = match study.bench.variant {
            BenchVariant::LoadCell => "WhiteNoise_T_TN or Multisine_T_TN would show it",
            BenchVariant::TorqueFlange => "behind a dual-mass flywheel no recording with the shaft on can",
        };
        let why = vec![format!("No recording shows whether it is true; {remedy}.")];
        return Known::new(symbol, name, Grade::OnTrust, format!("{stated}, stated"), why);
    };
    let agree = checks.iter().all(|(_, found)| holds(found, kg_m2));
    let by_width = grade(study, best);
    let words = checks.iter().map(|(file, found)| format!("{file} gives {}", number::parameter(*found)));
    let words: Vec<String> = words.collect();
    let verdict = if agree { "which agrees, within 1 % or its interval, with" } else { "which does not hold" };
    let why = vec![format!("{}, {verdict} the {stated} of the bench file.", wording::join(&words, "and"))];
    let name = format!("{name}, by the recordings alone");
    Known::new(symbol, &name, if agree { by_width } else { by_width.contradicted() }, number::parameter(*best), why)
}

/// J_d from recordings without shaft.
fn without_shaft(analyses: &Analyses) -> Option<(String, &Parameter)> {
    let found = analyses.friction.as_ref().ok()?;
    match &found.inertia {
        Inertia::Estimated { inertia, .. } => Some(("the recordings without shaft".to_owned(), inertia.as_ref())),
        Inertia::Stated { .. } => None,
    }
}

/// How far apart the clocks of the shaft's signals are.
pub(super) fn skews(study: &Study) -> Vec<Known> {
    let Some(part) = study.shaft.estimated() else { return Vec::new() };
    let known = |quantity: &Quantity| {
        let own = part.estimate.parameter(*quantity)?;
        let why = vec![
            "A skew is by how much the time stamps of a signal are late. It is estimated with K and B; no second method checks it."
                .to_owned(),
            source(study, &part.estimate),
        ];
        Some(Known::of(own, grade(study, own), why))
    };
    [Quantity::EngineSpeedSkew, Quantity::AirGapTorqueSkew].iter().filter_map(known).collect()
}
