//! Analyses of stretches as pages get them.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;

use serde_json::Value;

use crate::browser::{Running, app_on};

/// 20 s: a sine of amplitude 2 at 50 Hz on a level of 10 every ms, and a ramp every 10 ms.
fn opened() -> (tempfile::TempDir, Running, String) {
    let place = tempfile::tempdir().unwrap();
    let mut text = String::from("time [s],torque [Nm],time [s],speed [rpm]\n");
    for k in 0..20_000 {
        let torque = 10.0 + 2.0 * (TAU * 0.05 * f64::from(k)).sin();
        let slow = if k < 2000 { format!("{:.2},{k}", f64::from(k) * 1e-2) } else { ",".to_owned() };
        let _ = writeln!(text, "{:.3},{torque},{slow}", f64::from(k) * 1e-3);
    }
    fs::write(place.path().join("run.csv"), text).unwrap();
    let app = app_on(place.path());
    let cookie = app.enter();
    (place, app, cookie)
}

fn ask(app: &Running, cookie: &str, what: &str) -> Value {
    let answer = app.ask(cookie, &format!("GET /api/{what}&file=run.csv"), "");
    assert_eq!(answer.status, 200, "{}", answer.text());
    serde_json::from_slice(&answer.body).unwrap()
}

const TORQUE: &str = "channels=%5B%22torque%22%5D";

#[test]
fn exact_a_spectrum_has_the_amplitude_of_a_sine() {
    let (_place, app, cookie) = opened();
    let found = ask(&app, &cookie, &format!("spectrum?{TORQUE}&segment=1000&from_s=2&to_s=12"));
    let line = found["frequency_hz"].as_array().unwrap().iter().position(|f| f == 50.0).unwrap();
    assert!((found["amplitude"][line].as_f64().unwrap() - 2.0).abs() < 1e-6, "{}", found["amplitude"][line]);
    let segments = &found["segments"];
    assert_eq!((segments["samples"].as_u64(), segments["segments"].as_u64()), (Some(10_001), Some(19)));
    assert_eq!((&found["density_unit"], &segments["window"]), (&"Nm²/Hz".into(), &"Hann".into()));
}

#[test]
fn exact_a_spectrogram_has_the_line_of_a_sine_in_every_column() {
    let (_place, app, cookie) = opened();
    let found = ask(&app, &cookie, &format!("spectrogram?{TORQUE}&segment=500&columns=20&up_to_hz=100"));
    let columns = found["levels_db"].as_array().unwrap();
    assert_eq!(columns.len(), 20);
    for column in columns {
        let levels: Vec<f64> = column.as_array().unwrap().iter().map(|level| level.as_f64().unwrap_or(-1e9)).collect();
        let largest = (0..levels.len()).max_by(|a, b| levels[*a].total_cmp(&levels[*b]));
        assert_eq!((levels.len(), largest), (51, Some(25)));
    }
}

#[test]
fn exact_a_histogram_counts_every_sample() {
    let (_place, app, cookie) = opened();
    let found = ask(&app, &cookie, &format!("histogram?{TORQUE}"));
    let counts = found["counts"].as_array().unwrap().iter().map(|count| count.as_u64().unwrap());
    assert_eq!((counts.sum::<u64>(), found["figures"]["samples"].as_u64()), (20_000, Some(20_000)));
    let found = ask(&app, &cookie, &format!("histogram?{TORQUE}&bins=7"));
    assert_eq!(found["counts"].as_array().unwrap().len(), 7);
    assert!((found["low"].as_f64().unwrap() - 8.0).abs() < 1e-9);
}

#[test]
fn exact_pairs_are_on_the_slower_clock() {
    let (_place, app, cookie) = opened();
    let found = ask(&app, &cookie, "pairs?channels=%5B%22speed%22,%22torque%22%5D&from_s=5&to_s=10");
    assert_eq!((found["pairs"].as_u64(), found["sample_time_s"].as_f64()), (Some(501), Some(0.01)));
    assert_eq!(found["points"][0][0].as_f64(), Some(500.0), "{}", found["points"][0]);
    assert!(found["notes"].to_string().contains("low-pass"), "{}", found["notes"]);
    let many = ask(&app, &cookie, "pairs?channels=%5B%22torque%22,%22torque%22%5D&to_s=19.999");
    assert!(many["pairs"] == 20_000 && many["cells"].is_null());
}

#[test]
fn regress_what_cannot_be_analysed_is_said_in_words() {
    let (_place, app, cookie) = opened();
    for (what, words) in [
        (format!("spectrum?{TORQUE}&segment=1000&to_s=0.5"), "choose a longer stretch"),
        (format!("spectrogram?{TORQUE}&from_s=30&to_s=40"), "no sample in this stretch"),
        (format!("histogram?{TORQUE}&from_s=30&to_s=40"), "no sample in this stretch"),
        (format!("pairs?{TORQUE}"), "two channels"),
        ("spectrum?channels=%5B%22nothing%22%5D".to_owned(), "nothing"),
    ] {
        let answer = app.ask(&cookie, &format!("GET /api/{what}&file=run.csv"), "");
        assert!(answer.status == 422 && answer.text().contains(words), "{what}: {}", answer.text());
    }
}
