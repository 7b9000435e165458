//! Models on recordings, and what a model is like.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use dynoid::linear::{ResponseOptions, dynamics};
use dynoid::{Files, Meeting};
use serde_json::{Value, json};
use work::Context;

/// Sample of the recording that does not follow the model, and by how much.
const ODD_SAMPLE: usize = 150;
const ODD_BY: f64 = 0.25;

/// A model of `y(t) = 0.5 y(t−1) + u(t−1)`, without an estimate.
fn model(folder: &Path) -> PathBuf {
    let equation = json!({ "a": [[-0.5]], "b": [[1.0]], "c": [], "d": [], "f": [[]], "nk": [1] });
    let value = json!({ "equations": [equation], "noise_covariance": [[0.01]], "sample_time_s": 0.1 });
    let label = |name: &str| json!([{ "name": name, "unit": "" }]);
    let document = json!({
        "format": "dynoid model", "version": 1, "model": { "kind": "polynomial", "value": value },
        "inputs": label("u"), "outputs": label("y"), "intersample": "zero_order_hold", "sample_time_s": 0.1
    });
    let path = folder.join("lag.json");
    std::fs::write(&path, document.to_string()).unwrap();
    path
}

/// A recording that follows the model, but for one sample.
fn recording(folder: &Path) -> PathBuf {
    let (mut text, mut y, mut u) = ("t [s],u,y\n".to_owned(), 0.0, 0.0);
    for k in 0..200 {
        y = 0.5 * y + u;
        u = if (k * k / 7) % 3 == 0 { -1.0 } else { 1.0 };
        let measured = if k == ODD_SAMPLE { y + ODD_BY } else { y };
        writeln!(text, "{},{u},{measured}", k as f64 / 10.0).unwrap();
    }
    let path = folder.join("run.csv");
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn exact_a_residual_is_measured_less_modelled() {
    let folder = tempfile::tempdir().unwrap();
    let (model, recording) = (model(folder.path()), recording(folder.path()));
    let files = Files::new("test", false);
    let met = Meeting::of(&model, &recording, ResponseOptions::default(), &files, &Context::new()).unwrap();
    let channel = |name: &str| met.beside().channels.iter().find(|channel| channel.name == name).unwrap();
    let residual = &channel("y_residual").samples;
    assert_eq!((residual.len(), channel("y_measured").samples.len()), (200, 200));
    for (k, value) in residual.iter().enumerate() {
        let expected = if k == ODD_SAMPLE { ODD_BY } else { 0.0 };
        // The initial state is fitted to the odd sample too, which is far from it.
        assert!((value - expected).abs() < 1e-9, "{k}: {value}");
    }
    let facts: Value = serde_json::to_value(met.facts()).unwrap();
    assert_eq!(facts["seen_in_estimation"], false);
    assert!(facts["signals"][0]["fit_percent"].as_f64().unwrap() > 98.0, "{facts}");
    assert!(facts["residuals"]["whiteness"][0]["auto"].is_array());
}

#[test]
fn exact_dynamics_are_those_of_the_formula() {
    let folder = tempfile::tempdir().unwrap();
    let found = dynamics(&model(folder.path()), 0.95, &Files::new("test", false)).unwrap();
    let found: Value = serde_json::to_value(found).unwrap();
    let near = |value: &Value, expected: f64| (value.as_f64().unwrap() - expected).abs() < 1e-9;
    assert!(near(&found["roots"][0]["poles"][0]["roots"][0]["re"], 0.5), "{found}");
    let step = &found["step"][0]["quantities"][0]["values"];
    // 0, 1, 1.5, 1.75: to 1/(1 − 0.5).
    assert!([0.0, 1.0, 1.5, 1.75].iter().enumerate().all(|(k, expected)| near(&step[k], *expected)), "{step}");
    assert_eq!(found["regions"], json!([]), "a model without an estimate has no regions");
}
