//! The bench model as a file.

use bench_model::disturbances::Disturbances;
use bench_model::document::{
    BenchFileOrigin, BenchModelDocument, DocumentError, NotEstimated, Provenance, Validity, format_of,
};
use bench_model::drive_ripple::RippleLine;
use bench_model::model::{AssembledModel, ModelParameter, ModelUncertainty, PartCovariance};
use bench_model::skews::SignalSkews;
use bench_testkit::models::bench_a;
use proptest::prelude::*;
use rig::dyno_friction::EstimatedFriction;
use rig::engine_pulses::EnginePulses;
use rig::facts::{BenchFacts, BenchVariant, Engine};
use rig::results::Part;

fn document(stiffness_variance: f64, degrees_of_freedom: f64) -> BenchModelDocument {
    let part = PartCovariance {
        parameters: vec![ModelParameter::Stiffness, ModelParameter::Damping],
        covariance: vec![
            vec![stiffness_variance, 0.1 * stiffness_variance.sqrt()],
            vec![0.1 * stiffness_variance.sqrt(), 0.25],
        ],
        degrees_of_freedom,
    };
    let uncertainty = ModelUncertainty::new(&[part]).unwrap();
    let facts = BenchFacts {
        name: "Test cell 4".into(),
        variant: BenchVariant::LoadCell,
        cylinders: 4,
        strokes: 4,
        dynamometer_inertia_kg_m2: 0.6,
        dynamometer_inertia_uncertainty_percent: Some(0.0),
        engine_inertia_kg_m2: 0.28,
        engine_inertia_uncertainty_percent: None,
        torque_limit_nm: Some(400.0),
        shaft_torque_limit_nm: None,
        speed_limit_rad_s: Some(628.3),
    };
    let provenance = Provenance {
        dynoid_version: "0.1.0".into(),
        date: "2026-05-03".into(),
        bench_file: BenchFileOrigin { name: "bench.toml".into(), sha256: "00".into() },
        recordings: Vec::new(),
        seed: Some(7),
        verdict: None,
    };
    let document = BenchModelDocument::new(
        AssembledModel { model: bench_a(), uncertainty, engine_pulses: None, disturbances: None, dyno_friction: None },
        facts,
        provenance,
    );
    let mut document = document.with_intervals(|one| match one.parameter {
        ModelParameter::Stiffness => Some((2400.25, 2450.5)),
        ModelParameter::Damping => Some((f64::NEG_INFINITY, f64::INFINITY)),
        _ => None,
    });
    document.validity.dyno_speed_rad_s = Some((80.0, 260.0));
    document.skews = Some(SignalSkews { engine_speed_s: 1e-4, torque_s: 2.5e-3 });
    document.not_estimated = vec![NotEstimated { part: Part::FeedForward, needs: "a recording".into() }];
    document
}

proptest! {
    #[test]
    fn prop_a_document_is_read_back_bit_for_bit(variance in 1e-9_f64..1e9, degrees in prop_oneof![Just(f64::INFINITY), 1.0_f64..1e6]) {
        let document = document(variance, degrees);
        prop_assert_eq!(BenchModelDocument::from_json(&document.to_json().unwrap()), Ok(document));
    }
}

