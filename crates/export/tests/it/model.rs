//! The models that the tests export.

use bench_model::document::{BenchFileOrigin, BenchModelDocument, Provenance, Validity};
use bench_model::model::{
    AssembledModel, BenchModel, ModelParameter, ModelUncertainty, PartCovariance, TorqueControlModel,
};
use bench_testkit::models::bench_a;
use faer::Mat;
use ident::{FormulaStructure, GreyBoxModel, Label, LinearModel, ModelDocument};
use lti::{PolynomialEquation, PolynomialModel};
use rig::facts::{BenchFacts, BenchVariant};

/// A bench with a covariance and a range of validity.
pub(crate) fn document() -> BenchModelDocument {
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
    let assembled = AssembledModel {
        model: bench_a(),
        uncertainty: ModelUncertainty::new(&[shaft, controller]).expect("a covariance"),
        engine_pulses: None,
    };
    let mut document = BenchModelDocument::new(assembled, facts(), provenance());
    document.validity = Validity {
        dyno_speed_rad_s: Some((80.0, 260.0)),
        air_gap_torque_nm: Some((-50.0, 220.0)),
        frequency_hz: Some((0.5, 60.0)),
    };
    document
}

/// A bench whose delays and gate are no whole samples, and whose demand is late in the feed-forward.
pub(crate) fn late_demands() -> BenchModel {
    let mut model = document().model;
    let pi = model.speed_controller.as_mut().expect("a speed controller");
    (pi.delay_s, pi.demand_delay_s) = (1.37e-3, 3.37e-3);
    model.feed_forward.as_mut().expect("a feed-forward").delay_s = 1e-3;
    model.torque_control = Some(TorqueControlModel { delay_s: 0.71e-3, bandwidth_rad_s: None });
    model.encoder_gate_s = 2.4e-3;
    model
}

fn facts() -> BenchFacts {
    BenchFacts {
        name: "Test cell 4".into(),
        variant: BenchVariant::LoadCell,
        cylinders: 4,
        strokes: 4,
        dynamometer_inertia_kg_m2: 0.6,
        dynamometer_inertia_uncertainty_percent: None,
        engine_inertia_kg_m2: 0.28,
        engine_inertia_uncertainty_percent: None,
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

/// A discrete linear model, and what the program simulates with it from rest: inputs `u`, outputs `y`, and the response
/// `step` to a step of 2 at sample 100.
pub(crate) fn arx() -> (ModelDocument, serde_json::Value) {
    let equation = PolynomialEquation {
        a: vec![vec![-1.6, 0.68]],
        b: vec![vec![0.5, 0.3]],
        nk: vec![2],
        f: vec![Vec::new()],
        ..PolynomialEquation::default()
    };
    let model = PolynomialModel::new(1e-3, vec![equation], Mat::from_fn(1, 1, |_, _| 0.01)).expect("a model");
    let labels = |name: &str, unit: &str| vec![Label::new(name, unit)];
    let document = ModelDocument::new(model, labels("T_demand", "Nm"), labels("N_dyno \"1\"", "rpm"), 1e-3);
    let response = |u: &[f64]| {
        let form = document.model.innovations(1e-3, document.intersample).expect("a discrete form");
        let inputs = Mat::from_fn(u.len(), 1, |k, _| u[k]);
        let y = form.system().simulate(inputs.as_ref(), &vec![0.0; form.system().states()]).expect("a simulation");
        (0..u.len()).map(|k| y[(k, 0)]).collect::<Vec<f64>>()
    };
    let u: Vec<f64> = (0..300).map(|k| (f64::from(k) / 9.0).sin() + if k > 120 { 1.0 } else { 0.0 }).collect();
    let step: Vec<f64> = (0..300).map(|k| if k >= 100 { 2.0 } else { 0.0 }).collect();
    let rows = |series: &[f64]| series.iter().map(|value| vec![*value]).collect::<Vec<_>>();
    let expected = serde_json::json!({ "u": rows(&u), "y": rows(&response(&u)), "step": response(&step) });
    (document, expected)
}

/// A continuous linear model with a delay of 2.5 ms, ω_0 = 60 rad/s and ζ = 0.2, and its response to a step at 0.1 s.
pub(crate) fn oscillator() -> (ModelDocument, Vec<f64>) {
    let structure = serde_json::json!({
        "parameters": { "w": { "value": 60.0 }, "z": { "value": 0.2 } },
        "matrices": { "A": [["0", "1"], ["-w^2", "-2*z*w"]], "B": [["0"], ["w^2"]], "C": [["1", "0"]] },
        "input_delays_s": ["0.0025"]
    });
    let structure: FormulaStructure = serde_json::from_value(structure).expect("a structure");
    let model = GreyBoxModel::new(structure).expect("a model");
    let labels = |name: &str| vec![Label::new(name, "1")];
    let document = ModelDocument::new(model, labels("u"), labels("y"), 1e-3);
    let (w, z) = (60.0_f64, 0.2_f64);
    let damped = w * (1.0 - z * z).sqrt();
    let at = |t: f64| match t > 0.0 {
        true => 1.0 - (-z * w * t).exp() * ((damped * t).cos() + z * w / damped * (damped * t).sin()),
        false => 0.0,
    };
    (document, (0..300).map(|k| at(f64::from(k) * 1e-3 - 0.1025)).collect())
}
