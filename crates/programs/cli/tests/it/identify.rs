//! Linear models from recordings: fit, judge, look, convert.

use std::path::Path;

use tempfile::TempDir;

use crate::support::{Ran, dynoid};

/// y(t) = 1.5 y(t−1) − 0.7 y(t−2) + u(t−1) + 0.5 u(t−2) + noise, as text with a time column.
pub(crate) fn recorded(folder: &Path, name: &str, seed: u64, noise: f64) {
    let mut random = signal::excitation::Random::new(seed);
    let (mut u, mut y) = (vec![0.0; 600], vec![0.0; 600]);
    for t in 2..600 {
        u[t] = if t % 3 == 0 { random.normal().signum() } else { u[t - 1] };
        y[t] = 1.5 * y[t - 1] - 0.7 * y[t - 2] + u[t - 1] + 0.5 * u[t - 2] + noise * random.normal();
    }
    let rows = (0..600).map(|t| format!("{},{},{}\n", 0.1 * t as f64, u[t] + 3.0, y[t] + 20.0));
    let text = format!("time [s],valve [V],speed [rad/s]\n{}", rows.collect::<String>());
    std::fs::write(folder.join(name), text).unwrap();
}

pub(crate) fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    recorded(folder.path(), "run.csv", 1, 0.2);
    recorded(folder.path(), "unseen.csv", 2, 0.2);
    folder
}

pub(crate) fn run(folder: &TempDir, line: &str) -> Ran {
    dynoid(folder.path(), &line.split(' ').collect::<Vec<_>>())
}

#[track_caller]
pub(crate) fn fitted(folder: &TempDir, line: &str) -> serde_json::Value {
    let ran = run(folder, &format!("{line} run.csv -u valve -y speed --json"));
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    ran.json()
}

#[test]
fn exact_every_structure_is_fitted_and_judged_on_unseen_data() {
    let folder = folder();
    for line in [
        "fit arx --na 2 --nb 2 --nk 1",
        "fit arx --na 2 --nb 2 --nk 1 --iv",
        "fit armax",
        "fit oe",
        "fit bj",
        "fit poly --na 2 --nd 1",
        "fit tf --zeros 1 --poles 2",
        "fit process --structure P2ZU",
        "fit ss --order 2",
        "fit ss --order auto --subspace --weighting moesp",
    ] {
        let result = fitted(&folder, &format!("{line} --validate unseen.csv"));
        let fit = &result["judged"][1]["fit_percent_predicted"][0][0];
        assert!(fit.as_f64().unwrap() > 60.0, "{line}: {fit}");
        assert_eq!(result["judged"][1]["data"], "unseen");
        let errors = result["standard_errors"].as_array().unwrap();
        assert!(errors.iter().all(|e| e.as_f64().unwrap() >= 0.0), "{line}");
    }
}

#[test]
fn stat_arx_finds_the_coefficients_within_their_intervals() {
    let result = fitted(&folder(), "fit arx");
    let intervals = result["intervals_95"].as_array().unwrap();
    for (interval, truth) in intervals.iter().zip([-1.5, 0.7, 1.0, 0.5]) {
        let ends = [interval[0].as_f64().unwrap(), interval[1].as_f64().unwrap()];
        // Four intervals of 95 %: with this seed all of them hold.
        assert!(ends[0] <= truth && truth <= ends[1], "{truth} in {ends:?}");
    }
}

#[test]
fn exact_model_files_serve_every_command() {
    let folder = folder();
    for line in
        ["fit armax --out armax.json", "fit tf --zeros 1 --poles 2 --out tf.json", "fit ss --order 2 --out ss.json"]
    {
        fitted(&folder, line);
    }
    let models = "armax.json tf.json ss.json";
    let compared = run(&folder, &format!("model compare {models} --on unseen.csv --json")).json();
    assert!(compared.as_array().unwrap().iter().all(|m| m["fit_percent"][0][0].as_f64().unwrap() > 50.0), "{compared}");
    let tests = run(&folder, "model residuals armax.json --on unseen.csv --json").json();
    assert_eq!(tests["whiteness"][0]["joint"]["passed"], true);
    for command in ["model bode", "model step", "model poles"] {
        let shown = run(&folder, &format!("{command} {models} --json"));
        assert_eq!(shown.code, Some(0), "{command}: {}", shown.stderr);
        assert!(shown.json().as_array().unwrap().len() >= 3, "{command}");
    }
    let zpk = run(&folder, "model convert armax.json --to zpk --continuous --json");
    assert_eq!(zpk.code, Some(0), "{}", zpk.stderr);
    for kind in ["tf", "zpk", "ss"] {
        let line = format!("model convert tf.json --to {kind} --sample-time 0.05 --json");
        assert_eq!(run(&folder, &line).code, Some(0), "{kind}");
    }
}

