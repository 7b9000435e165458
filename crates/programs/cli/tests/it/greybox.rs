//! `dynoid fit greybox`: physical parameters from a structure in a file.

use faer::{Mat, mat};
use lti::StateSpace;
use tempfile::TempDir;

use crate::support::{Ran, dynoid};

const STRUCTURE: &str = r#"
[parameters]
J_e = { value = 0.5, min = 0.01, max = 10 }
J_d = { value = 0.6, fixed = true }
K = { value = 1500, min = 0 }
B = { value = 3, min = 0 }

[matrices]
A = [["-B/J_d", "B/J_d", "-K/J_d"],
     ["B/J_e", "-B/J_e", "K/J_e"],
     [1, -1, 0]]
B = [["1/J_d"], [0], [0]]
C = [[1, 0, 0], [0, 1, 0]]

[derived]
resonance_hz = "sqrt(K*(1/J_d + 1/J_e))/(2*pi)"
"#;

const TRUTH: [f64; 4] = [0.28, 0.6, 2437.7, 4.2];
const FIT: &str = "fit greybox shaft.toml run.csv -u T -y w_d -y w_e --detrend none";

/// A folder with the structure and a recording of a shaft with the true parameters.
fn folder(noise: f64) -> TempDir {
    let [je, jd, k, b] = TRUTH;
    let a = mat![[-b / jd, b / jd, -k / jd], [b / je, -b / je, k / je], [1.0, -1.0, 0.0]];
    let c = mat![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let system = StateSpace::continuous(a, mat![[1.0 / jd], [0.0], [0.0]], c, Mat::zeros(2, 1)).unwrap();
    let mut random = signal::excitation::Random::new(5);
    let u = Mat::from_fn(1500, 1, |_, _| 20.0 * random.normal());
    let y = system.to_discrete_zoh(0.005).unwrap().simulate(u.as_ref(), &[0.0; 3]).unwrap();
    let mut text = "time [s],T [Nm],w_d [rad/s],w_e [rad/s]\n".to_owned();
    for t in 0..1500 {
        let (d, e) = (y[(t, 0)] + noise * random.normal(), y[(t, 1)] + noise * random.normal());
        text.push_str(&format!("{},{},{d},{e}\n", t as f64 / 200.0, u[(t, 0)]));
    }
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("run.csv"), text).unwrap();
    std::fs::write(folder.path().join("shaft.toml"), STRUCTURE).unwrap();
    folder
}

fn run(folder: &TempDir, line: &str) -> Ran {
    dynoid(folder.path(), &line.split(' ').collect::<Vec<_>>())
}

#[test]
fn stat_parameters_of_a_shaft_in_little_noise() {
    // A little noise: without any, momentum is an output combination free of errors, and the determinant that is
    // minimised vanishes whatever the stiffness.
    let folder = folder(1e-6);
    for line in [FIT.to_owned(), format!("{FIT} --from-rest"), format!("{FIT} --starts 2")] {
        let ran = run(&folder, &format!("{line} --json"));
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
        let result = ran.json();
        let estimate = &result["model"]["estimate"];
        assert_eq!(estimate["parameter_names"], serde_json::json!(["J_e", "J_d", "K", "B"]));
        for (found, truth) in estimate["parameters"].as_array().unwrap().iter().zip(TRUTH) {
            assert!((found.as_f64().unwrap() / truth - 1.0).abs() < 1e-5, "{line}: {estimate}");
        }
    }
}

#[test]
fn stat_derived_quantities_and_the_model_file() {
    let folder = folder(0.1);
    let ran = run(&folder, &format!("{FIT} --json --out model.json"));
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let derived = &ran.json()["derived"][0];
    let number = |key: &str| derived[key].as_f64().unwrap();
    let truth = (TRUTH[2] * (1.0 / TRUTH[1] + 1.0 / TRUTH[0])).sqrt() / std::f64::consts::TAU;
    assert_eq!(derived["name"], "resonance_hz");
    assert!(number("standard_error") > 0.0);
    assert!((number("value") - truth).abs() < 4.0 * number("standard_error"), "{derived}");
    let text = run(&folder, FIT);
    for words in ["J_d", "fixed", "resonance_hz", "95 % interval"] {
        assert!(text.stdout.contains(words), "`{words}` is not in:\n{}", text.stdout);
    }
    for line in [
        "model bode model.json --json",
        "model step model.json --json",
        "model poles model.json --json",
        "model convert model.json --to tf --json",
        "model compare model.json --on run.csv --detrend none --json",
        "model residuals model.json --on run.csv --detrend none --json",
    ] {
        let ran = run(&folder, line);
        assert_eq!(ran.code, Some(0), "{line}: {}", ran.stderr);
    }
}

#[test]
fn regress_an_integrating_structure_and_a_rest_ask_for_data_with_their_trend() {
    let folder = folder(0.1);
    let ran = run(&folder, "fit greybox shaft.toml run.csv -u T -y w_d -y w_e --from-rest");
    for words in ["\"w_d\" seems to integrate \"T\"", "the structure integrates", "--from-rest: a trend was taken off"]
    {
        assert!(ran.stderr.contains(words), "`{words}` is not in: {}", ran.stderr);
    }
    assert!(!run(&folder, FIT).stderr.contains("--detrend none"));
}

#[test]
fn regress_faults_of_the_structure_name_the_file_and_the_key() {
    let folder = folder(0.1);
    for (from, to, words) in [
        ("[\"1/J_d\"]", "[\"1/J_q\"]", "there is no parameter \"J_q\""),
        ("[\"1/J_d\"]", "[\"1/(J_d\"]", "character 7"),
        ("min = 0.01", "lowest = 0.01", "lowest"),
        ("value = 1500", "value = -5", "parameter \"K\""),
        ("[1, -1, 0]", "[1, -1]", "A: 3 × 2 entries where 3 × 3"),
        ("[matrices]", "[matrix]", "matrix"),
        (
            "C = [[1, 0, 0], [0, 1, 0]]",
            "C = [[1, 0, 0]]",
            "1 outputs (rows of C), but the number named with --output is 2",
        ),
    ] {
        let text = STRUCTURE.replacen(from, to, 1);
        assert_ne!(text, STRUCTURE, "{from}");
        std::fs::write(folder.path().join("shaft.toml"), text).unwrap();
        run(&folder, FIT).assert_refused(3, &["shaft.toml", words]);
    }
    run(&folder, &FIT.replace("shaft", "absent")).assert_refused(3, &["absent.toml", "no such file"]);
    let help = run(&folder, "fit greybox --help").stdout;
    assert!(help.contains("[parameters]") && help.contains("resonance_hz"), "{help}");
}

#[test]
fn regress_the_pole_of_a_shaft_that_turns_freely_is_an_integrator() {
    let folder = folder(0.01);
    let found = run(&folder, &format!("{FIT} --json --out m.json")).json();
    assert!(!found["doubts"].to_string().contains("not stable"), "{}", found["doubts"]);
    let poles = run(&folder, "model poles m.json");
    assert!(poles.stdout.contains("an integrator: at rest within rounding"), "{}", poles.stdout);
    let roots = run(&folder, "model poles m.json --json").json()[0]["poles"][0]["roots"].clone();
    assert!(roots.as_array().unwrap().iter().any(|root| root["re"] == 0.0 && root["im"] == 0.0), "{roots}");
    let step = run(&folder, "model step m.json");
    assert!(step.stdout.contains("none: the model integrates"), "{}", step.stdout);
    let bode = run(&folder, "model bode m.json");
    assert!(bode.stdout.contains("infinite: the model integrates"), "{}", bode.stdout);
}