#[test]
fn regress_friction_is_read_back_bit_for_bit_and_impossible_one_is_refused() {
    let mut document = document(36.0, 40.0);
    let friction = EstimatedFriction {
        coulomb_nm: 1.1,
        viscous_nm_s_per_rad: 0.013,
        covariance: [[0.01, -1e-5], [-1e-5, 1e-7]],
        speeds_rad_s: (5.0, 260.0),
        recordings: vec!["NoShaft_N_NT.mf4".into()],
    };
    document.dyno_friction = Some(friction.clone());
    assert_eq!(document.assembled().dyno_friction, Some(friction.clone()));
    assert_eq!(BenchModelDocument::from_json(&document.to_json().unwrap()), Ok(document.clone()));
    let refused = |damage: fn(&mut EstimatedFriction)| {
        let (mut document, mut damaged) = (document.clone(), friction.clone());
        damage(&mut damaged);
        document.dyno_friction = Some(damaged);
        BenchModelDocument::from_json(&document.to_json().unwrap()).unwrap_err().to_string()
    };
    assert!(refused(|one| one.coulomb_nm = -1.0).contains("`dyno_friction` drives"));
    assert!(refused(|one| one.coulomb_nm = 1e9).contains("`dyno_friction.coulomb_nm`"));
    assert!(refused(|one| one.speeds_rad_s = (300.0, 260.0)).contains("`dyno_friction.speeds_rad_s`"));
    assert!(refused(|one| one.viscous_nm_s_per_rad = 1e9).contains("`dyno_friction.viscous_nm_s_per_rad`"));
    for covariance in [[[0.01, 1.0], [1.0, 1e-7]], [[-0.01, 0.0], [0.0, 1e-7]], [[0.01, 1e-5], [-1e-5, 1e-7]]] {
        let mut document = document.clone();
        document.dyno_friction = Some(EstimatedFriction { covariance, ..friction.clone() });
        let error = BenchModelDocument::from_json(&document.to_json().unwrap()).unwrap_err().to_string();
        assert!(error.contains("`dyno_friction.covariance`"), "{error}");
    }
}

#[test]
fn regress_pulses_are_read_back_bit_for_bit_and_impossible_ones_are_refused() {
    let mut document = document(36.0, 40.0);
    let pulses = EnginePulses::prior(Engine { cylinders: 3, strokes: 4 }, 0.3);
    document.engine_pulses = Some(pulses.clone());
    assert_eq!(BenchModelDocument::from_json(&document.to_json().unwrap()), Ok(document.clone()));
    let refused = |damage: fn(&mut EnginePulses)| {
        let mut document = document.clone();
        let mut damaged = pulses.clone();
        damage(&mut damaged);
        document.engine_pulses = Some(damaged);
        BenchModelDocument::from_json(&document.to_json().unwrap()).unwrap_err().to_string()
    };
    for (damage, field) in [
        ((|p| p.strokes = 0) as fn(&mut EnginePulses), "engine_pulses.strokes"),
        (|p| p.cylinders = 0, "engine_pulses.cylinders"),
        (|p| p.engine_inertia_kg_m2 = -0.3, "engine_pulses.engine_inertia_kg_m2"),
        (|p| p.cycle_variation = 2.0, "engine_pulses.cycle_variation"),
        (|p| p.harmonics.clear(), "engine_pulses.harmonics"),
        (|p| p.harmonics[1].order = 7.0, "engine_pulses.harmonics.order"),
        (|p| p.harmonics[1].covariance[0][0] = -1.0, "engine_pulses.harmonics.covariance"),
        (|p| p.harmonics[1].covariance[0][1] = 1e308, "engine_pulses.harmonics.covariance"),
    ] {
        let error = refused(damage);
        assert!(error.contains(&format!("`{field}`")), "{field}: {error}");
    }
}

#[test]
fn exact_parameters_have_symbol_unit_and_standard_error() {
    let document = document(36.0, 40.0);
    let of = |which| document.parameters().iter().find(|one| one.parameter == which).unwrap();
    let stiffness = of(ModelParameter::Stiffness);
    assert_eq!((stiffness.symbol.as_str(), stiffness.unit.as_str()), ("K", "Nm/rad"));
    assert_eq!(
        (stiffness.value, stiffness.standard_error, stiffness.degrees_of_freedom),
        (2437.7, Some(6.0), Some(40.0))
    );
    assert_eq!(of(ModelParameter::DynoInertia).standard_error, None, "taken as exact");
    assert_eq!(stiffness.interval_95, Some((2400.25, 2450.5)));
    assert_eq!(of(ModelParameter::Damping).interval_95, None, "JSON has no infinity");
    let symbols: std::collections::BTreeSet<_> = document.parameters().iter().map(|one| &one.symbol).collect();
    assert_eq!((symbols.len(), document.parameters().len()), (11, 11), "each has a symbol of its own");
}

#[test]
fn exact_what_is_not_there_is_left_out() {
    let mut assembled = document(1.0, 3.0).assembled();
    assembled.model.speed_controller = None;
    assembled.model.feed_forward = None;
    let whole = document(1.0, 3.0);
    let without = BenchModelDocument::new(assembled, whole.bench.clone(), whole.provenance.clone());
    assert_eq!(without.parameters().len(), 6);
    assert_eq!(without.validity, Validity::default());
    assert!(BenchModelDocument::from_json(&without.to_json().unwrap()).is_ok());
}