#[test]
fn exact_simulated_and_predicted_outputs_are_recordings_about_the_operating_point() {
    let folder = folder();
    fitted(&folder, "fit armax --out armax.json");
    for line in [
        "model simulate armax.json --on unseen.csv --out s.csv",
        "model predict armax.json --on unseen.csv --horizon 5 --out p.mf4",
    ] {
        let ran = run(&folder, line);
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    }
    let bytes = std::fs::read(folder.path().join("s.csv")).unwrap();
    let simulated = recording::decode("s.csv", &bytes, &recording::Selection::All).unwrap();
    let channel = simulated.channel("speed_simulated").unwrap();
    let mean = channel.samples.iter().sum::<f64>() / channel.samples.len() as f64;
    assert_eq!((channel.unit.as_str(), channel.samples.len()), ("rad/s", 600));
    assert!((mean - 20.0).abs() < 5.0, "{mean}");
    let predicted = run(&folder, "inspect p.mf4 --json");
    assert!(predicted.stdout.contains("speed_predicted"));
}

#[test]
fn exact_a_demand_alone_can_be_simulated() {
    let folder = folder();
    fitted(&folder, "fit tf --zeros 1 --poles 2 --out m.json");
    let rows: String = (0..200).map(|t| format!("{},{}\n", 0.1 * t as f64, if t < 20 { 3.0 } else { 4.0 })).collect();
    std::fs::write(folder.path().join("demand.csv"), format!("time [s],valve [V]\n{rows}")).unwrap();
    let ran = run(&folder, "model simulate m.json --on demand.csv --out s.csv --json");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let text = std::fs::read_to_string(folder.path().join("s.csv")).unwrap();
    let last: f64 = text.lines().last().unwrap().split(',').nth(1).unwrap().parse().unwrap();
    // The gain is (1 + 0.5)/(1 − 1.5 + 0.7) = 7.5, about an operating point near (3, 20).
    assert!((last - 27.5).abs() < 1.5, "{last}");
}

#[test]
fn exact_data_are_explored() {
    let folder = folder();
    let delay = run(&folder, "data delay run.csv -u valve -y speed --json").json();
    assert_eq!(delay["arx"]["samples"][0], 1);
    let order = run(&folder, "data order run.csv -u valve -y speed --na 1:4 --nb 1:4 --nk 1:2 --json").json();
    assert_eq!((&order["best"]["BIC"]["na"], &order["best"]["BIC"]["nb"]), (&2.into(), &2.into()));
    for method in ["welch", "blackman-tukey", "lpm", "lrm", "etfe"] {
        let spectrum = run(&folder, &format!("data spectrum run.csv -u valve -y speed --method {method} --json"));
        assert_eq!(spectrum.code, Some(0), "{method}: {}", spectrum.stderr);
        assert!(spectrum.json()[0]["magnitude"].as_array().unwrap().len() > 20);
    }
    assert_eq!(run(&folder, "data spectrum run.csv -y speed --json").code, Some(0));
}

#[test]
fn regress_models_of_different_outputs_are_compared_each_with_its_own() {
    let folder = folder();
    let ran = run(&folder, "fit arx run.csv -u speed -y valve --quiet --out back.json");
    assert_eq!(ran.code, Some(1), "it explains next to nothing: {}", ran.stderr);
    fitted(&folder, "fit arx --out forth.json");
    let compared = run(&folder, "model compare forth.json back.json --on unseen.csv --json --plot c.svg").json();
    assert_eq!(compared[0]["outputs"][0]["name"], "speed");
    assert_eq!(compared[1]["outputs"][0]["unit"], "V");
    let table = run(&folder, "model compare forth.json back.json --on unseen.csv").stdout;
    assert!(table.contains("rad/s") && table.contains("valve"), "{table}");
}

#[test]
fn regress_recordings_are_never_written_over() {
    let folder = folder();
    let before = std::fs::read(folder.path().join("run.csv")).unwrap();
    run(&folder, "fit arx run.csv -u valve -y speed --plot run.csv").assert_refused(2, &["run.csv", "is read"]);
    run(&folder, "fit arx run.csv -u valve -y speed --out model.csv").assert_refused(2, &["model.csv", ".json"]);
    fitted(&folder, "fit arx --out m.json");
    run(&folder, "model simulate m.json --on run.csv --out run.csv").assert_refused(2, &["run.csv", "is read"]);
    run(&folder, "model simulate m.json --on run.csv --on unseen.csv --out both.csv")
        .assert_refused(2, &["one recording"]);
    assert_eq!(std::fs::read(folder.path().join("run.csv")).unwrap(), before);
}

