//! Two bench models, compared.

use bench_model::document::{BenchFileOrigin, BenchModelDocument, Provenance, UsedRecording};
use bench_model::model::{AssembledModel, BenchModel, ModelParameter, ModelUncertainty, PartCovariance};
use bench_testkit::models::bench_a;
use numerics::random::Stream;
use rig::facts::{BenchFacts, BenchVariant};
use study::{ComparedPart, compare_models};

fn uncertainty(degrees_of_freedom: f64) -> ModelUncertainty {
    let shaft = PartCovariance {
        parameters: vec![ModelParameter::Stiffness, ModelParameter::Damping, ModelParameter::DynoInertia],
        covariance: vec![vec![36.0, 0.3, 0.008], vec![0.3, 0.04, 1e-5], vec![0.008, 1e-5, 9e-6]],
        degrees_of_freedom,
    };
    let controller = PartCovariance {
        parameters: vec![ModelParameter::Proportional, ModelParameter::Integral, ModelParameter::ControllerDelay],
        covariance: vec![vec![1e-4, 2e-5, 0.0], vec![2e-5, 4e-4, 0.0], vec![0.0, 0.0, 1e-10]],
        degrees_of_freedom: 30.0,
    };
    ModelUncertainty::new(&[shaft, controller]).unwrap()
}

pub(crate) fn document(model: BenchModel, recording: &str) -> BenchModelDocument {
    let facts = BenchFacts {
        name: "Test cell 4".into(),
        variant: BenchVariant::LoadCell,
        cylinders: 4,
        strokes: 4,
        dynamometer_inertia_kg_m2: 0.6,
        dynamometer_inertia_uncertainty_percent: None,
        engine_inertia_kg_m2: 0.28,
        engine_inertia_uncertainty_percent: Some(0.0),
        torque_limit_nm: Some(400.0),
        shaft_torque_limit_nm: None,
        speed_limit_rad_s: None,
    };
    let used = UsedRecording {
        file: format!("{recording}.mf4"),
        sha256: recording.to_owned(),
        label: None,
        used_for: Vec::new(),
    };
    let provenance = Provenance {
        dynoid_version: "0.1.0".into(),
        date: "2026-05-03".into(),
        bench_file: BenchFileOrigin { name: "bench.toml".into(), sha256: "0".into() },
        recordings: vec![used],
        seed: None,
        verdict: None,
    };
    BenchModelDocument::new(
        AssembledModel {
            model,
            uncertainty: uncertainty(60.0),
            engine_pulses: None,
            disturbances: None,
            dyno_friction: None,
        },
        facts,
        provenance,
    )
}

#[test]
fn stat_models_of_one_bench_are_told_apart_as_rarely_as_stated() {
    let draw = |number| {
        let drawn = uncertainty(f64::INFINITY).draw(&bench_a(), &mut Stream::new(3, number)).unwrap();
        document(drawn, &number.to_string())
    };
    let changed = (0..2000).filter(|k| compare_models(&draw(2 * k), &draw(2 * k + 1)).has_changed()).count();
    // At most 1 % by construction, and not far below it: 20 of 2000, standard deviation 4.4.
    assert!((8..=34).contains(&changed), "{changed} of 2000");
}

#[test]
fn exact_a_softer_shaft_is_found_in_its_part_alone() {
    let softer = bench_a().with(ModelParameter::Stiffness, 2437.7 - 60.0);
    let found = compare_models(&document(bench_a(), "a"), &document(softer, "b"));
    assert!(found.has_changed());
    let changed: Vec<ComparedPart> =
        found.parts.iter().filter(|part| part.has_changed()).map(|part| part.part).collect();
    assert_eq!(changed, [ComparedPart::Shaft]);
    let stiffness = &found.parts[0].parameters[2];
    assert_eq!(stiffness.parameter, ModelParameter::Stiffness);
    assert!((stiffness.standard_error - 72.0_f64.sqrt()).abs() < 1e-12, "{stiffness:?}");
    assert!((stiffness.degrees_of_freedom - 120.0).abs() < 1e-9, "{stiffness:?}");
    assert!(stiffness.difference.0 < -60.0 && stiffness.difference.1 < 0.0);
    let test = found.parts[0].test.unwrap();
    assert_eq!(test.parameters, 3, "J_e counts as exact");
    assert!(test.adjusted_p_value > test.p_value && test.adjusted_p_value < 1e-6);
}

#[test]
fn exact_what_is_stated_or_shared_is_named() {
    let first = document(bench_a(), "a");
    let same = compare_models(&first, &first);
    assert!(!same.has_changed());
    assert_eq!(same.shared_recordings, ["a.mf4"]);
    assert!(same.different_constants.is_empty() && same.only_in_one.is_empty());
    let mut other = bench_a().with(ModelParameter::EngineInertia, 0.3);
    other.torque_limit_nm = Some(300.0);
    other.feed_forward = None;
    let found = compare_models(&first, &document(other, "b"));
    assert!(found.parts[0].has_changed(), "an exact inertia is another one");
    assert_eq!(found.parts[0].parameters[1].p_value, None);
    assert_eq!(found.different_constants, ["limit of the torque demand"]);
    assert_eq!(found.only_in_one, [ModelParameter::SpeedFeedForward, ModelParameter::AccelerationFeedForward]);
    assert!(found.parts.iter().all(|part| part.part != ComparedPart::FeedForward));
}