#[test]
fn exact_fields_of_later_versions_of_the_same_layout_are_passed_over() {
    let text = document(1.0, 3.0).to_json().unwrap().replacen('{', "{\n  \"colour\": \"green\",", 1);
    assert_eq!(BenchModelDocument::from_json(&text), Ok(document(1.0, 3.0)));
}

#[test]
fn regress_other_kinds_later_versions_and_contradictions_are_refused() {
    let text = document(36.0, 40.0).to_json().unwrap();
    let error = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        BenchModelDocument::from_json(&text.replacen(from, to, 1)).unwrap_err()
    };
    assert_eq!(error("dynoid bench model", "dynoid model"), DocumentError::Format { found: "dynoid model".into() });
    assert_eq!(error("\"version\": 1", "\"version\": 2"), DocumentError::Version { found: 2, known: 1 });
    assert!(matches!(error("{", "["), DocumentError::Content { .. }));
    let contradiction = error("\"stiffness_nm_per_rad\": 2437.7", "\"stiffness_nm_per_rad\": 2500.0").to_string();
    assert!(contradiction.contains("2437.7") && contradiction.contains("2500"), "{contradiction}");
    let impossible = error("\"stiffness_nm_per_rad\": 2437.7", "\"stiffness_nm_per_rad\": -1.0").to_string();
    assert!(
        impossible.contains("`model.mechanics.stiffness_nm_per_rad` is -1, and a bench has 0.01 to 1e10 Nm/rad;"),
        "{impossible}"
    );
    let gate = error("\"encoder_gate_s\": 0.001", "\"encoder_gate_s\": -0.001").to_string();
    assert!(gate.contains("`model.encoder_gate_s` is -0.001, and a bench has 0 to 1 s;"), "{gate}");
    let twice = text.replace("      \"damping\"\n", "      \"stiffness\"\n");
    assert!(BenchModelDocument::from_json(&twice).unwrap_err().to_string().contains("stiffness twice"), "{twice}");
    let strange = BenchModelDocument::from_json(&text.replacen("36.0", "-36.0", 1)).unwrap_err().to_string();
    assert!(strange.contains("`uncertainty[0].covariance[0]` has a negative variance"), "{strange}");
}

/// Numbers that a computer cannot compute with, and no bench has: by field, with the value and the possible range.
#[test]
fn regress_sizes_that_no_bench_has_are_refused() {
    let text = document(36.0, 40.0).to_json().unwrap();
    let read = |text: &str| BenchModelDocument::from_json(text);
    let changed = |pairs: &[(&str, &str)]| {
        let changed = pairs.iter().fold(text.clone(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        });
        read(&changed).unwrap_err().to_string()
    };
    let row = |entries: [f64; 2]| format!("[\n          {:?},\n          {:?}\n        ]", entries[0], entries[1]);
    let correlated = 0.1 * 36.0_f64.sqrt();
    let (first, second) = (row([36.0, correlated]), row([correlated, 0.25]));
    for (pairs, expected) in [
        (
            &[("\"dyno_inertia_kg_m2\": 0.6", "\"dyno_inertia_kg_m2\": 1e-300")][..],
            "`model.mechanics.dyno_inertia_kg_m2` is 1e-300, and a bench has 1e-6 to 1000000 kg m²;",
        ),
        (
            &[("\"encoder_gate_s\": 0.001", "\"encoder_gate_s\": 1e9")],
            "`model.encoder_gate_s` is 1e9, and a bench has 0 to 1 s;",
        ),
        (
            &[("\"encoder_gate_s\": 0.001", "\"encoder_gate_s\": 0.9")],
            "`model.encoder_gate_s` is 0.9 s, and lasts at most 250 samples",
        ),
        (
            &[("\"sample_time_s\": 0.001", "\"sample_time_s\": 1e-12")],
            "`model.speed_controller.sample_time_s` is 1e-12, and a bench has 1e-5 to 1 s;",
        ),
        (&[("36.0", "1e308")], "a standard error of 1e154 for stiffness"),
        (&[("\"strokes\": 4", "\"strokes\": 0")], "`bench.strokes` is 0, and an engine has 2 or 4;"),
        (
            &[("80.0,\n      260.0", "260.0,\n      80.0")],
            "the low end of `validity.dyno_speed_rad_s` is above its high end;",
        ),
        (&[("2400.25,\n        2450.5", "2450.5,\n        2400.25")], "`parameters` has stiffness with a negative"),
        (
            &[(first.as_str(), "[36.0, 3.1]"), (second.as_str(), "[3.1, 0.25]")],
            "`uncertainty[0].covariance` is not symmetric, or too large",
        ),
    ] {
        let message = changed(pairs);
        assert!(message.contains(expected), "{message}\nnot: {expected}");
        assert!(message.contains("let `dynoid study bench.toml` write"), "{message}");
    }
    let begin = text.find("\"parameters\": [").unwrap() + "\"parameters\": [".len();
    let end = text.find("\n  ],\n  \"model\"").unwrap();
    let none = read(&format!("{}{}", &text[..begin], &text[end..])).unwrap_err().to_string();
    assert!(none.contains("`parameters` has inertia of the dynamometer 0 times, and each once;"), "{none}");
}

