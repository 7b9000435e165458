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
fn regress_an_existing_bench_file_is_kept_unless_forced() {
    let campaign = Campaign::whole();
    let before = campaign.read("bench.toml");
    campaign.run(&["init", "recordings"]).assert_refused(4, &["bench.toml", "--force"]);
    assert_eq!(campaign.read("bench.toml"), before);
    assert_eq!(campaign.run(&["init", "recordings", "--force"]).code, Some(0));
    assert_ne!(campaign.read("bench.toml"), before);
}

/// The proposal's own comments name the program, whatever is filled in.
#[test]
fn regress_the_programs_own_bench_files_are_updated_and_replaced() {
    let campaign = Campaign::whole();
    assert_eq!(campaign.run(&["init", "recordings", "--out", "new.toml"]).code, Some(0));
    for name in ["", "C", "Cell 4", "A test cell with a long name, in the old hall"] {
        let begin = filled_in(&campaign.read("new.toml"));
        let (before, after) = begin.split_once("name = \"").unwrap();
        let rest = after.split_once('"').unwrap().1;
        campaign.write("new.toml", format!("{before}name = \"{name}\"{rest}").as_bytes());
        let updated = campaign.run(&["init", "recordings", "--out", "new.toml", "--update"]);
        assert_eq!(updated.code, Some(0), "{name}: {}", updated.stderr);
    }
    campaign.run(&["init", "recordings", "--out", "new.toml"]).assert_refused(4, &["new.toml", "--force"]);
    assert_eq!(campaign.run(&["init", "recordings", "--out", "new.toml", "--force"]).code, Some(0));
    assert!(!campaign.read("new.toml").contains("old hall"));
    campaign.write("new.toml", filled_in(&campaign.read("new.toml")).as_bytes());
    let demo = format!("# Written by dynoid demo {}\n{}", env!("CARGO_PKG_VERSION"), campaign.read("new.toml"));
    campaign.write("demo.toml", demo.as_bytes());
    assert_eq!(campaign.run(&["init", "recordings", "--out", "demo.toml", "--update"]).code, Some(0));
    assert_eq!(campaign.read("demo.toml"), demo);
}

/// Tables may be written in any way that TOML has.
#[test]
fn regress_an_update_that_cannot_be_placed_is_refused() {
    let campaign = Campaign::whole();
    let channels = "[ channels ]\ndyno_speed = \"DynoSpeed\"\n\n[limits]\ntorque = \"380 Nm\"\n";
    let text = format!("[bench]\nname = \"Cell 4\"\n\n{channels}");
    campaign.write("cell.toml", text.as_bytes());
    campaign
        .run(&["init", "recordings", "--out", "cell.toml", "--update"])
        .assert_refused(2, &["cell.toml", "by hand"]);
    assert_eq!(campaign.read("cell.toml"), text);
}

#[test]
fn exact_files_and_folders_are_listed_relative_to_the_bench_file() {
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
fn exact_the_folder_of_the_recordings_itself_can_hold_the_bench_file() {
    let campaign = Campaign::whole();
    assert_eq!(campaign.run(&["init", "recordings", "--out", "recordings/bench.toml"]).code, Some(0));
    assert!(campaign.read("recordings/bench.toml").contains("files = [\"*.mf4\"]"));
}

#[test]
fn regress_nothing_readable() {
    let campaign = Campaign::empty();
    campaign.run(&["init", "recordings", "--out", "b.toml"]).assert_refused(3, &["this folder has no recordings"]);
    campaign.write("recordings/BS_T_NT.mf4", b"not a measurement");
    campaign
        .run(&["init", "recordings", "--out", "b.toml"])
        .assert_refused(3, &["BS_T_NT.mf4", "no recording can be read (1 tried)"]);
    assert!(!campaign.path("b.toml").exists());
}

/// A bench file as a person leaves it: values, comments and order of their own.
#[test]
fn exact_an_update_adds_what_is_new_and_keeps_the_rest() {
    let edited = r#"# Cell 4, after the rebuild in May
[recordings]
files = [
  "recordings/BS*.mf4", # speed control
]
[[recordings.label]]
file = "recordings/BS_T_NT_1200.mf4"
label = "BS_T_NT"

[bench]
name = "Cell 4"
strokes = 4
cylinders = 4
variant = "load-cell"
dynamometer_inertia = "0.6 kg m²" # weighed
engine_inertia = 0.28

[channels]
# the new encoder
dyno_speed = { name = "DynoSpeed", unit = "rpm" }
air_gap_torque = "DynoTorqueCalc"
engine_speed = "EngineSpeed"

# of the drive
[limits]
torque = "380 Nm"
"#;
    let campaign = Campaign::whole().with("second.mf4", &white_noise());
    campaign.write("cell.toml", edited.as_bytes());
    let update = ["init", "recordings", "--out", "cell.toml", "--update", "--quiet"];
    let ran = campaign.run(&update);
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
    let text = campaign.read("cell.toml");
    let mut rest = text.lines();
    for line in edited.lines().filter(|line| !line.contains("BS*.mf4")) {
        assert!(rest.any(|other| other == line), "`{line}` is not in its place:\n{text}");
    }
    assert!(text.contains("\n  \"recordings/BS*.mf4\", \"recordings/*.mf4\" # speed control\n]"), "{text}");
    let now: toml::Table = text.parse().unwrap();
    let files: Vec<&str> = now["recordings"]["files"].as_array().unwrap().iter().filter_map(|f| f.as_str()).collect();
    assert_eq!(files, ["recordings/BS*.mf4", "recordings/*.mf4"]);
    assert_eq!(now["channels"]["dyno_torque_demand"].as_str(), Some("DynoTorqueDemand"));
    assert_eq!(now["channels"]["dyno_speed"]["name"].as_str(), Some("DynoSpeed"));
    assert_eq!(now["recordings"]["label"].as_array().map(Vec::len), Some(2), "{text}");
    assert_eq!(campaign.run(&update).code, Some(0));
    assert_eq!(campaign.read("cell.toml"), text, "nothing is added twice");
    let both = [&update[..], &["--force"]].concat();
    campaign.run(&both).assert_refused(2, &["--force"]);
}
