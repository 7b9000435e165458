//! The Python module.

use bench_model::document::BenchModelDocument;
use bench_model::model::{AssembledModel, BenchModel};
use export::names::Names;
use export::python;

use crate::cases::{Case, Drive};
use crate::model::{arx, document, late_demands};
use crate::others::{folder_with, largest, python as run};

fn with_model(model: BenchModel) -> BenchModelDocument {
    let whole = document();
    let uncertainty = Default::default();
    BenchModelDocument::new(
        AssembledModel { model, uncertainty, engine_pulses: None, disturbances: None, dyno_friction: None },
        whole.bench.clone(),
        whole.provenance.clone(),
    )
}

/// Difference between Python's simulation of a bench and the program's; `None` without Python.
fn difference(name: &str, document: &BenchModelDocument, drives: &[Drive]) -> Option<f64> {
    let model = &document.model;
    let module = python::bench(document, &Names::of("Test cell 4"));
    let folder = folder_with(name, &[module]);
    let cases: Vec<serde_json::Value> = drives.iter().map(|drive| Case::about(model, *drive).json(model)).collect();
    if drives.contains(&Drive::Speed) && model.torque_limit_nm.is_some() {
        assert!(cases[0]["limited_share"].as_f64() > Some(0.001), "the limit is met");
    }
    std::fs::write(folder.join("cases.json"), serde_json::to_string(&cases).unwrap()).unwrap();
    run("simulate.py", &folder).map(|lines| largest(&lines))
}

#[test]
fn ref_python_simulates_as_the_program_does() {
    let drives = [Drive::Speed, Drive::Torque, Drive::AirGap, Drive::Governed];
    if let Some(difference) = difference("python_whole", &document(), &drives) {
        assert!(difference < 1e-9, "{difference:e}");
    }
}

#[test]
fn ref_python_has_fractional_delays_gates_and_late_demands() {
    let drives = [Drive::Speed, Drive::Torque, Drive::Governed];
    if let Some(difference) = difference("python_fractions", &with_model(late_demands()), &drives) {
        assert!(difference < 1e-9, "{difference:e}");
    }
}

#[test]
fn ref_python_has_a_bench_without_controllers() {
    let model = BenchModel { speed_controller: None, feed_forward: None, torque_control: None, ..document().model };
    let bare = BenchModel { encoder_gate_s: 0.0, ..model };
    if let Some(difference) = difference("python_bare", &with_model(bare), &[Drive::AirGap]) {
        assert!(difference < 1e-9, "{difference:e}");
    }
}

#[test]
fn ref_python_draws_from_the_covariance_and_tells_the_range() {
    let folder = folder_with("python_draws", &[python::bench(&document(), &Names::of("Test cell 4"))]);
    if let Some(lines) = run("draws.py", &folder) {
        assert!(lines.contains("draws agree") && lines.contains("range agrees"), "{lines}");
    }
}

#[test]
fn ref_python_simulates_linear_models() {
    let (model, expected) = arx();
    let module = python::linear(&model, &Names::of("arx"), "0.1.0").unwrap();
    let folder = folder_with("python_linear", &[module]);
    std::fs::write(folder.join("expected.json"), serde_json::to_string(&expected).unwrap()).unwrap();
    if let Some(lines) = run("linear.py", &folder) {
        assert!(largest(&lines) < 1e-12, "{lines}");
    }
}

#[test]
fn exact_the_module_names_the_program_first() {
    let text = String::from_utf8(python::bench(&document(), &Names::of("Test cell 4")).content).unwrap();
    assert!(text.lines().next().unwrap().contains("Written by dynoid 0.1.0"), "{text}");
    assert!(!["@TITLE@", "@MODULE@", "@EXAMPLE@"].iter().any(|place| text.contains(place)), "every place is filled");
    let mut odd = document();
    odd.bench.name = "a\"\"\" b\\ \n c".into();
    odd.provenance.date = "2026-05-03\n\"\"\"\nimport os".into();
    let text = String::from_utf8(python::bench(&odd, &Names::of("x")).content).unwrap();
    assert_eq!(text.matches("\"\"\"").count() % 2, 0, "the first string ends where it should");
    assert!(text.starts_with(
        "\"\"\"Bench model “a''' b' c”. Written by dynoid 0.1.0 from the bench model of 2026-05-03importos."
    ));
}
