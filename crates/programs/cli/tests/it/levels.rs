//! The level of the output that is estimated with a model, models that are not stable, clocks that count from 1970, and
//! short recordings.

use std::path::Path;

use signal::excitation::Random;
use tempfile::TempDir;

use crate::support::{Ran, dynoid};

fn run(folder: &Path, line: &str) -> Ran {
    let ran = dynoid(folder, &line.split(' ').collect::<Vec<_>>());
    assert_eq!(ran.code, Some(0), "{line}: {}", ran.stderr);
    ran
}

fn write(folder: &TempDir, name: &str, heading: &str, rows: impl Iterator<Item = String>) {
    std::fs::write(folder.path().join(name), format!("{heading}\n{}", rows.collect::<String>())).unwrap();
}

/// One step up early in a record, about a rest at which neither channel is zero: gain 1.5, lag 6 s, delay 0.43 s.
fn step_test(name: &str, level: f64) -> TempDir {
    let folder = TempDir::new().unwrap();
    let mut random = Random::new(3);
    let rows = (0..400).map(|t| {
        let late = (0.1 * f64::from(t) - 4.43).max(0.0);
        let (u, y) = (if t < 40 { 1.0 } else { 3.0 }, 1.5 + 3.0 * (1.0 - (-late / 6.0).exp()));
        format!("{},{u},{}\n", 0.1 * f64::from(t), level + y + 0.02 * random.normal())
    });
    write(&folder, name, "time [s],u,y", rows);
    folder
}

#[test]
fn regress_the_level_of_a_step_test_belongs_to_the_model() {
    let folder = step_test("step.csv", 5.0);
    for line in ["fit process step.csv --structure P1D --delay 0:1", "fit tf step.csv --delay 0:1"] {
        let found = run(folder.path(), &format!("{line} -u u -y y --json --out m.json")).json();
        let fit = found["judged"][0]["fit_percent_simulated"][0][0].as_f64().unwrap();
        assert!(fit > 95.0, "{line}: {fit}");
        assert!(found["levels"][0][0].as_f64().unwrap().abs() > 0.1, "{line}: {}", found["levels"]);
        assert_eq!(found["residuals"]["independence"][0][0]["dynamics"]["passed"], true, "{line}");
        let model = &found["model"]["estimate"];
        let (gain, lag) = match line.contains("process") {
            true => (model["parameters"][0].as_f64().unwrap(), model["parameters"][1].as_f64().unwrap()),
            false => {
                let [b, a] = [0, 1].map(|i| model["parameters"][i].as_f64().unwrap());
                (b / a, 1.0 / a)
            }
        };
        assert!((gain - 1.5).abs() < 0.02 && (lag - 6.0).abs() < 0.15, "{line}: {gain} {lag}");
        let compared = run(folder.path(), "model compare m.json --on step.csv --json");
        assert!(compared.json()[0]["fit_percent"][0][0].as_f64().unwrap() > 95.0, "{}", compared.stdout);
        assert!(!compared.stderr.contains("offset or a drift"), "{}", compared.stderr);
        run(folder.path(), "model simulate m.json --on step.csv --out simulated.csv --overwrite");
        let simulated = std::fs::read_to_string(folder.path().join("simulated.csv")).unwrap();
        let last: f64 = simulated.lines().last().unwrap().split(',').nth(1).unwrap().parse().unwrap();
        assert!((last - 9.49).abs() < 0.05, "{last}");
    }
    // Without a level the means would have to be levels.
    let without = run(folder.path(), "fit process step.csv -u u -y y --structure P1D --offset=none --json").json();
    assert_eq!(without["levels"], serde_json::json!([]));
}

#[test]
fn regress_a_model_that_only_a_controller_keeps_stable_is_judged_by_its_prediction() {
    let folder = TempDir::new().unwrap();
    let mut random = Random::new(8);
    let (mut u, mut y, mut e, mut reference) = (vec![0.0; 2000], vec![0.0; 2000], vec![0.0; 2000], 0.0);
    for t in 2..2000 {
        e[t] = 0.1 * random.normal();
        y[t] = 1.6 * y[t - 1] - 0.55 * y[t - 2] + 0.5 * u[t - 1] + e[t] - 0.3 * e[t - 1];
        reference = if t % 20 == 0 { random.normal() } else { reference };
        u[t] = 0.8 * (reference - y[t]);
    }
    write(&folder, "run.csv", "time [s],u,y", (0..2000).map(|t| format!("{},{},{}\n", 0.01 * t as f64, u[t], y[t])));
    let found = run(folder.path(), "fit armax run.csv -u u -y y --na 2 --nb 1 --nc 1 --json").json();
    let judged = &found["judged"][0];
    assert!(judged["fit_percent_simulated"].is_null(), "{judged}");
    assert!(judged["error_simulated"].as_str().unwrap().contains("not stable"), "{judged}");
    assert!(judged["fit_percent_predicted"][0][0].as_f64().unwrap() > 80.0, "{judged}");
    let doubts = found["doubts"].to_string();
    assert!(doubts.contains("judge it by its prediction") && !doubts.contains("next to nothing"), "{doubts}");
}

