//! Known quantities, and how well they are known.

use report::known::{Worded, known};
use rig::results::{Estimate, Outcome, Parameter, Quantity, Shaft};
use study::known::Grade;
use study::{Analyses, Study};

use crate::fixture;

const NO_ANALYSES: Option<&Analyses> = None;

fn of(study: &Study, symbol: &str) -> Option<Worded> {
    known(study, NO_ANALYSES).into_iter().find(|one| one.symbol == symbol)
}

fn grade(study: &Study, symbol: &str) -> Option<Grade> {
    of(study, symbol).map(|one| one.grade)
}

fn why(study: &Study, symbol: &str) -> String {
    of(study, symbol).map(|one| one.why.join(" ")).unwrap_or_default()
}

fn shaft(study: &mut Study) -> Option<&mut Shaft> {
    match &mut study.shaft {
        Outcome::Estimated(shaft) => Some(shaft),
        Outcome::NotEstimated { .. } => None,
    }
}

/// The parameter with another interval, as a part of its value to either side.
fn set_width(estimate: &mut Estimate, symbol: &str, width: f64) {
    let own = estimate.parameters.iter_mut().filter(|p| p.quantity.symbol() == symbol);
    own.for_each(|p| p.interval = (p.value * (1.0 - width), p.value * (1.0 + width)));
}

#[test]
fn exact_the_width_of_the_interval_grades() {
    let mut study = fixture::complete();
    shaft(&mut study).unwrap().cross_checks.clear();
    shaft(&mut study).unwrap().residual_spectrum.normalised_magnitude.iter_mut().for_each(|m| *m = 0.5);
    for (width, grade) in [(0.04, Grade::Well), (0.06, Grade::Roughly), (0.3, Grade::Poorly)] {
        set_width(&mut shaft(&mut study).unwrap().estimate, "K", width);
        assert_eq!(self::grade(&study, "K"), Some(grade), "±{width}");
    }
}

#[test]
fn exact_a_recording_that_disagrees_is_named_and_counts() {
    let mut study = fixture::complete();
    let part = shaft(&mut study).unwrap();
    part.residual_spectrum.normalised_magnitude.iter_mut().for_each(|m| *m = 0.5);
    part.cross_checks.clear();
    set_width(&mut part.estimate, "K", 0.01);
    let mut other = part.estimate.clone();
    part.cross_checks.push(("alike.mf4".into(), other.clone()));
    assert_eq!(grade(&study, "K"), Some(Grade::Well));
    let value = |p: &mut Parameter| (p.value, p.interval) = (1.5 * p.value, (1.5 * p.interval.0, 1.5 * p.interval.1));
    other.parameters.iter_mut().filter(|p| p.quantity == Quantity::Stiffness).for_each(value);
    shaft(&mut study).unwrap().cross_checks.push(("apart.mf4".into(), other));
    assert_eq!(grade(&study, "K"), Some(Grade::Roughly));
    let why = why(&study, "K");
    assert!(why.contains("Of 2 other recordings") && why.contains("apart.mf4"), "{why}");
    assert!(!why.contains("alike.mf4"), "{why}");
}

#[test]
fn exact_inertias_that_nobody_checked_are_taken_on_trust() {
    let mut study = fixture::complete();
    shaft(&mut study).unwrap().inertias = None;
    assert_eq!(grade(&study, "J_e"), Some(Grade::OnTrust));
    assert!(why(&study, "K").contains("which is taken as exact"));
    let mut seen = shaft(&mut study).unwrap().estimate.clone();
    let engine = Parameter {
        quantity: Quantity::EngineInertia,
        value: study.bench.engine_inertia_kg_m2,
        interval: (0.99 * study.bench.engine_inertia_kg_m2, 1.01 * study.bench.engine_inertia_kg_m2),
        ..seen.parameters[0].clone()
    };
    seen.parameters.push(engine);
    shaft(&mut study).unwrap().inertias = Some(("noise.mf4".into(), seen));
    assert_eq!(grade(&study, "J_e"), Some(Grade::Well));
    study.bench.engine_inertia_kg_m2 *= 1.5;
    assert_eq!(grade(&study, "J_e"), Some(Grade::Roughly));
}

#[test]
fn exact_nothing_is_claimed_of_what_was_not_estimated() {
    let study = fixture::bare();
    for one in known(&study, NO_ANALYSES) {
        assert!(one.grade >= Grade::OnTrust, "{one:?}");
        assert!(!one.why.is_empty() && one.why.iter().all(|text| text.ends_with('.')), "{one:?}");
    }
    assert!(why(&study, "K, B").contains("are too short"));
}
