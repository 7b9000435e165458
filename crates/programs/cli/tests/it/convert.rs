//! `dynoid convert`: the same model in another form.

use tempfile::TempDir;

use crate::identify::{fitted, folder, run};

/// The simulation of a model from rest.
fn simulated(folder: &TempDir, model: &str) -> Vec<f64> {
    let ran = run(folder, &format!("model simulate {model} --on unseen.csv --from-rest --json"));
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
    let armax = run(&folder, "fit armax run.csv -u valve -y speed --nk 3 --out armax.json");
    assert_eq!(armax.code, Some(1), "its delay is too long to explain anything: {}", armax.stderr);
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
        let ran = run(&folder, &format!("model convert {model}.json {form} --out c.json"));
        assert_eq!(ran.code, Some(0), "{model} {form}: {}", ran.stderr);
        assert!(ran.stdout.contains("written: c.json"), "{}", ran.stdout);
        assert_same(&folder, &format!("{model}.json"), "c.json");
        for command in ["model bode", "model step", "model poles"] {
            let ran = run(&folder, &format!("{command} c.json"));
            assert_eq!(ran.code, Some(0), "{command} of {model} {form}: {}", ran.stderr);
        }
    }
}

#[test]
fn exact_printed_json_is_the_model_file() {
    let folder = folder();
    fitted(&folder, "fit tf --zeros 0 --poles 2 --delay 0.03 --out tf.json");
    let ran = run(&folder, "model convert tf.json --to ss --json --out c.json");
    let written: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("c.json")).unwrap()).unwrap();
    assert_eq!((ran.code, &ran.json()), (Some(0), &written), "{}", ran.stderr);
    assert_eq!((&written["format"], &written["model"]["kind"]), (&"dynoid model".into(), &"grey_box".into()));
    let text = run(&folder, "model convert tf.json --to ss").stdout;
    assert!(text.contains("delay of valve 0.03 s"), "{text}");
}

#[test]
fn exact_a_noise_model_stays_with_the_state_space() {
    let folder = folder();
    fitted(&folder, "fit armax --out armax.json");
    assert_eq!(run(&folder, "model convert armax.json --to ss --out ss.json --quiet").code, Some(0));
    let fits = |model: &str| {
        let compared = run(&folder, &format!("model compare {model} --on unseen.csv --horizon 1 --json")).json();
        compared[0]["fit_percent"][0][0].as_f64().unwrap()
    };
    assert!((fits("armax.json") - fits("ss.json")).abs() < 1e-6);
}

#[test]
fn regress_what_cannot_be_converted_is_said() {
    let folder = folder();
    fitted(&folder, "fit tf --zeros 0 --poles 2 --delay 0.03 --out tf.json");
    run(&folder, "model convert tf.json --to zpk --out c.json").assert_refused(2, &["--to tf"]);
    run(&folder, "model convert tf.json --to ss --out tf.json").assert_refused(2, &["tf.json", "is read"]);
    run(&folder, "model convert tf.json --to ss --out c.csv").assert_refused(2, &["c.csv", ".json"]);
    // 0.03 s is no whole number of these samples, and Tustin's rule has no answer to that.
    run(&folder, "model convert tf.json --to ss --sample-time 0.1 --method tustin")
        .assert_refused(2, &["0.03", "--method zoh"]);
    let whole = run(&folder, "model convert tf.json --to ss --sample-time 0.01 --method tustin --json");
    assert_eq!(whole.code, Some(0), "{}", whole.stderr);
}

#[test]
fn regress_what_a_form_does_not_hold_is_said() {
    let folder = folder();
    for (model, to, words) in [
        ("armax", "tf", "the noise model and the covariance"),
        ("oe", "tf", "the covariance"),
        ("armax", "ss", "the covariance"),
    ] {
        fitted(&folder, &format!("fit {model} --out m.json"));
        let ran = run(&folder, &format!("model convert m.json --to {to} --out c.json"));
        assert!(ran.stderr.contains(words), "{model} to {to}: {}", ran.stderr);
        let again = run(&folder, "model convert c.json --to ss --out d.json");
        assert_eq!((again.code, again.stderr.as_str()), (Some(0), ""), "nothing is lost a second time");
    }
}

#[test]
fn snap_both_forms_are_drawn() {
    let folder = folder();
    fitted(&folder, "fit oe --out m.json");
    let line = "model convert m.json --to tf --continuous --method tustin --prewarp 0.5 --plot both.svg";
    let ran = run(&folder, line);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let svg = std::fs::read_to_string(folder.path().join("both.svg")).unwrap();
    assert!(svg.contains("as it was") && svg.contains("converted"), "the legend names both");
    run(&folder, "model convert m.json --to tf --prewarp 0.5").assert_refused(2, &["--prewarp", "tustin"]);
}

#[test]
fn exact_prewarping_keeps_the_response_at_its_frequency() {
    let folder = folder();
    fitted(&folder, "fit oe --out m.json");
    let zpk = |options: &str| {
        let ran =
            run(&folder, &format!("model convert m.json --to tf --continuous --method tustin {options}--out c.json"));
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
        run(&folder, "model bode m.json c.json --json").json()
    };
    let difference = |both: &serde_json::Value, at_hz: f64| {
        let curve = |model: usize| &both[model];
        let frequencies = curve(0)["frequency"].as_array().unwrap();
        let place = frequencies.iter().position(|f| f.as_f64().unwrap() >= at_hz).unwrap();
        let of = |model: usize| curve(model)["quantities"][0]["values"][place].as_f64().unwrap();
        (of(0) - of(1)).abs()
    };
    let (plain, prewarped) = (zpk(""), zpk("--prewarp 2 "));
    assert!(difference(&prewarped, 2.0) < 0.1 * difference(&plain, 2.0), "closer by far at 2 Hz");
}
