//! Answers of the commands on models and data.

use std::path::Path;

use tempfile::TempDir;

use crate::support::{Ran, dynoid};

/// A resonance at 8 Hz, seen by two outputs, one of them later; a sine of 20 Hz on the first. Sampled at 100 Hz.
fn recorded(folder: &Path) {
    let mut random = signal::excitation::Random::new(3);
    let (radius, angle) = (0.97_f64, 0.08 * std::f64::consts::TAU);
    let (a1, a2) = (-2.0 * radius * angle.cos(), radius * radius);
    let mut x = vec![0.0; 2000];
    let u: Vec<f64> = (0..2000).map(|_| random.normal()).collect();
    let mut text = String::from("time [s],u [Nm],N_one [rpm],two [rpm]\n");
    for t in 3..2000 {
        x[t] = -a1 * x[t - 1] - a2 * x[t - 2] + u[t - 1] + 0.5 * u[t - 2];
        let sine = 8.0 * (std::f64::consts::TAU * 0.2 * t as f64).sin();
        let (one, two) = (x[t] + sine + 0.2 * random.normal(), x[t - 2] + 0.2 * random.normal());
        text.push_str(&format!("{:.2},{},{one},{two}\n", 0.01 * t as f64, u[t]));
    }
    std::fs::write(folder.join("T_TN.csv"), text).unwrap();
}

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    recorded(folder.path());
    folder
}

fn run(folder: &TempDir, line: &str) -> Ran {
    dynoid(folder.path(), &line.split(' ').collect::<Vec<_>>())
}

#[track_caller]
fn said(folder: &TempDir, line: &str) -> String {
    let ran = run(folder, line);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    ran.stdout
}

/// A state space of both outputs, and an output-error model of the second.
fn with_models() -> TempDir {
    let folder = folder();
    said(&folder, "fit ss T_TN.csv -u u -y N_one -y two --order 4 --subspace --quiet --out ss.json");
    said(&folder, "fit oe T_TN.csv -u u -y two --nb 2 --nf 2 --nk 3 --quiet --out oe.json");
    folder
}

#[test]
fn snap_poles_that_all_ways_share_are_said_once_with_frequency_and_damping() {
    let folder = with_models();
    let text = said(&folder, "model poles ss.json");
    assert_eq!(text.matches("natural frequency").count(), 3, "poles, and the zeros of two ways: {text}");
    assert!(text.contains("zeros of u → N_one") && text.contains("zeros of u → two"), "{text}");
    let one = &run(&folder, "model poles oe.json --json").json()[0];
    let poles = one["poles"][0]["roots"].as_array().unwrap();
    let hertz = poles[0]["natural_frequency_interval_hz"].as_array().unwrap();
    let (low, high) = (hertz[0].as_f64().unwrap(), hertz[1].as_f64().unwrap());
    // |ln z|/T with z = 0.97 e^{j 2π 0.08}.
    let truth = (0.08 * std::f64::consts::TAU).hypot(0.97_f64.ln()) / 0.01 / std::f64::consts::TAU;
    assert!(low < truth && truth < high && high - low < 0.1, "{truth} in {low} … {high}");
    let damping = poles[0]["damping"].as_f64().unwrap();
    assert!((damping - 0.0605).abs() < 0.005, "{damping}");
    assert!(poles[0]["time_constant_interval_s"][0].as_f64().unwrap() > 0.0);
    assert!(said(&folder, "model poles oe.json").contains("sample time 0.01 s"));
}

#[test]
fn snap_responses_are_summed_up_and_shown_whole_only_on_request() {
    let folder = with_models();
    let bode = said(&folder, "model bode oe.json");
    for word in ["gain at rest", "rpm/Nm", "resonance", "95 % interval"] {
        assert!(bode.contains(word), "{word}: {bode}");
    }
    assert!(bode.lines().count() < 10 && !bode.contains("margin"), "rpm are not Nm, so no loop can be closed: {bode}");
    let step = said(&folder, "model step oe.json ss.json");
    for word in ["final value", "rise time", "settling time", "overshoot", "dead time"] {
        assert!(step.contains(word), "{word}: {step}");
    }
    let summary = run(&folder, "model step oe.json --json").json()[0]["summary"].clone();
    let fact = |name: &str| summary.as_array().unwrap().iter().find(|fact| fact["name"] == name).unwrap().clone();
    assert_eq!(fact("dead time")["value"], 0.02);
    let ends = fact("final value")["interval"].clone();
    let truth = 1.5 / (1.0 - 2.0 * 0.97 * (0.08 * std::f64::consts::TAU).cos() + 0.97 * 0.97);
    assert!(ends[0].as_f64().unwrap() < truth && truth < ends[1].as_f64().unwrap(), "{truth} in {ends}");
    assert!(said(&folder, "model bode oe.json --table").lines().count() > 300);
    assert!(said(&folder, "model step oe.json --table --level 0.9").contains("90 % interval"));
    run(&folder, "model step oe.json --table --json").assert_refused(2, &["--table", "--json"]);
}

