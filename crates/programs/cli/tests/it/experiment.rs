//! `dynoid experiment`.

use std::collections::BTreeSet;

use recording::{Recording, Selection, decode};

use crate::support::{BENCH, Campaign, bs};

/// A bench file with a shaft that is known, and more tables.
fn bench(more: &str) -> String {
    BENCH.replace("[channels]", &format!("{more}\n[channels]"))
}

const SHAFT: &str = "[shaft]\nresonance = \"18 Hz\"\n";

fn recorded(campaign: &Campaign, name: &str) -> Recording {
    let bytes = std::fs::read(campaign.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    decode(name, &bytes, &Selection::All).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn samples<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    let names = || recording.channels.iter().map(|c| c.name.as_str()).collect::<Vec<_>>();
    &recording.channel(name).unwrap_or_else(|| panic!("{name} is not in {:?}", names())).samples
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[track_caller]
fn done(campaign: &Campaign, arguments: &[&str]) {
    let ran = campaign.run(arguments);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
}

#[test]
fn snap_list() {
    let campaign = Campaign::empty();
    insta::assert_snapshot!("experiment_list", campaign.run(&["experiment", "list"]).stdout);
    insta::assert_snapshot!("experiment_list_one", campaign.run(&["experiment", "list", "BS_T_NT"]).stdout);
    let json = campaign.run(&["experiment", "list", "--json"]).json();
    assert_eq!(json["experiments"].as_array().map(Vec::len), Some(10));
    assert_eq!(json["experiments"][0]["parameters"][3]["name"], "low");
    assert_eq!(json["shapes"].as_array().map(Vec::len), Some(9));
    let shape = campaign.run(&["experiment", "list", "sine-sweep"]);
    assert_eq!(shape.code, Some(0), "{}", shape.stderr);
    for words in ["amplitude", "first frequency", "Hz", "100", "--set NAME=VALUE"] {
        assert!(shape.stdout.contains(words), "`{words}` is not in {}", shape.stdout);
    }
    campaign.run(&["experiment", "list", "sine-sweeps"]).assert_refused(2, &["BS_T_NT", "sine-sweep"]);
}

#[test]
fn snap_design() {
    let campaign = Campaign::empty();
    let limits = "[limits]\nshaft_torque = \"50 Nm\"\nspeed = \"6000 rpm\"\n";
    campaign.write("bench.toml", bench(&format!("{limits}{SHAFT}")).as_bytes());
    let arguments = ["experiment", "design", "bench.toml", "Step_T_TN", "--duration", "6", "--speed", "1500"];
    let ran = campaign.run(&arguments);
    assert_eq!(ran.code, Some(0));
    assert!(ran.stderr.starts_with("warning: T_shaft reaches 9"), "{}", ran.stderr);
    insta::assert_snapshot!("experiment_design", ran.stdout);
    let csv = recorded(&campaign, "experiments/Step_T_TN_1500.csv");
    let mf4 = recorded(&campaign, "experiments/Step_T_TN_1500.mf4");
    // Text has one time column, on which the slower demand is held.
    let held: Vec<f64> = samples(&csv, "dyno_torque_demand").iter().step_by(10).copied().collect();
    assert_eq!(held, samples(&mf4, "dyno_torque_demand"));
    let lengths = ["dyno_torque_demand", "engine_speed_demand"].map(|name| samples(&csv, name).len());
    assert_eq!((csv.rasters.len(), lengths, held.len()), (1, [6000; 2], 600));
    let page = campaign.read("experiments/Step_T_TN_1500.html");
    assert!(page.contains("What the bench will do") && page.contains("resonance") && page.contains("firing, /2, /4"));
    let predicted = recorded(&campaign, "experiments/Step_T_TN_1500_predicted.mf4");
    assert_eq!(samples(&predicted, "DynoSpeed_predicted").len(), 6000);
}

#[test]
fn exact_a_design_without_a_known_shaft_is_written_and_says_what_is_missing() {
    let campaign = Campaign::empty();
    let ran = campaign.run(&["experiment", "design", "bench.toml", "BS_T_NT", "--duration", "4", "--json"]);
    assert_eq!(ran.code, Some(0));
    assert!(
        ran.stderr.contains("nothing is predicted") && ran.stderr.contains("resonance = \"18 Hz\""),
        "{}",
        ran.stderr
    );
    let json = ran.json();
    assert!(json["prediction"].is_null() && json["not_predicted"].is_string());
    assert!(campaign.path("experiments/BS_T_NT_1200.csv").exists());
    assert!(!campaign.path("experiments/BS_T_NT_1200_predicted.mf4").exists());
    let alone = campaign.run(&["experiment", "design", "bench.toml", "NoShaft_N_NT", "--json"]).json();
    assert!(alone["prediction"]["peaks"].as_array().is_some_and(|peaks| peaks.len() == 3), "the shaft is off: {alone}");
}

#[test]
fn exact_demands_of_a_design_are_those_that_are_recorded() {
    let campaign = Campaign::empty();
    for (name, stem, recorded_as, demand, tolerance) in [
        ("Levels_N_NT", "Levels_N_NT_1200", "DynoSpeedDemand", "dyno_speed_demand", 1e-9),
        ("WhiteNoise_T_TN", "WhiteNoise_T_TN_1200", "DynoTorqueDemand", "dyno_torque_demand", 0.00501),
    ] {
        let ran =
            campaign.run(&["experiment", "design", "bench.toml", name, "--duration", "5", "--seed", "3", "--json"]);
        let csv = ran.json()["files"][0].as_str().unwrap().to_owned();
        assert!(csv.contains(stem), "{csv}");
        let simulate = ["experiment", "simulate", "bench.toml", "--quiet", "--seed", "3"];
        let by_name = [&simulate[..], &[name, "--duration", "5", "--out", "by_name.mf4"]].concat();
        let by_file = [&simulate[..], &[csv.as_str(), "--out", "by_file.mf4"]].concat();
        done(&campaign, &by_name);
        done(&campaign, &by_file);
        let (one, other) = (recorded(&campaign, "by_name.mf4"), recorded(&campaign, "by_file.mf4"));
        assert!(largest_difference(samples(&one, recorded_as), samples(&other, recorded_as)) < 1e-9, "{name}");
        assert!(largest_difference(samples(&one, "DynoSpeed"), samples(&other, "DynoSpeed")) < 0.011, "{name}");
        // What is recorded every millisecond is what the file says, each of its values held.
        let (taken, every) = (recorded(&campaign, &csv), samples(&one, recorded_as));
        let step = every.len() / samples(&taken, demand).len();
        let held: Vec<f64> = every.iter().step_by(step).copied().collect();
        assert!(largest_difference(&held, samples(&taken, demand)) <= tolerance, "{name}");
    }
}

#[test]
fn exact_equal_seeds_give_equal_bytes_and_the_truth_only_on_request() {
    let campaign = Campaign::empty();
    let run = |seed: &str, out: &str, more: &[&str]| {
        let simulate = ["experiment", "simulate", "bench.toml", "BS_T_NT"];
        let arguments = [&simulate[..], &["--duration", "2", "--seed", seed, "--overwrite", "--out", out]].concat();
        let ran = campaign.run(&[&arguments[..], more].concat());
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
        std::fs::read(campaign.path(out)).unwrap()
    };
    for ending in ["mf4", "csv", "mat", "parquet", "arrow"] {
        let (one, two) = (format!("BS_T_NT_1.{ending}"), format!("BS_T_NT_2.{ending}"));
        assert_eq!(run("4", &one, &[]), run("4", &two, &["--truth", "truth.mf4"]), "{ending}");
    }
    assert_ne!(run("4", "BS_T_NT_1.csv", &[]), run("5", "BS_T_NT_1.csv", &[]));
    let names = |name: &str| recorded(&campaign, name).channels.into_iter().map(|c| c.name).collect::<BTreeSet<_>>();
    assert!(names("BS_T_NT_1.mf4").iter().all(|name| !name.contains("true")));
    assert!(names("truth.mf4").contains("true_shaft_torque"));
    let comment = recorded(&campaign, "BS_T_NT_1.mf4").comment.unwrap_or_default();
    assert_eq!(comment, "BS_T_NT, virtual bench");
}

#[test]
fn exact_channels_have_the_names_units_and_signs_of_the_bench_file() {
    let campaign = Campaign::empty();
    let text = BENCH
        .replace("dyno_speed = \"DynoSpeed\"", "dyno_speed = { name = \"n_Br\", unit = \"rad/s\" }")
        .replace("air_gap_torque = \"DynoTorqueCalc\"", "air_gap_torque = { name = \"M_Br\", sign = -1 }");
    campaign.write("other.toml", text.as_bytes());
    for (bench, out) in [("bench.toml", "BS_T_NT_a.mf4"), ("other.toml", "BS_T_NT_b.mf4")] {
        done(&campaign, &["experiment", "simulate", bench, "BS_T_NT", "--duration", "1", "--out", out]);
    }
    let (usual, other) = (recorded(&campaign, "BS_T_NT_a.mf4"), recorded(&campaign, "BS_T_NT_b.mf4"));
    let rpm: Vec<f64> = samples(&other, "n_Br").iter().map(|w| w * 30.0 / std::f64::consts::PI).collect();
    assert!(largest_difference(&rpm, samples(&usual, "DynoSpeed")) < 1e-9);
    assert_eq!(other.channel("n_Br").unwrap().unit, "rad/s");
    let turned: Vec<f64> = samples(&other, "M_Br").iter().map(|torque| -torque).collect();
    assert_eq!(turned, samples(&usual, "DynoTorqueCalc"));
}

#[test]
fn stat_a_study_of_a_simulated_campaign_finds_its_bench_and_its_model_serves() {
    let campaign = Campaign::empty();
    let more = "[virtual_bench.mechanics]\nshaft_stiffness_nm_per_rad = 3100.0\nshaft_damping_nm_s_per_rad = 8.0\n";
    campaign.write("bench.toml", bench(more).as_bytes());
    for experiment in ["BS_T_NT", "WhiteNoise_T_TN"] {
        let out = format!("recordings/{experiment}_1200.mf4");
        done(&campaign, &["experiment", "simulate", "bench.toml", experiment, "--duration", "20", "--out", &out]);
    }
    let study = campaign.run(&["study", "bench.toml", "--json"]).study();
    let text = campaign.read("study/study.json");
    let model = study::model(&text).unwrap();
    let mechanics = model.model.mechanics;
    assert!((mechanics.stiffness_nm_per_rad / 3100.0 - 1.0).abs() < 0.03, "{study}");
    assert!((mechanics.damping_nm_s_per_rad / 8.0 - 1.0).abs() < 0.1, "{study}");
    let design = ["experiment", "design", "bench.toml", "BS_T_NT", "--duration", "4", "--model", "study/study.json"];
    let json = campaign.run(&[&design[..], &["--json"]].concat()).json();
    assert_eq!(json["prediction"]["from"], "study");
    let peaks = json["prediction"]["peaks"].as_array().unwrap();
    assert!(
        peaks.iter().any(|peak| peak["of"] == "shaft_torque" && peak["standard_error"].as_f64() > Some(0.0)),
        "{json}"
    );
    let check = ["experiment", "check", "bench.toml", "BS_T_NT", "--duration", "4", "--samples", "10", "--json"];
    let json = campaign.run(&[&check[..], &["--model", "study/study.json"]].concat()).json();
    assert_eq!((&json["spread"]["from"], &json["verdict"]), (&"study".into(), &"not_checked".into()));
    let shaft = &json["limits"][0];
    assert!(shaft["quantile_95"].as_f64() > shaft["quantile_5"].as_f64(), "{json}");
    let with_document = campaign.run(&[&check[..], &["--model", "study/model.json"]].concat()).json();
    assert_eq!(with_document["limits"], json["limits"], "model.json and study.json hold the same model");
    campaign.write("old.json", text.replace("\"format_version\":3", "\"format_version\":9").as_bytes());
    let old = [&design[..6], &["--model", "old.json"]].concat();
    campaign.run(&old).assert_refused(3, &["old.json", "version 9, where 2 to 3 are read", "dynoid study"]);
}

#[test]
fn regress_wrong_combinations_are_refused_in_words() {
    let campaign = Campaign::empty();
    let refused = |arguments: &[&str], code, words: &[&str]| campaign.run(arguments).assert_refused(code, words);
    refused(&["experiment", "simulate", "bench.toml"], 2, &["NAME|FILE"]);
    refused(&["experiment", "simulate", "bench.toml", "BS_T_NT"], 2, &["--out run.mf4"]);
    refused(&["experiment", "simulate", "bench.toml", "BS_T_NT", "--on", "run.mf4"], 2, &["--on"]);
    refused(&["model", "simulate", "model.json"], 2, &["--on"]);
    refused(&["model", "simulate", "model.json", "--on", "run.mf4", "--seed", "1"], 2, &["--seed"]);
    campaign.write("model.json", b"{\"format\": \"dynoid model\"}");
    let model = ["experiment", "simulate", "model.json", "BS_T_NT", "--out", "run.mf4"];
    refused(&model, 2, &["model.json", "this is a model file", "--model"]);
    let run = |more: &[&'static str]| [&["experiment", "simulate", "bench.toml", "--out", "run.mf4"], more].concat();
    refused(&run(&["BS_N_NT"]), 2, &["did you mean `BS_T_NT`"]);
    refused(&run(&["BS_T_NT", "--set", "hihg=3"]), 2, &["did you mean `high`"]);
    refused(&run(&["BS_T_NT", "--set", "high"]), 2, &["NAME=VALUE"]);
    refused(&run(&["none.csv"]), 3, &["none.csv", "no such file"]);
    refused(
        &run(&["BS_T_NT", "--model", "bench.toml"]),
        3,
        &["bench.toml", "not a model file", "give a model.json or study.json"],
    );
    refused(&run(&["BS_T_NT", "--truth", "run.mf4"]), 2, &["a file each"]);
    campaign.write("demands.csv", b"time [s],speed\n0,1\n1,2\n");
    refused(&run(&["demands.csv"]), 3, &["demands.csv", "dyno_speed_demand"]);
    campaign.write("bench.toml", bench("[virtual_bench.mechanics]\nshaft_stifness = 1\n").as_bytes());
    refused(&run(&["BS_T_NT"]), 3, &["line 10", "shaft_stiffness_nm_per_rad"]);
    assert!(!campaign.path("run.mf4").exists());
}

#[test]
fn regress_a_level_shorter_than_a_firing_is_said() {
    let campaign = Campaign::empty();
    let ran = campaign.run(&["experiment", "design", "bench.toml", "BS_T_NT", "--speed", "300", "--duration", "2"]);
    assert!(ran.stderr.contains("every 80 ms, but a cylinder fires every 100 ms"), "{}", ran.stderr);
}

#[test]
fn regress_an_experiment_is_checked_before_it_is_run() {
    let campaign = Campaign::empty();
    let file = |limits: &str| bench(&format!("[limits]\n{limits}\n{SHAFT}damping = \"2 Nm s/rad\"\n"));
    campaign.write("bench.toml", file("shaft_torque = \"140 Nm\"\nspeed = \"3000 rpm\"").as_bytes());
    let check = ["experiment", "check", "bench.toml", "--samples", "80", "--duration", "10"];
    let of = |more: &[&'static str]| campaign.run(&[&check[..], more].concat());
    let sine = of(&["Sine_T_TN", "--set", "amplitude=40", "--plot", "check.html"]);
    assert_eq!(sine.code, Some(1), "{}", sine.stderr);
    assert!(sine.stdout.contains("UNSAFE") && sine.stdout.contains("18 Hz"), "{}", sine.stdout);
    assert!(campaign.read("check.html").contains("How large a sine may be"));
    let json = of(&["Sine_T_TN", "--set", "amplitude=40", "--json"]).json();
    assert_eq!((&json["verdict"], &json["spread"]["from"]), (&"unsafe".into(), &"prior".into()));
    let sines = json["sines"]["sines"].as_array().unwrap();
    let safe = |hz: f64| sines.iter().find(|sine| sine["frequency_hz"] == hz).unwrap()["safe_nm"].as_f64().unwrap();
    assert!(safe(18.0) < 40.0 && safe(5.0) > 40.0, "{json}");
    // What compression makes of a motored engine is not known, and drawn.
    campaign.write("bench.toml", file("shaft_torque = \"200 Nm\"\nspeed = \"3000 rpm\"").as_bytes());
    let motored = ["Unfired_N_NT", "--allow-unchecked"];
    let quiet = of(&motored);
    assert_eq!(quiet.code, Some(0), "{}{}", quiet.stdout, quiet.stderr);
    assert!(quiet.stdout.contains("SAFE by the limits that are stated; 6 of 8 limits not checked"), "{}", quiet.stdout);
    assert_eq!(of(&motored[..1]).code, Some(1), "six limits are not stated");
    // The engine fires near the resonance at 600 rpm; its mean torque stays at half of the shaft's limit.
    let fired = of(&["BS_T_NT", "--speed", "600", "--allow-unchecked"]);
    assert!(fired.code == Some(1) && fired.stdout.contains("UNSAFE"), "{}", fired.stdout);
    let none = ["experiment", "check", "bench.toml", "Sine_T_TN", "--samples", "0"];
    campaign.run(&none).assert_refused(2, &["--samples"]);
}

#[test]
fn regress_what_cannot_be_checked_is_not_safe() {
    let campaign = Campaign::empty();
    campaign.write("bench.toml", BENCH.as_bytes());
    let check = ["experiment", "check", "bench.toml", "Step_T_TN", "--duration", "4", "--samples", "5"];
    campaign.run(&check).assert_refused(3, &["bench.toml", "the shaft is not known"]);
    campaign.write("bench.toml", bench(SHAFT).as_bytes());
    let ran = campaign.run(&check);
    assert_eq!(ran.code, Some(1));
    assert!(ran.stdout.contains("NOT CHECKED") && ran.stdout.contains("add [limits]"), "{}", ran.stdout);
}

#[test]
fn exact_an_optimal_excitation_is_designed_checked_and_run() {
    let campaign = Campaign::empty();
    let limits = "[limits]\ntorque = \"400 Nm\"\nshaft_torque = \"300 Nm\"\nspeed = \"6000 rpm\"\n";
    campaign.write("bench.toml", bench(&format!("{limits}{SHAFT}")).as_bytes());
    let optimal = ["experiment", "design", "bench.toml", "--speed", "1500", "--duration", "8", "--json", "--optimal"];
    let of = |more: &[&'static str]| campaign.run(&[&optimal[..], more].concat());
    let designed = of(&["K,B", "--peak-shaft-torque", "40"]).json();
    let facts = &designed["optimal"];
    assert_eq!((&facts["goals"][0], &facts["parameters"][1]["symbol"]), (&"K".into(), &"B".into()));
    for parameter in facts["parameters"].as_array().unwrap() {
        assert!(parameter["standard_error"].as_f64() < parameter["white_noise_standard_error"].as_f64(), "{facts}");
    }
    assert!(facts["largest_deviations"]["shaft_torque_nm"].as_f64() <= Some(40.0001), "{facts}");
    let csv = "experiments/Multisine_T_TN_1500_K_B.csv";
    let demand = recorded(&campaign, csv);
    let torque = samples(&demand, "dyno_torque_demand");
    assert!((torque.len(), torque[9]) == (8000, 60.0) && torque[10] != 60.0, "it starts at its mean");
    assert!(campaign.read("experiments/Multisine_T_TN_1500_K_B.html").contains("Lines of the excitation"));
    let check = ["experiment", "check", "bench.toml", csv, "--samples", "80"];
    assert_eq!(campaign.run(&check).code, Some(1), "three of six limits are not stated");
    let checked = campaign.run(&[&check[..], &["--allow-unchecked"]].concat());
    assert_eq!(checked.code, Some(0), "{}{}", checked.stdout, checked.stderr);
    let run = "recordings/Multisine_T_TN_1500.mf4";
    done(&campaign, &["experiment", "simulate", "bench.toml", csv, "--out", run]);
    // What was designed to tell of the shaft is what a study takes for it.
    campaign.run(&["study", "bench.toml", "--quiet"]);
    let study: serde_json::Value = serde_json::from_str(&campaign.read("study/study.json")).unwrap();
    let used = study["study"]["recordings"][0]["used_for"].to_string();
    assert!(used.contains("shaft") && used.contains("torque_control"), "{used}");
    let binary = of(&["PI,FF,J_e", "--form", "binary"]).json();
    assert_eq!(binary["label"], "Binary_N_NT");
    assert_eq!(binary["optimal"]["parameters"].as_array().map(Vec::len), Some(5));
    let peaks = binary["prediction"]["peaks"].as_array().unwrap();
    assert!(peaks.iter().all(|peak| peak["is_beyond_limit"] == false), "{binary}");
    of(&["PI", "--excite", "T"]).assert_refused(2, &["PI, FF and J_e show in speed control"]);
    of(&["K,Q"]).assert_refused(2, &["`Q` is none of K, B, J_d, J_e, PI, FF, TC"]);
    of(&["K", "--set", "torque=700"]).assert_refused(2, &["[limits] leaves nothing"]);
}

#[test]
fn exact_next_says_what_to_record() {
    let campaign = Campaign::empty().with("BS_T_NT_1200.mf4", &bs());
    let json = campaign.run(&["experiment", "next", "bench.toml", "--duration", "12", "--json"]).json();
    let known = |list: &serde_json::Value, symbol: &str| list.as_array().unwrap().iter().any(|p| p["symbol"] == symbol);
    assert!(known(&json["now"], "K") && !known(&json["now"], "J_e"));
    let best = &json["candidates"][0];
    assert_eq!(best["duration_s"], 12.0);
    let words = campaign.run(&["experiment", "next", "bench.toml", "--duration", "12"]);
    assert_eq!(words.code, Some(0), "{}", words.stderr);
    let label = best["label"].as_str().unwrap();
    for expected in [&format!("Record {label}, 12 s at 1200 rpm next"), "not known", "gain nothing", "--speed 1200"] {
        assert!(words.stdout.contains(expected), "{expected} is not in {}", words.stdout);
    }
}

#[test]
fn exact_next_without_recordings_needs_a_shaft() {
    let campaign = Campaign::empty();
    let refused = campaign.run(&["experiment", "next", "bench.toml"]);
    refused.assert_refused(2, &["bench.toml", "[shaft]", "BS_T_NT"]);
    campaign.write("known.toml", bench(SHAFT).as_bytes());
    let json = campaign.run(&["experiment", "next", "known.toml", "--duration", "12", "--json"]).json();
    assert_eq!(json["now"], serde_json::json!([]));
    campaign.run(&["experiment", "next", "known.toml", "--duration", "-3"]).assert_refused(2, &["--duration"]);
    campaign.run(&["experiment", "next", "known.toml", "--duration", "0.5"]).assert_refused(2, &["0.5"]);
}

#[test]
fn regress_a_measured_recording_is_never_replaced_by_a_simulation() {
    let campaign = Campaign::empty();
    let run = |out: &str, more: &[&str]| {
        let simulate = ["experiment", "simulate", "bench.toml", "BS_T_NT", "--duration", "2", "--out", out];
        campaign.run(&[&simulate[..], more].concat())
    };
    campaign.write("measured.mf4", b"MDF     4.10    INCA    a recording of a real bench");
    run("measured.mf4", &[]).assert_refused(4, &["measured.mf4", "--overwrite"]);
    assert!(campaign.read("measured.mf4").contains("INCA"));
    // What a simulation wrote, another may replace; among measured recordings there is no place for either.
    assert_eq!(run("recordings/BS_T_NT_1.mf4", &[]).code, Some(0));
    assert_eq!(run("recordings/BS_T_NT_1.mf4", &[]).code, Some(0));
    campaign.write("recordings/BS_T_NT_2.mf4", b"MDF     4.10    INCA    a recording of a real bench");
    run("recordings/BS_T_NT_3.mf4", &[]).assert_refused(4, &["recordings/BS_T_NT_3.mf4", "bench.toml"]);
    assert_eq!(run("measured.mf4", &["--overwrite"]).code, Some(0));
}
