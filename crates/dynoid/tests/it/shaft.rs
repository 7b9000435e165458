//! `dynoid shaft`: the shaft of simulated recordings.

use crate::support::Campaign;

#[test]
fn stat_each_recording_and_all_together_tell_the_shaft_that_was_simulated() {
    let campaign = Campaign::whole();
    let recordings = ["recordings/BS_T_NT_1200.mf4", "recordings/WhiteNoise_T_TN_1200.mf4"];
    let line = ["shaft", "bench.toml", recordings[0], recordings[1], "--plot", "shaft.html"];
    let ran = campaign.run(&line);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let text = ran.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in ["time stamps taken as exact", "J_e", "loss factor", "All recordings together", "the 2 recordings"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let page = campaign.read("shaft.html");
    assert!(page.contains("from Δω to T_shaft") && page.contains("Recordings side by side"));
    let found = campaign.run(&["shaft", "bench.toml", recordings[0], recordings[1], "--json"]).json();
    for (name, truth) in [("stiffness", 2437.7), ("damping", 5.8)] {
        let parameter = &found["together"][name]["parameter"];
        let (value, error) = (parameter["value"].as_f64().unwrap(), parameter["standard_error"].as_f64().unwrap());
        assert!((value - truth).abs() < (4.0 * error).max(0.002 * truth), "{name}: {value} ± {error}");
    }
    let inertias = &found["recordings"][1]["inertias"]["found"]["parameters"];
    let engine = inertias.as_array().unwrap().iter().find(|p| p["symbol"] == "J_e").unwrap();
    assert!((engine["value"].as_f64().unwrap() - 0.28).abs() < 0.03, "{engine}");
    assert!(found["recordings"][0]["inertias"].is_null());
}

#[test]
fn regress_recordings_that_tell_no_shaft_say_why() {
    let campaign = Campaign::whole();
    let ran = campaign.run(&["shaft", "bench.toml", "recordings/BS_T_NT_1200.mf4", "--quiet"]);
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(0), ""));
    campaign.write("recordings/WhiteNoise_T_TN_1200.mf4", b"no recording");
    let ran = campaign.run(&["shaft", "bench.toml", "recordings/WhiteNoise_T_TN_1200.mf4"]);
    ran.assert_refused(3, &["WhiteNoise_T_TN_1200.mf4", "none of the recordings"]);
    campaign.run(&["shaft", "bench.toml", "missing.mf4"]).assert_refused(3, &["missing.mf4"]);
}
