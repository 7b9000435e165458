//! Recordings as pages get them.

use std::fmt::Write as _;
use std::fs;

use crate::browser::{Running, app_on};

/// A recording of 100 s at 1 kHz with one sample that is large, and one that is missing.
fn opened() -> (tempfile::TempDir, Running, String) {
    let place = tempfile::tempdir().unwrap();
    let mut text = String::from("time [s],torque [Nm]\n");
    for k in 0..100_000 {
        match k {
            77_777 => text.push_str("77.777,900\n"),
            50_000 => text.push_str("50.000,\n"),
            _ => {
                let _ = writeln!(text, "{:.3},{}", f64::from(k) * 1e-3, k % 10);
            }
        }
    }
    fs::write(place.path().join("run.csv"), text).unwrap();
    let app = app_on(place.path());
    let cookie = app.enter();
    (place, app, cookie)
}

/// The numbers of a view.
fn columns(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks().0.iter().map(|eight| f64::from_le_bytes(*eight)).collect()
}

const TORQUE: &str = "channels=%5B%22torque%22%5D&file=run.csv";

#[test]
fn exact_no_spike_is_lost_however_few_columns() {
    let (_place, app, cookie) = opened();
    for width in [1, 7, 100, 1600] {
        let answer = app.ask(&cookie, &format!("GET /api/view?{TORQUE}&columns={width}"), "");
        let numbers = columns(&answer.body);
        let found = &numbers[1..];
        assert_eq!(numbers[0], found.len() as f64 / 6.0);
        assert!(numbers[0] <= f64::from(width));
        let largest = found.chunks(6).map(|column| column[3]).fold(f64::MIN, f64::max);
        assert_eq!(largest, 900.0, "{width}");
        let last = &found[found.len() - 6..];
        assert_eq!((found[0], last[1], found[4], last[5]), (0.0, 99.999, 0.0, 9.0));
    }
}

#[test]
fn exact_a_stretch_has_its_figures() {
    let (_place, app, cookie) = opened();
    let answer = app.ask(&cookie, &format!("GET /api/stretch?{TORQUE}&from_s=49.9995&to_s=50.0095"), "");
    let found: serde_json::Value = serde_json::from_slice(&answer.body).unwrap();
    assert_eq!((found[0]["samples"].as_u64(), found[0]["missing"].as_u64()), (Some(9), Some(1)));
    assert_eq!((found[0]["first"].as_f64(), found[0]["last"].as_f64()), (Some(1.0), Some(9.0)));
    assert_eq!(found[0]["mean"].as_f64(), Some(5.0));
    // Of an instant between two samples the next one is shown.
    let answer = app.ask(&cookie, &format!("GET /api/stretch?{TORQUE}&from_s=10.0035&to_s=10.0035"), "");
    let found: serde_json::Value = serde_json::from_slice(&answer.body).unwrap();
    assert_eq!(found[0]["first"].as_f64(), Some(4.0), "{found}");
}

#[test]
fn exact_a_file_that_changes_is_read_again() {
    let (place, app, cookie) = opened();
    assert!(app.ask(&cookie, "GET /api/channels?file=run.csv", "").text().contains("torque"));
    fs::write(place.path().join("run.csv"), "time [s],speed [rpm]\n0,1\n1,2\n2,3\n").unwrap();
    let text = app.ask(&cookie, "GET /api/channels?file=run.csv", "").text();
    assert!(text.contains("speed") && !text.contains("torque"), "{text}");
}

#[test]
fn exact_a_file_that_cannot_be_read_says_why() {
    let (place, app, cookie) = opened();
    fs::write(place.path().join("bad.mf4"), "MDF     4.10    ").unwrap();
    let answer = app.ask(&cookie, "GET /api/channels?file=bad.mf4", "");
    assert_eq!(answer.status, 422);
    assert!(answer.text().contains("bad.mf4"), "{}", answer.text());
}

/// Names come from recordings: they are data, never parts of a page.
#[test]
fn exact_names_stay_text() {
    let place = tempfile::tempdir().unwrap();
    let name = "<img src=x onerror=alert(1)>";
    fs::write(place.path().join("run.csv"), format!("time [s],{name}\n0,1\n1,2\n2,3\n")).unwrap();
    let app = app_on(place.path());
    let cookie = app.enter();
    let answer = app.ask(&cookie, "GET /api/channels?file=run.csv", "");
    assert_eq!(answer.head("content-type"), Some("application/json"));
    assert!(answer.text().contains("onerror"));
}
