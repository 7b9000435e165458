//! `dynoid convert`: the same model in another form.

use tempfile::TempDir;

use crate::identify::{fitted, folder, run};

/// The simulation of a model from rest.
fn simulated(folder: &TempDir, model: &str) -> Vec<f64> {
    let ran = run(folder, &format!("simulate {model} --on unseen.csv --from-rest --json"));
    assert_eq!(ran.code, Some(0), "{model}: {}", ran.stderr);
    ran.json()[0]["values"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

#[track_caller]
fn assert_same(folder: &TempDir, model: &str, converted: &str) {
    let (expected, found) = (simulated(folder, model), simulated(folder, converted));
    let scale = expected.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let worst = expected.iter().zip(&found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(scale > 0.1 && worst < 1e-6 * scale, "{model} and {converted} differ by {worst} of {scale}");
}

#[test]
fn exact_conversions_are_the_same_model_delay_included() {
    let folder = folder();
    fitted(&folder, "fit tf --zeros 0 --poles 2 --delay 0.03 --out tf.json");
    fitted(&folder, "fit process --structure P2DU --delay 0.02:0.08 --out process.json");
    fitted(&folder, "fit armax --nk 3 --out armax.json");
    for (model, form) in [
        ("tf", "--to ss"),
        ("tf", "--to ss --sample-time 0.1"),
        ("tf", "--to tf"),
        ("tf", "--to tf --sample-time 0.1"),
        ("process", "--to ss"),
        ("process", "--to tf"),
        ("process", "--to ss --sample-time 0.1"),
        ("armax", "--to ss"),
        ("armax", "--to tf"),
        ("armax", "--to ss --continuous"),
        ("armax", "--to tf --continuous"),
    ] {
        let ran = run(&folder, &format!("convert {model}.json {form} --out c.json"));
        assert_eq!(ran.code, Some(0), "{model} {form}: {}", ran.stderr);
        assert!(ran.stdout.contains("written: c.json"), "{}", ran.stdout);
        assert_same(&folder, &format!("{model}.json"), "c.json");
        for command in ["bode", "step", "poles"] {
            let ran = run(&folder, &format!("{command} c.json"));
            assert_eq!(ran.code, Some(0), "{command} of {model} {form}: {}", ran.stderr);
        }
    }
}

#[test]
fn printed_json_is_the_model_file() {
    let folder = folder();
    fitted(&folder, "fit tf --zeros 0 --poles 2 --delay 0.03 --out tf.json");
    let ran = run(&folder, "convert tf.json --to ss --json --out c.json");
    let written: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("c.json")).unwrap()).unwrap();
    assert_eq!((ran.code, &ran.json()), (Some(0), &written), "{}", ran.stderr);
    assert_eq!((&written["format"], &written["model"]["kind"]), (&"dynoid model".into(), &"grey_box".into()));
    let text = run(&folder, "convert tf.json --to ss").stdout;
    assert!(text.contains("delay of valve 0.03 s"), "{text}");
}

#[test]
fn exact_a_noise_model_stays_with_the_state_space() {
    let folder = folder();
    fitted(&folder, "fit armax --out armax.json");
    assert_eq!(run(&folder, "convert armax.json --to ss --out ss.json --quiet").code, Some(0));
    let fits = |model: &str| {
        let compared = run(&folder, &format!("compare {model} --on unseen.csv --horizon 1 --json")).json();
        compared[0]["fit_percent"][0][0].as_f64().unwrap()
    };
    assert!((fits("armax.json") - fits("ss.json")).abs() < 1e-6);
}

#[test]
fn what_cannot_be_converted_is_said() {
    let folder = folder();
    fitted(&folder, "fit tf --zeros 0 --poles 2 --delay 0.03 --out tf.json");
    run(&folder, "convert tf.json --to zpk --out c.json").assert_refused(2, &["--to tf"]);
    run(&folder, "convert tf.json --to ss --out tf.json").assert_refused(2, &["tf.json", "is read"]);
    run(&folder, "convert tf.json --to ss --out c.csv").assert_refused(2, &["c.csv", ".json"]);
    // 0.03 s is no whole number of these samples, and Tustin's rule has no answer to that.
    run(&folder, "convert tf.json --to ss --sample-time 0.1 --method tustin")
        .assert_refused(2, &["0.03", "--method zoh"]);
    let whole = run(&folder, "convert tf.json --to ss --sample-time 0.01 --method tustin --json");
    assert_eq!(whole.code, Some(0), "{}", whole.stderr);
}
