//! `dynoid engine`: the engine's torque of simulated recordings.

use crate::support::Campaign;

#[test]
fn stat_the_engine_torque_is_rebuilt_drawn_and_written() {
    let campaign = Campaign::whole();
    let recording = "recordings/WhiteNoise_T_TN_1200.mf4";
    let ran = campaign.run(&["engine", "bench.toml", recording, "--out", "engine.csv", "--plot", "engine.html"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let text = ran.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in [
        "J_e = ",
        "T_e is known to ±",
        "cycles of",
        "T_e less the cycle’s mean",
        "from one trough of the firing order to the next",
        "once-a-turn error of the engine's encoder",
        "engine.csv",
    ] {
        assert!(text.to_lowercase().contains(&words.to_lowercase()), "{words}: {text}");
    }
    let page = campaign.read("engine.html");
    for words in [
        "engine torque rebuilt",
        "75 of ",
        " cycles, from the middle",
        "over the crank",
        "cylinder by cylinder",
        "orders of the engine torque",
    ] {
        assert!(page.contains(words), "{words}");
    }
    let heading = campaign.read("engine.csv").lines().next().unwrap().to_owned();
    assert!(
        heading.contains("engine_torque [Nm]") && heading.contains("engine_torque_standard_deviation [Nm]"),
        "{heading}"
    );
}

#[test]
fn regress_what_cannot_be_done_is_said() {
    let campaign = Campaign::whole();
    campaign.run(&["engine", "bench.toml", "--out", "x.doc"]).assert_refused(2, &["x.doc", ".mf4"]);
    let recording = "recordings/BS_T_NT_1200.mf4";
    campaign.run(&["engine", "bench.toml", recording, "--out", recording]).assert_refused(2, &["is read"]);
}