/// Correlations of −0.9 between each two of three numbers: of two a covariance can have them, of three it cannot.
#[test]
fn regress_correlations_that_contradict_each_other_are_refused() {
    let of = |correlation: f64| {
        let variances = [36.0_f64, 0.25, 1e-6];
        let entry = |i: usize, j: usize| (variances[i] * variances[j]).sqrt() * if i == j { 1.0 } else { correlation };
        let part = PartCovariance {
            parameters: vec![ModelParameter::Stiffness, ModelParameter::Damping, ModelParameter::DynoInertia],
            covariance: (0..3).map(|i| (0..3).map(|j| entry(i, j)).collect()).collect(),
            degrees_of_freedom: 40.0,
        };
        let uncertainty = ModelUncertainty::new(&[part]).unwrap();
        let assembled = AssembledModel {
            model: bench_a(),
            uncertainty,
            engine_pulses: None,
            disturbances: None,
            dyno_friction: None,
        };
        let whole = document(1.0, 3.0);
        BenchModelDocument::from_json(
            &BenchModelDocument::new(assembled, whole.bench, whole.provenance).to_json().unwrap(),
        )
    };
    assert!(of(-0.49).is_ok() && of(1.0).is_ok());
    let message = of(-0.9).unwrap_err().to_string();
    assert!(message.contains("`uncertainty[0].covariance` is no covariance"), "{message}");
    assert!(message.contains("-0.8") && message.contains("let `dynoid study bench.toml` write"), "{message}");
}

