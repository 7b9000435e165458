//! Tests that are tried on many benches.

use std::fs;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::browser::{Answered, Running, app_on};

const BENCH: &str = "[bench]\nname = \"x\"\nvariant = \"load-cell\"\ncylinders = 4\ndynamometer_inertia = 0.6\n\
    engine_inertia = 0.28\n[shaft]\nresonance = \"18 Hz\"\n[limits]\nspeed = \"6000 rpm\"\n";

fn read(answer: &Answered) -> Value {
    serde_json::from_slice(&answer.body).unwrap()
}

fn post(app: &Running, cookie: &str, body: &Value) -> Answered {
    app.ask(cookie, "POST /api/can", &body.to_string())
}

fn question(test: &str) -> Value {
    serde_json::json!({
        "bench": "bench.toml", "model": null, "test": test, "given": [["duration", "2"]], "engine_map": null,
        "vehicle": null, "by": [], "require": [], "benches": 4, "seed": 1,
    })
}

/// Waits for a try, and gives its key.
fn tried(app: &Running, cookie: &str, body: &Value) -> String {
    let until = Instant::now() + Duration::from_secs(300);
    loop {
        let stand = read(&post(app, cookie, body));
        assert!(stand["key"].is_string() && Instant::now() < until, "{stand}");
        if stand["is_done"] == true {
            return stand["key"].as_str().unwrap().to_owned();
        }
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn exact_a_try_is_judged_by_other_limits() {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("bench.toml"), BENCH).unwrap();
    let app = app_on(place.path());
    let cookie = app.enter();
    let key = tried(&app, &cookie, &question("tip-in"));
    let ask = |what: &str| read(&app.ask(&cookie, &format!("GET /api/can/{key}/{what}"), ""));
    let answer = ask("answer");
    assert!(answer["answer"]["kept"]["count"] == 4 && answer["binding"] == "speed", "{answer}");
    // The test begins at 1500 rpm.
    let judged = ask("judged?limits=%7B%22speed%22:1400%7D");
    assert!(judged["kept"]["count"] == 0 && judged["answer"] == "no", "{judged}");
    let course = ask("course?of=speed&bench=3&limits=%7B%22speed%22:1400%7D");
    let bench = &course["bench"];
    assert!(bench["keeps"] == false && bench["reaches"][0] == "speed", "{bench}");
    assert_eq!(bench["values"].as_array().unwrap().len(), course["time_s"].as_array().unwrap().len());
    let refused = app.ask(&cookie, &format!("GET /api/can/{key}/judged?limits=%7B%22speed%22:-1%7D"), "");
    assert!(refused.status == 422 && refused.text().contains("above zero"), "{}", refused.text());
}

#[test]
fn exact_only_the_latest_tries_are_kept() {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("bench.toml"), BENCH).unwrap();
    let app = app_on(place.path());
    let cookie = app.enter();
    let with_seed = |seed: u64| {
        let mut body = question("tip-in");
        (body["seed"], body["benches"]) = (seed.into(), 1.into());
        tried(&app, &cookie, &body)
    };
    let first = with_seed(1);
    assert_eq!(with_seed(1), first, "the same question finds its try");
    (2..8).for_each(|seed| drop(with_seed(seed)));
    let answer = app.ask(&cookie, &format!("GET /api/can/{first}/answer"), "");
    assert!(answer.status == 422 && answer.text().contains("not kept"), "{}", answer.text());
}

#[test]
fn exact_a_try_reads_no_file_outside_of_the_folder() {
    let place = tempfile::tempdir().unwrap();
    let open = place.path().join("open");
    fs::create_dir(&open).unwrap();
    fs::write(open.join("bench.toml"), BENCH).unwrap();
    fs::write(place.path().join("secret.csv"), "time [s],dyno_speed_demand [rpm]\n0,1\n1,2\n").unwrap();
    let app = app_on(&open);
    let cookie = app.enter();
    for name in ["../secret.csv", "/etc/passwd", "Cargo.toml"] {
        let answer = post(&app, &cookie, &question(name));
        assert!(answer.status == 403 || answer.status == 404, "{name}: {}", answer.text());
    }
    let mut other = question("tip-in");
    other["engine_map"] = "../secret.csv".into();
    assert_eq!(post(&app, &cookie, &other).status, 403);
}
