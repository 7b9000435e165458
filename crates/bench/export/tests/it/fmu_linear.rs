//! FMUs and programs in C of linear models.

use export::fmu::{FmiVersion, linear_c_files, linear_fmu, model_in};
use export::names::Names;
use export::{ExportError, ExportedFile};
use faer::Mat;
use ident::{LinearModel, ModelDocument};
use lti::{PolynomialEquation, PolynomialModel};

use crate::fmu::{compiled, printed, text, unpacked};
use crate::model::{arx, document, oscillator};
use crate::others::{folder_with, largest, python};

const VERSION: &str = "0.1.0";

/// A model whose input acts at once.
fn at_once() -> ModelDocument {
    let (like, _) = arx();
    let equation = PolynomialEquation {
        a: vec![vec![-0.9]],
        b: vec![vec![0.5, -0.2]],
        nk: vec![0],
        f: vec![Vec::new()],
        ..PolynomialEquation::default()
    };
    let model = PolynomialModel::new(1e-3, vec![equation], Mat::from_fn(1, 1, |_, _| 0.01)).unwrap();
    ModelDocument::new(model, like.inputs.clone(), like.outputs.clone(), 1e-3)
}

/// Open-loop torque control of the test bench, with a covariance.
fn torques() -> ModelDocument {
    export::toolbox_models(&document()).unwrap().swap_remove(0).1
}

fn input(samples: usize, channels: usize) -> Mat<f64> {
    Mat::from_fn(samples, channels, |k, j| (k as f64 / (9.0 + 4.0 * j as f64)).sin() + if k > 120 { 1.0 } else { 0.0 })
}

/// Inputs, and what the program simulates from rest.
fn simulated(document: &ModelDocument, draws: usize) -> serde_json::Value {
    let u = input(300, document.inputs.len());
    let form = document.model.innovations(document.sample_time_s, document.intersample).unwrap();
    let y = form.system().simulate(u.as_ref(), &vec![0.0; form.system().states()]).unwrap();
    let rows = |m: &Mat<f64>| -> Vec<Vec<f64>> {
        (0..m.nrows()).map(|i| (0..m.ncols()).map(|j| m[(i, j)]).collect()).collect()
    };
    serde_json::json!({ "u": rows(&u), "y": rows(&y), "step": document.sample_time_s, "draws": draws })
}

fn made(document: &ModelDocument, version: FmiVersion) -> ExportedFile {
    linear_fmu(document, &Names::of("arx"), version, VERSION).unwrap()
}

#[test]
fn ref_fmpy_simulates_linear_models_as_the_program_does() {
    let models = [
        ("arx", arx().0, 0),
        ("at_once", at_once(), 0),
        ("oscillator", oscillator().0, 0),
        ("torques", torques(), 200),
    ];
    let file = |name: &str, document: &ModelDocument, version: FmiVersion, of: &str| ExportedFile {
        name: format!("{name}_{of}.fmu"),
        content: made(document, version).content,
    };
    let both = |(name, document, _): &(&str, ModelDocument, usize)| {
        [file(name, document, FmiVersion::V2, "fmi2"), file(name, document, FmiVersion::V3, "fmi3")]
    };
    let folder = folder_with("fmu_linear", &models.iter().flat_map(both).collect::<Vec<_>>());
    let case =
        |(name, document, draws): &(&str, ModelDocument, usize)| ((*name).to_owned(), simulated(document, *draws));
    let cases: serde_json::Map<String, serde_json::Value> = models.iter().map(case).collect();
    std::fs::write(folder.join("cases.json"), serde_json::Value::from(cases).to_string()).unwrap();
    if let Some(lines) = python("linear_fmu.py", &folder) {
        println!("{lines}");
        assert!(largest(&lines) < 1e-11, "{lines}");
    }
}

#[test]
fn exact_an_fmu_gives_its_model_back() {
    let document = arx().0;
    let archive = made(&document, FmiVersion::V3);
    assert_eq!(archive, made(&document, FmiVersion::V3));
    let read: ModelDocument = serde_json::from_str(&model_in(&archive.content).unwrap()).unwrap();
    assert_eq!(read.sample_time_s, document.sample_time_s);
    let whole = archive.content;
    for damaged in [&whole[..whole.len() / 2], &whole[..40], b"PK\x05\x06".as_slice(), b""] {
        assert_eq!(model_in(damaged), None);
    }
}

