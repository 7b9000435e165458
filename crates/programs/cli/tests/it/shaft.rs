//! `dynoid shaft`: the shaft of simulated recordings.

use rig::experiment::ExperimentPlan;

use crate::support::{Campaign, bs, channel, simulated};

#[test]
fn stat_each_recording_and_all_together_tell_the_shaft_that_was_simulated() {
    let campaign = Campaign::whole();
    let recordings = ["recordings/BS_T_NT_1200.mf4", "recordings/WhiteNoise_T_TN_1200.mf4"];
    let line = ["shaft", "bench.toml", recordings[0], recordings[1], "--plot", "shaft.html"];
    let ran = campaign.run(&line);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let text = ran.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in [
        "time stamps taken as exact",
        "J_e",
        "loss factor",
        "All recordings together",
        "the 2 recordings",
        "State space (T_d, ω_e)",
        "for motored engines alone",
    ] {
        assert!(text.to_lowercase().contains(&words.to_lowercase()), "{words}: {text}");
    }
    let page = campaign.read("shaft.html");
    assert!(
        page.contains("from Δω to T_shaft")
            && page.contains("by different methods")
            && page.contains("Recordings side by side")
    );
    let found = campaign.run(&["shaft", "bench.toml", recordings[0], recordings[1], "--json"]).json();
    for (name, truth) in [("stiffness", 2437.7), ("damping", 5.8)] {
        let parameter = &found["together"][name]["parameter"];
        let (value, error) = (parameter["value"].as_f64().unwrap(), parameter["standard_error"].as_f64().unwrap());
        assert!((value - truth).abs() < (4.0 * error).max(0.002 * truth), "{name}: {value} ± {error}");
    }
    let route = &found["recordings"][0]["routes"]["state_space"]["found"]["estimate"]["parameters"][0];
    assert!((route["value"].as_f64().unwrap() / 2437.7 - 1.0).abs() < 0.005, "{route}");
    let inertias = &found["recordings"][1]["inertias"]["found"]["parameters"];
    let engine = inertias.as_array().unwrap().iter().find(|p| p["symbol"] == "J_e").unwrap();
    assert!((engine["value"].as_f64().unwrap() - 0.28).abs() < 0.03, "{engine}");
    assert!(found["recordings"][0]["inertias"].is_null());
}

#[test]
#[ignore = "slow"]
fn stat_a_motored_engine_tells_both_inertias_by_the_black_box() {
    let motored = simulated(&ExperimentPlan::unfired_n_nt(1200.0, 20.0), 4);
    let campaign = Campaign::whole().with("Unfired_N_NT_1200.mf4", &motored);
    let recordings = ["recordings/WhiteNoise_T_TN_1200.mf4", "recordings/Unfired_N_NT_1200.mf4"];
    let ran = campaign.run(&["shaft", "bench.toml", recordings[0], recordings[1]]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let text = ran.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("Black box T_d → ω_d") && text.contains("Means over periods: not taken"), "{text}");
    let found = campaign.run(&["shaft", "bench.toml", recordings[0], recordings[1], "--json"]).json();
    let black_box = &found["recordings"][1]["routes"]["black_box"]["found"]["estimate"]["parameters"];
    for (symbol, truth) in [("J_d", 0.6), ("J_e", 0.28), ("K", 2437.7)] {
        let parameter = black_box.as_array().unwrap().iter().find(|p| p["symbol"] == symbol).unwrap();
        assert!((parameter["value"].as_f64().unwrap() / truth - 1.0).abs() < 0.01, "{parameter}");
    }
    // T_d by its own samples alone folds: no shaft from it.
    let ran = campaign.run(&["shaft", "bench.toml", recordings[1]]);
    let text = [ran.stdout, ran.stderr].concat().split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("its aliases cannot be separated from the shaft") && !text.contains("2437"), "{text}");
}

#[test]
fn regress_recordings_that_tell_no_shaft_say_why() {
    let campaign = Campaign::whole();
    let ran = campaign.run(&["shaft", "bench.toml", "recordings/BS_T_NT_1200.mf4", "--quiet"]);
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(0), ""));
    let mut without_engine = bs();
    channel(&mut without_engine, "EngineSpeed").name = "Another".to_owned();
    let campaign = campaign.with("BS_T_NT_1200.mf4", &without_engine);
    let ran = campaign.run(&["shaft", "bench.toml", "recordings/BS_T_NT_1200.mf4", "--json"]);
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    assert_eq!(ran.json()["recordings"][0]["beyond"]["not_estimated"]["name"], "shaft", "{}", ran.stdout);
    campaign.write("recordings/WhiteNoise_T_TN_1200.mf4", b"no recording");
    let ran = campaign.run(&["shaft", "bench.toml", "recordings/WhiteNoise_T_TN_1200.mf4"]);
    ran.assert_refused(3, &["WhiteNoise_T_TN_1200.mf4", "none of the recordings"]);
    campaign.run(&["shaft", "bench.toml", "missing.mf4"]).assert_refused(3, &["missing.mf4"]);
}