#[test]
fn snap_figures_keep_the_names_of_files_and_channels() {
    let folder = with_models();
    said(&folder, "model compare ss.json --on T_TN.csv --plot c.svg");
    let text = std::fs::read_to_string(folder.path().join("c.svg")).unwrap();
    assert!(text.contains(">N_one, T_TN.csv</text>"), "{}", &text[..600]);
    said(&folder, "model poles ss.json oe.json --plot p.svg");
    let poles = std::fs::read_to_string(folder.path().join("p.svg")).unwrap();
    assert!(poles.contains("unit circle") && poles.contains("equal damping"));
}

#[test]
fn exact_a_spectrum_has_the_peaks_that_are_in_it() {
    let folder = folder();
    let power = &run(&folder, "data spectrum T_TN.csv -y N_one --json").json()[0];
    let at: Vec<f64> = power["peaks"].as_array().unwrap().iter().map(|p| p["frequency_hz"].as_f64().unwrap()).collect();
    assert_eq!(at.len(), 2, "the resonance and the sine: {at:?}");
    assert!((at[0] - 8.0).abs() < 0.5 && (at[1] - 20.0).abs() < 0.5, "{at:?}");
    let response = said(&folder, "data spectrum T_TN.csv -u u -y two");
    assert!(response.contains("its top lies within") && response.contains("dB"), "{response}");
    run(&folder, "data spectrum T_TN.csv -u u -u two -y N_one --method welch").assert_refused(2, &["one input"]);
}

#[test]
fn exact_a_spectrum_is_that_of_the_longest_stretch_without_gaps() {
    let folder = folder();
    let text = std::fs::read_to_string(folder.path().join("T_TN.csv")).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let cells = lines[60].split(',').count();
    lines[60] = format!("{}{}", lines[60].split(',').next().unwrap(), ",NaN".repeat(cells - 1));
    std::fs::write(folder.path().join("gap.csv"), lines.join("\n") + "\n").unwrap();
    let ran = run(&folder, "data spectrum gap.csv -u u -y two --json");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(ran.stderr.contains("gap.csv was cut") && ran.stderr.contains("the longest is shown"), "{}", ran.stderr);
    assert_eq!(ran.json().as_array().unwrap().len(), 1);
}

#[test]
fn regress_an_order_at_the_end_of_the_scan_is_said() {
    let folder = folder();
    let text = said(&folder, "data order T_TN.csv -u u -y two --na 1:2 --nb 1:1 --nk 1:3");
    assert!(text.contains("try --na 1:4") && text.contains("try --nk 1:5"), "{text}");
    assert!(!text.contains("--nb"), "a range of one number is meant so: {text}");
    let edges =
        run(&folder, "data order T_TN.csv -u u -y two --na 1:2 --nb 1:1 --nk 1:3 --json").json()["at_edge"].clone();
    assert_eq!(edges[0]["option"], "--na");
}

#[test]
fn exact_a_delay_before_a_resonance_is_separated_from_its_lag() {
    let folder = folder();
    let delay = run(&folder, "data delay T_TN.csv -u u -y two --between held --json").json();
    // Three samples, one of which is that of the hold.
    assert_eq!(delay["arx"]["samples"][0], 3);
    let ends = &delay["delay"][0]["interval_95_s"];
    assert!(ends[0].as_f64().unwrap() < 0.02 && 0.02 < ends[1].as_f64().unwrap(), "{delay}");
    // The input moves with every sample: nobody said that it is held.
    let unsaid = run(&folder, "data delay T_TN.csv -u u -y two --json").json();
    assert!(unsaid["delay"][0]["interval_95_s"].is_null(), "{unsaid}");
    assert!(unsaid["delay"][0]["unclaimed"].as_str().unwrap().contains("--between held"), "{unsaid}");
    let short = said(&folder, "data delay T_TN.csv -u u -y two --longest 3");
    let short = short.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(short.contains("try --longest 6"), "{short}");
}

#[test]
fn snap_residual_tests_say_what_they_found() {
    let folder = with_models();
    let text = said(&folder, "model residuals ss.json --on T_TN.csv");
    assert!(!text.contains("p 0.000") && text.contains("p < 0.001"), "{text}");
    assert!(text.contains("failed: residuals of N_one are not white"), "{text}");
}

#[test]
fn regress_no_delay_is_claimed_of_one_sine() {
    let folder = TempDir::new().unwrap();
    let at = |t: f64| (std::f64::consts::TAU * 5.0 * t).sin();
    let mut random = signal::excitation::Random::new(3);
    for deviation in [0.0, 0.05] {
        let row = |n: u32| {
            let t = 0.01 * f64::from(n);
            format!("{t:.2},{},{}\n", at(t), 0.7 * at(t - 0.06) + deviation * random.normal())
        };
        let rows: String = (0..1000).map(row).collect();
        std::fs::write(folder.path().join("sine.csv"), format!("time,u,y\n{rows}")).unwrap();
        let ran = run(&folder, "data delay sine.csv -u u -y y");
        let text = ran.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
        assert!(text.contains("no interval is claimed: \"u\" is one sine of 5 Hz"), "{text}");
        assert!(!text.contains("methods leave") && !text.contains("(95 % interval"), "{text}");
    }
}
