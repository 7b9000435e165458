//! `dynoid init`.

use crate::support::{Campaign, bs, white_noise};

/// The bench file with all that no recording can tell.
fn filled_in(text: &str) -> String {
    text.replace("cylinders = \"FILL IN\"", "cylinders = 4")
        .replace("dynamometer_inertia = \"FILL IN\"", "dynamometer_inertia = \"0.6 kg m²\"")
        .replace("engine_inertia = \"FILL IN\"", "engine_inertia = \"0.28 kg m²\"")
}

#[test]
fn snap_init_proposes_a_bench_file_that_studies_once_filled_in() {
    let campaign = Campaign::whole();
    let ran = campaign.run(&["init", "recordings", "--out", "new.toml"]);
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
    insta::assert_snapshot!("init", ran.stdout);
    campaign
        .run(&["study", "new.toml"])
        .assert_refused(3, &["new.toml", "line 7: bench.cylinders", "bench.dynamometer_inertia", "fill"]);
    campaign.write("new.toml", filled_in(&campaign.read("new.toml")).as_bytes());
    let study = campaign.run(&["study", "new.toml", "--json"]).study();
    assert_eq!(study["recordings"].as_array().map(Vec::len), Some(2));
}

#[test]
fn an_existing_bench_file_is_kept_unless_forced() {
    let campaign = Campaign::whole();
    let before = campaign.read("bench.toml");
    campaign.run(&["init", "recordings"]).assert_refused(4, &["bench.toml", "--force"]);
    assert_eq!(campaign.read("bench.toml"), before);
    assert_eq!(campaign.run(&["init", "recordings", "--force"]).code, Some(0));
    assert_ne!(campaign.read("bench.toml"), before);
}

#[test]
fn files_and_folders_are_listed_relative_to_the_bench_file() {
    let campaign = Campaign::empty().with("[1] BS_T_NT.mf4", &bs()).with("second.MF4", &white_noise());
    std::fs::create_dir(campaign.path("benches")).unwrap();
    let arguments =
        ["init", "recordings/[1] BS_T_NT.mf4", "recordings/second.MF4", "--out", "benches/b.toml", "--json"];
    let proposal = campaign.run(&arguments).json();
    assert_eq!(proposal["unlabelled"], serde_json::json!(["../recordings/second.MF4"]));
    let text = campaign.read("benches/b.toml");
    assert!(text.contains(r#"files = ["../recordings/[1] BS_T_NT.mf4", "../recordings/second.MF4"]"#), "{text}");
    let text = filled_in(&text).replacen("label = \"FILL IN\"", "label = \"WhiteNoise_T_TN\"", 1);
    campaign.write("benches/b.toml", text.as_bytes());
    let study = campaign.run(&["study", "benches/b.toml", "--json"]).study();
    let labels: Vec<&str> =
        study["recordings"].as_array().unwrap().iter().filter_map(|r| r["label"].as_str()).collect();
    assert_eq!(labels, ["BS_T_NT", "WhiteNoise_T_TN"]);
}

#[test]
fn the_folder_of_the_recordings_itself_can_hold_the_bench_file() {
    let campaign = Campaign::whole();
    assert_eq!(campaign.run(&["init", "recordings", "--out", "recordings/bench.toml"]).code, Some(0));
    assert!(campaign.read("recordings/bench.toml").contains("files = [\"*.mf4\"]"));
}

#[test]
fn nothing_readable() {
    let campaign = Campaign::empty();
    campaign.run(&["init", "recordings", "--out", "b.toml"]).assert_refused(3, &["this folder has no recordings"]);
    campaign.write("recordings/BS_T_NT.mf4", b"not a measurement");
    campaign
        .run(&["init", "recordings", "--out", "b.toml"])
        .assert_refused(3, &["BS_T_NT.mf4", "no recording can be read (1 tried)"]);
    assert!(!campaign.path("b.toml").exists());
}