/// Each fault by line, field as the file has it, and what is wrong; no words of the reader of JSON, and no names of
/// Rust.
#[test]
fn regress_faults_are_stated_in_the_words_of_the_file() {
    let text = document(36.0, 40.0).to_json().unwrap();
    let said = |text: &str| BenchModelDocument::from_json(text).unwrap_err().to_string();
    let changed = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        said(&text.replacen(from, to, 1))
    };
    let stiffness = "\"stiffness_nm_per_rad\": 2437.7";
    let cut = text.find(stiffness).unwrap() + stiffness.len() - 2;
    let line = text[..cut].lines().count();
    let field = "`model.mechanics.stiffness_nm_per_rad`";
    for (message, expected) in [
        (said(" \n"), "the file is empty;".to_owned()),
        (said(&text[..cut]), format!("the file ends in the middle, in {field};")),
        (changed(stiffness, "\"stiffness_nm_per_rad\": NaN"), format!("line {line}, {field}: `NaN` is no value;")),
        (
            changed(stiffness, "\"stiffness_nm_per_rad\": -Infinity"),
            format!("line {line}, {field}: `Infinity` is no value;"),
        ),
        (
            changed(stiffness, "\"stiffness_nm_per_rad\": 1e400"),
            format!("line {line}, {field}: this number is too large;"),
        ),
        (
            changed(stiffness, "\"stiffness_nm_per_rad\": \"2 kNm\""),
            format!("line {line}, {field}: the text \"2 kNm\", where a number is needed;"),
        ),
        (
            changed(stiffness, "\"stiff\": 2437.7"),
            "`model.mechanics`: the field `stiffness_nm_per_rad` is missing;".to_owned(),
        ),
        (changed("\"uncertainty\"", "\"covariances\""), ": the field `uncertainty` is missing;".to_owned()),
        (
            changed("\"version\": 1", "\"version\": \"1\""),
            "line 3, `version`: the text \"1\", where a whole number".to_owned(),
        ),
        (
            changed("\"parameter\": \"stiffness\"", "\"parameter\": \"K\""),
            "`parameters[2].parameter`: `K` is unknown here; write ".to_owned(),
        ),
        (changed("        36.0,\n", ""), "`uncertainty[0].covariance` has 2 rows of 1 numbers".to_owned()),
        (
            changed(
                "\"degrees_of_freedom\": 40.0\n    }\n  ],\n  \"skews\"",
                "\"degrees_of_freedom\": -3.0\n    }\n  ],\n  \"skews\"",
            ),
            "`uncertainty[0].degrees_of_freedom` is -3,".to_owned(),
        ),
        (
            changed("36.0,\n          0.6", "36.0,\n          0.7"),
            "`uncertainty[0].covariance` is not symmetric".to_owned(),
        ),
    ] {
        assert!(message.contains(&expected), "{message}\nnot: {expected}");
        assert!(message.contains("let `dynoid study bench.toml` write it again"), "{message}");
        for strange in ["EOF", "expected", "invalid type", "f64", "Stiffness", "at line"] {
            assert!(!message.contains(strange), "{message}");
        }
    }
}

#[test]
fn exact_the_format_is_seen_in_a_file_that_is_cut() {
    let text = document(36.0, 40.0).to_json().unwrap();
    assert_eq!(format_of(&text[..text.len() / 2]).as_deref(), Some("dynoid bench model"));
    assert_eq!(format_of("{\"a\": 1, \"format\": \"dynoid model\"}").as_deref(), Some("dynoid model"));
}

#[test]
fn exact_the_format_is_seen_without_the_rest() {
    assert_eq!(format_of("{\"format\": \"dynoid model\", \"x\": 1}").as_deref(), Some("dynoid model"));
    assert!(format_of("[]").is_none() && format_of("format").is_none());
    assert!(BenchModelDocument::is_format("dynoid bench model") && !BenchModelDocument::is_format("dynoid model"));
}

#[test]
fn exact_validity_contains_its_ends() {
    let validity = Validity { air_gap_torque_nm: Validity::range_of([3.0, f64::NAN, -2.0]), ..Validity::default() };
    assert_eq!(validity.air_gap_torque_nm, Some((-2.0, 3.0)));
    assert!(validity.contains(1e9, -2.0) && validity.contains(0.0, 3.0) && !validity.contains(0.0, 3.1));
    assert_eq!(Validity::range_of([]), None);
}

#[test]
fn regress_disturbances_are_read_back_bit_for_bit_and_impossible_ones_are_refused() {
    let line = RippleLine { frequency_hz: 100.0, additive_nm: [0.3, 0.4], relative: [0.01, 0.02] };
    let disturbances = Disturbances { ripple: Some(line), ..Disturbances::assumed() };
    let with = |disturbances| {
        let mut document = document(36.0, 40.0);
        document.disturbances = Some(disturbances);
        (BenchModelDocument::from_json(&document.to_json().unwrap()), document)
    };
    let (read, written) = with(disturbances);
    assert_eq!(read, Ok(written));
    let silent = RippleLine { frequency_hz: 0.0, ..line };
    for (damaged, field) in [
        (Disturbances { speed_noise_rad_s: -1.0, ..disturbances }, "speed_noise_rad_s"),
        (Disturbances { once_a_turn: 2.0, ..disturbances }, "once_a_turn"),
        (Disturbances { ripple: Some(silent), ..disturbances }, "ripple.frequency_hz"),
    ] {
        let error = with(damaged).0.unwrap_err().to_string();
        assert!(error.contains(field), "{error}");
    }
}