#[test]
fn regress_edited_model_files_are_refused() {
    let folder = folder();
    fitted(&folder, "fit arx --na 1 --nb 1 --out m.json");
    let text = std::fs::read_to_string(folder.path().join("m.json")).unwrap();
    let mut model: serde_json::Value = serde_json::from_str(&text).unwrap();
    let refused = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut changed = model.clone();
        change(&mut changed);
        std::fs::write(folder.path().join("e.json"), changed.to_string()).unwrap();
        let ran = run(&folder, "model bode e.json --json");
        assert_eq!(ran.code, Some(3), "stdout: {}", &ran.stdout[..ran.stdout.len().min(300)]);
        assert!(ran.stderr.contains("e.json"), "{}", ran.stderr);
    };
    refused(&|m| m["version"] = 2.into());
    refused(&|m| m["estimate"]["covariance"][0][0] = (-1.0).into());
    refused(&|m| m["estimate"]["degrees_of_freedom"] = (-3.0).into());
    refused(&|m| m["estimate"]["parameters"][0] = 0.5.into());
    refused(&|m| m["sample_time_s"] = 0.5.into());
    refused(&|m| m["model"]["value"]["equations"][0]["nk"][0] = 1_000_000_000.into());
    model["format"] = "other".into();
    std::fs::write(folder.path().join("f.json"), model.to_string()).unwrap();
    run(&folder, "model poles f.json").assert_refused(3, &["f.json", "other"]);
}

#[test]
fn snap_plots_are_written_in_every_kind() {
    let folder = folder();
    for (file, start) in
        [("a.html", "<!DOCTYPE html>"), ("a.svg", "<svg"), ("a.pdf", "%PDF-1.7"), ("a.png", "\u{fffd}PNG")]
    {
        let ran = run(&folder, &format!("fit arx run.csv -u valve -y speed --quiet --plot {file}"));
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
        let bytes = std::fs::read(folder.path().join(file)).unwrap();
        assert!(String::from_utf8_lossy(&bytes).starts_with(start), "{file}");
    }
    run(&folder, "fit arx run.csv -u valve -y speed --plot a.bmp").assert_refused(2, &["a.bmp", ".html"]);
}

#[test]
fn regress_impossible_requests_say_what_to_do() {
    let folder = folder();
    run(&folder, "fit arx run.csv").assert_refused(2, &["--output", "valve", "speed"]);
    run(&folder, "fit arx run.csv -u valv -y speed").assert_refused(3, &["valv", "valve"]);
    run(&folder, "fit arx absent.csv -u u -y y").assert_refused(3, &["absent.csv", "no such file"]);
    run(&folder, "fit oe run.csv -u valve -y speed --na 2").assert_refused(2, &["--na"]);
    run(&folder, "fit arx run.csv -u valve -y speed --na 500 --nb 500").assert_refused(3, &["samples"]);
    run(&folder, "fit arx run.csv -u valve -y speed --split 2").assert_refused(2, &["--split"]);
    run(&folder, "fit process run.csv -u valve -y speed --structure Q7")
        .assert_refused(2, &["--structure Q7", "process model"]);
    run(&folder, "fit arx run.csv -u speed -y speed").assert_refused(2, &["speed", "twice"]);
    run(&folder, "fit arx run.csv -u valve -y speed --from 20 --to 10").assert_refused(2, &["--from", "--to"]);
    run(&folder, "model bode run.csv").assert_refused(3, &["run.csv", "model file"]);
    std::fs::write(folder.path().join("bare.csv"), "u,y\n1,2\n2,3\n").unwrap();
    run(&folder, "fit arx bare.csv -u u -y y").assert_refused(3, &["--sample-time"]);
    std::fs::write(
        folder.path().join("still.csv"),
        format!("time,u,y\n{}", (0..99).map(|t| format!("{t},1,2\n")).collect::<String>()),
    )
    .unwrap();
    let still = run(&folder, "fit arx still.csv -u u -y y");
    assert_eq!(still.code, Some(3), "{}", still.stdout);
}

#[test]
fn regress_notes_on_the_data_are_shown_where_a_later_recording_cannot_be_read() {
    let folder = folder();
    std::fs::copy(folder.path().join("run.csv"), folder.path().join("twin.csv")).unwrap();
    let ran = run(&folder, "fit arx run.csv twin.csv -u valve -y speed --validate missing.csv");
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    assert!(ran.stderr.contains("counts it twice") && ran.stderr.contains("missing.csv"), "{}", ran.stderr);
}
