//! Texts that are edited: nobody's change is overwritten, and nothing that was typed is lost.

use std::fs;

use crate::browser::{Answered, app_on};

fn state_of(answer: &Answered) -> Option<String> {
    let read: serde_json::Value = serde_json::from_slice(&answer.body).unwrap();
    read["state"].as_str().map(|state| format!("if-match: {state}"))
}

#[test]
fn exact_a_file_that_was_changed_elsewhere_stays() {
    let place = tempfile::tempdir().unwrap();
    let file = place.path().join("bench.toml");
    fs::write(&file, "# first").unwrap();
    let app = app_on(place.path());
    let cookie = app.enter();
    let put = |state: Option<&str>, text: &str| {
        let (host, origin) = (app.host(), app.origin());
        let heads = [&host, &origin, &cookie].map(String::as_str);
        let heads: Vec<&str> = heads.into_iter().chain(state).collect();
        app.send("PUT /api/text?file=bench.toml", &heads, text)
    };
    let state = state_of(&app.ask(&cookie, "GET /api/text?file=bench.toml", ""));
    let saved = put(state.as_deref(), "# mine");
    assert_eq!(saved.status, 200);
    assert_eq!(fs::read_to_string(&file).unwrap(), "# mine");
    // The state of before is not that of now.
    assert_eq!(put(state.as_deref(), "# again").status, 412);
    fs::write(&file, "# theirs").unwrap();
    let refused = put(state_of(&saved).as_deref(), "# mine, too");
    assert_eq!(refused.status, 412);
    assert!(refused.text().contains("changed elsewhere"), "{}", refused.text());
    // One that was not there may have been made since.
    assert_eq!(put(None, "# new").status, 412);
    assert_eq!(fs::read_to_string(&file).unwrap(), "# theirs");
}

#[test]
fn exact_faults_of_a_bench_file_have_their_lines() {
    let place = tempfile::tempdir().unwrap();
    let app = app_on(place.path());
    let cookie = app.enter();
    let text = "[bench]\nname = \"Cell 4\"\ncylinderz = 4\n";
    let answer = app.ask(&cookie, "POST /api/check?file=bench.toml", text);
    let checked: serde_json::Value = serde_json::from_slice(&answer.body).unwrap();
    assert_eq!(checked["values"]["bench"]["name"], "Cell 4");
    let faults = checked["faults"].as_array().unwrap();
    let wrong = faults.iter().find(|fault| fault["line"] == 3).unwrap();
    assert!(wrong["text"].as_str().unwrap().contains("cylinders"), "{wrong}");
    assert!(faults.len() > 1, "what is missing counts, too");
    assert_eq!(app.ask(&cookie, "POST /api/check?file=bench.toml", "[bench").status, 200);
}

#[test]
fn exact_what_was_typed_outlives_the_program() {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("bench.toml"), "# saved").unwrap();
    let app = app_on(place.path());
    let cookie = app.enter();
    assert_eq!(app.ask(&cookie, "PUT /api/draft?file=bench.toml", "# typed\nä ≤ \u{1F600}").status, 200);
    let another = app_on(place.path());
    let cookie = another.enter();
    let draft: serde_json::Value =
        serde_json::from_slice(&another.ask(&cookie, "GET /api/draft?file=bench.toml", "").body).unwrap();
    assert_eq!(draft["text"], "# typed\nä ≤ \u{1F600}");
    // What is saved is no draft any more.
    let state = state_of(&another.ask(&cookie, "GET /api/text?file=bench.toml", "")).unwrap();
    let heads = [another.host(), another.origin(), cookie.clone(), state];
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    assert_eq!(another.send("PUT /api/text?file=bench.toml", &heads, "# typed").status, 200);
    let draft = another.ask(&cookie, "GET /api/draft?file=bench.toml", "").text();
    assert!(draft.contains("\"text\":null"), "{draft}");
}
