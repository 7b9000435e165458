//! Model files of known benches.

use bench_model::document::{BenchFileOrigin, BenchModelDocument, Provenance, Validity};
use bench_model::model::{AssembledModel, BenchModel, ModelParameter, ModelUncertainty, PartCovariance};
use rig::facts::{BenchFacts, BenchVariant};

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