#[test]
fn exact_channels_of_one_name_and_odd_units_have_names_of_their_own() {
    let mut document = arx().0;
    document.inputs[0].name = document.outputs[0].name.clone();
    document.inputs[0].unit = "<&\"".to_owned();
    let archive = made(&document, FmiVersion::V2).content;
    let description = String::from_utf8_lossy(&archive).into_owned();
    assert!(
        description.contains("name=\"N_dyno &quot;1&quot;\"")
            && description.contains("name=\"N_dyno &quot;1&quot;_2\"")
    );
    assert!(description.contains("<Unit name=\"&lt;&amp;&quot;\"/>"));
}

#[test]
fn regress_a_model_with_too_many_states_is_refused() {
    let (like, _) = arx();
    let equation = PolynomialEquation {
        a: vec![Vec::new()],
        b: vec![vec![0.1; 1200]],
        nk: vec![1],
        f: vec![Vec::new()],
        ..PolynomialEquation::default()
    };
    let model = PolynomialModel::new(1e-3, vec![equation], Mat::from_fn(1, 1, |_, _| 0.01)).unwrap();
    let long = ModelDocument::new(model, like.inputs.clone(), like.outputs.clone(), 1e-3);
    let error = linear_fmu(&long, &Names::of("long"), FmiVersion::V2, VERSION).unwrap_err();
    assert!(matches!(error, ExportError::TooLarge { .. }), "{error}");
}

#[test]
fn ref_a_program_in_c_simulates_a_linear_model_as_the_program_does() {
    for (name, document) in [("c_arx", arx().0), ("c_torques", torques())] {
        let folder = folder_with(name, &linear_c_files(&document, &Names::of(name), VERSION).unwrap());
        let warnings = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror"];
        let example = format!("{name}_example.c");
        let Some(()) = compiled(&folder, &[&warnings[..], &[&example, "linear.c", "-o", "example"]].concat()) else {
            return;
        };
        let said = printed(&folder.join("example"), &[]);
        let form = document.model.innovations(document.sample_time_s, document.intersample).unwrap();
        let u = Mat::from_fn(200, document.inputs.len(), |k, j| if j == 0 && k >= 10 { 1.0 } else { 0.0 });
        let y = form.system().simulate(u.as_ref(), &vec![0.0; form.system().states()]).unwrap();
        let (mut most, mut size) = (0.0_f64, 0.0_f64);
        for (k, line) in said.lines().enumerate() {
            for (i, text) in line.split(' ').skip(1).enumerate() {
                most = most.max((text.parse::<f64>().unwrap() - y[(k, i)]).abs());
                size = size.max(y[(k, i)].abs());
            }
        }
        println!("{name} in C {:e}", most / size);
        assert_eq!(said.lines().count(), 200);
        assert!(most <= 1e-12 * size, "{most:e} of {size:e}");
    }
}

/// Levels that were taken off the data, and units that an importer can convert.
#[test]
fn exact_levels_and_units_are_in_the_description() {
    let (mut model, _) = arx();
    let line = |level| vec![ident::Line::level(level)];
    model.trend = Some(ident::Trend::per_experiment(vec![line(19.87)], vec![line(82.55)]).unwrap());
    for version in [FmiVersion::V2, FmiVersion::V3] {
        let files = unpacked(&made(&model, version).content);
        let description = text(&files, "modelDescription.xml");
        assert!(description.contains("Levels of the inputs: 19.87; of the outputs: 82.55"), "{description}");
        assert!(description.contains("difference from the level 19.87 Nm"), "{description}");
        assert!(description.contains("difference from the level 82.55 rpm"), "{description}");
        assert!(
            description.contains("<Unit name=\"Nm\"><BaseUnit kg=\"1\" m=\"2\" s=\"-2\"/></Unit>"),
            "{description}"
        );
        let rpm = "<Unit name=\"rpm\"><BaseUnit s=\"-1\" rad=\"1\" factor=\"0.10471975511965977\"/></Unit>";
        assert!(description.contains(rpm), "{description}");
        let page = text(&files, "documentation/index.html");
        assert!(page.contains("19.87 Nm") && page.contains("Levels of the inputs: 19.87"), "{page}");
    }
    let absolute = text(&unpacked(&made(&arx().0, FmiVersion::V3).content), "modelDescription.xml");
    assert!(!absolute.contains("level"), "{absolute}");
}