#[test]
fn regress_a_clock_that_counts_milliseconds_since_1970_is_read_as_such() {
    let folder = TempDir::new().unwrap();
    let mut random = Random::new(9);
    let (mut u, mut y) = (vec![0.0; 600], vec![0.0; 600]);
    for t in 1..600 {
        u[t] = if t % 7 == 0 { random.normal() } else { u[t - 1] };
        y[t] = 0.8 * y[t - 1] + u[t - 1] + 0.01 * random.normal();
    }
    let stamp = |t: usize, unit_s: f64| 1_700_000_000.0 / unit_s + t as f64 * 0.01 / unit_s;
    for (name, unit_s, unit) in [("timestamp", 1e-3, "ms"), ("time", 1e-6, "µs"), ("t", 1e-9, "ns")] {
        let rows = (0..600).map(|t| format!("{:.0},{},{}\n", stamp(t, unit_s), u[t], y[t]));
        write(&folder, "run.csv", &format!("{name},u,y"), rows);
        let ran = run(folder.path(), "fit arx run.csv -u u -y y --na 1 --nb 1 --json");
        let sample_time_s = ran.json()["model"]["sample_time_s"].as_f64().unwrap();
        assert!((sample_time_s - 0.01).abs() < 1e-6, "{name}: {sample_time_s}");
        assert!(
            ran.stderr.contains(&format!("note: run.csv: the time stamps are so large that they count {unit}")),
            "{}",
            ran.stderr
        );
    }
}

#[test]
fn regress_thirty_samples_are_enough_for_a_first_look() {
    let folder = TempDir::new().unwrap();
    let mut random = Random::new(2);
    let (mut u, mut y) = (vec![0.0; 30], vec![0.0; 30]);
    for t in 0..30 {
        u[t] = if t % 5 == 0 { random.normal() } else { u[t - 1] };
        y[t] = if t > 0 { 0.6 * y[t - 1] + 0.4 * u[t - 1] } else { 0.0 } + 0.01 * random.normal();
    }
    write(&folder, "run.csv", "time [s],u,y", (0..30).map(|t| format!("{},{},{}\n", 0.01 * t as f64, u[t], y[t])));
    run(folder.path(), "data delay run.csv -u u -y y");
    run(folder.path(), "data delay run.csv -u u -y y --longest 10");
    run(folder.path(), "fit ss run.csv -u u -y y");
}

#[test]
fn regress_a_drift_is_named_with_its_remedy() {
    let folder = TempDir::new().unwrap();
    let mut random = Random::new(4);
    let rows = (0..400)
        .map(|t| format!("{},{},{}\n", 0.1 * f64::from(t), random.normal(), 0.05 * f64::from(t) + random.normal()));
    write(&folder, "run.csv", "time [s],u,y", rows);
    let said = run(folder.path(), "fit arx run.csv -u u -y y").stderr;
    assert!(said.contains("\"y\" drifts") && said.contains("--detrend line"), "{said}");
    let level = dynoid(folder.path(), &"fit arx run.csv -u u -y y --detrend line".split(' ').collect::<Vec<_>>());
    assert_eq!(level.code, Some(1), "it explains next to nothing: {}", level.stderr);
    assert!(!level.stderr.contains("drifts"), "{}", level.stderr);
}

/// A record that begins far from rest: its mean is no level of rest. A state-space model has no level of its own, and
/// says so.
#[test]
fn regress_a_state_space_model_of_a_record_that_begins_far_from_rest_is_doubted() {
    let folder = TempDir::new().unwrap();
    let mut random = Random::new(19);
    let (mut u, mut x) = ([0.0, 0.0], [30.0, 0.0]);
    let rows = (0..1500).map(|t| {
        if t % 40 == 0 {
            u = [2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0];
        }
        let row = format!("{:.2},{},{},{}\n", 0.02 * f64::from(t), u[0], u[1], x[0] + x[1] + 0.3 * random.normal());
        for (state, (gain, (input, lag_s))) in x.iter_mut().zip([(8.0, (u[0], 4.0)), (4.0, (u[1], 0.3))]) {
            let keeps = (-0.02_f64 / lag_s).exp();
            *state = keeps * *state + (1.0 - keeps) * gain * input;
        }
        row
    });
    write(&folder, "lags.csv", "time [s],u1,u2,y", rows);
    let judged = |line: &str| {
        let found =
            dynoid(folder.path(), &format!("{line} lags.csv -u u1 -u u2 -y y --json").split(' ').collect::<Vec<_>>())
                .json();
        let fit = found["judged"][0]["fit_percent_simulated"][0][0].as_f64().unwrap();
        (fit, found["doubts"].to_string(), found)
    };
    let (simulated, doubts, _) = judged("fit ss --order 2");
    assert!(simulated > 90.0 || doubts.contains("the mean is not the level"), "{simulated} {doubts}");
    // The remedy that the doubt states.
    let (simulated, doubts, found) = judged("fit tf --poles 1 --zeros 0");
    assert!(simulated > 93.0 && !doubts.contains("the mean is not the level"), "{simulated} {doubts}");
    let names = found["model"]["estimate"].to_string();
    assert!(found["levels"][0][0].as_f64().is_some_and(|level| level.abs() > 1.0), "{} {names}", found["levels"]);
}
