//! The models that the tests export.

use bench_model::document::BenchModelDocument;
use bench_model::model::{BenchModel, TorqueControlModel};
use bench_testkit::documents;
use bench_testkit::models::bench_a;
use faer::Mat;
use ident::{FormulaStructure, GreyBoxModel, Label, LinearModel, ModelDocument};
use lti::{PolynomialEquation, PolynomialModel};

/// A bench with a covariance and a range of validity.
pub(crate) fn document() -> BenchModelDocument {
    documents::of_model(bench_a())
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
