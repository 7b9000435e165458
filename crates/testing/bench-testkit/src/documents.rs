//! Model files of known benches, and results that are written and read.

use std::fmt::Debug;

use bench_model::document::{BenchFileOrigin, BenchModelDocument, Provenance, ResultError, ResultFormat, Validity};
use bench_model::model::{AssembledModel, BenchModel, ModelParameter, ModelUncertainty, PartCovariance};
use rig::facts::{BenchFacts, BenchVariant};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::schemas::assert_valid_by_format;

/// A model as a study writes it: with the covariance of its shaft and its speed controller, and a range of validity.
pub fn of_model(model: BenchModel) -> BenchModelDocument {
    let shaft = PartCovariance {
        parameters: vec![ModelParameter::Stiffness, ModelParameter::Damping],
        covariance: vec![vec![36.0, 0.3], vec![0.3, 0.04]],
        degrees_of_freedom: 40.0,
    };
    let controller = PartCovariance {
        parameters: vec![ModelParameter::Proportional, ModelParameter::Integral, ModelParameter::ControllerDelay],
        covariance: vec![vec![1e-4, 2e-5, 0.0], vec![2e-5, 4e-4, 0.0], vec![0.0, 0.0, 1e-10]],
        degrees_of_freedom: f64::INFINITY,
    };
    let uncertainty = ModelUncertainty::new(&[shaft, controller]).expect("a covariance");
    let assembled = AssembledModel { model, uncertainty, engine_pulses: None, disturbances: None, dyno_friction: None };
    let mut document = BenchModelDocument::new(assembled, facts(), provenance());
    document.validity = Validity {
        dyno_speed_rad_s: Some((80.0, 260.0)),
        air_gap_torque_nm: Some((-50.0, 220.0)),
        frequency_hz: Some((0.5, 60.0)),
    };
    document
}

fn facts() -> BenchFacts {
    BenchFacts {
        name: "Test cell 4".into(),
        variant: BenchVariant::LoadCell,
        cylinders: 4,
        strokes: 4,
        dynamometer_inertia_kg_m2: 0.6,
        dynamometer_inertia_uncertainty_percent: Some(1.0),
        engine_inertia_kg_m2: 0.28,
        engine_inertia_uncertainty_percent: Some(2.0),
        torque_limit_nm: Some(400.0),
        shaft_torque_limit_nm: Some(350.0),
        speed_limit_rad_s: Some(628.0),
    }
}

fn provenance() -> Provenance {
    Provenance {
        dynoid_version: "0.1.0".into(),
        date: "2026-05-03".into(),
        bench_file: BenchFileOrigin { name: "bench.toml".into(), sha256: "0".repeat(64) },
        recordings: Vec::new(),
        seed: None,
        verdict: None,
    }
}

/// Holds a result to what its document promises: it has the form of its schema, it is read and written again as it was
/// written, another version is refused, and the error on a damaged number names its place. Returns the result that is
/// read.
pub fn read_back<T: Serialize + DeserializeOwned + Debug>(format: &ResultFormat<T>, result: &T) -> T {
    let text = format.json(result).unwrap();
    assert_valid_by_format(&serde_json::from_str(&text).unwrap());
    let read = format.read(&text).unwrap_or_else(|error| panic!("{error} in {text}"));
    assert_eq!(format.json(&read).unwrap(), text);
    let other = text.replacen("\"format_version\":1", "\"format_version\":99", 1);
    assert!(matches!(format.read(&other), Err(ResultError::OtherVersion { found: 99, .. })));
    let renamed = text.replacen(format.format(), "another", 1);
    assert!(matches!(format.read(&renamed), Err(ResultError::OtherFormat { found: Some(_), .. })));
    let fault = format.read(&with_a_damaged_number(&text)).unwrap_err();
    assert!(matches!(&fault, ResultError::Damaged { .. }) && fault.to_string().contains("`result"), "{fault}");
    read
}

/// The text with the word “damaged” in place of its last number.
fn with_a_damaged_number(text: &str) -> String {
    let is_number = |c: char| c.is_ascii_digit() || "+-.e".contains(c);
    let end = text.rfind(|c: char| c.is_ascii_digit()).unwrap() + 1;
    let start = text[..end].rfind(|c: char| !is_number(c)).unwrap() + 1;
    format!("{}\"damaged\"{}", &text[..start], &text[end..])
}
