//! `dynoid torque-control`: what the torque control of simulated recordings is.

use crate::support::Campaign;

const FEW: [&str; 4] = ["--highest-order", "2", "--longest-delay", "1"];

fn run(campaign: &Campaign, more: &[&str]) -> crate::support::Ran {
    campaign.run(&[&["torque-control", "bench.toml"], &FEW[..], more].concat())
}

#[test]
fn stat_models_are_held_against_the_bar_on_both_excitations() {
    let campaign = Campaign::whole();
    let ran = run(&campaign, &["--plot", "model.html"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let text = ran.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in [
        "T_d* moved by the dynamometer",
        "T_d* moved by the engine",
        "ripple at 100 Hz was taken out",
        "(the bar)",
        "least delay and lag",
        "has a delay of",
        "T_d* − T_d contains T_d itself",
        "What 60 s of other rates and demands would show",
        "A critically damped loop (κ = 0.25) is distinguished from a lag from 250 Hz",
    ] {
        assert!(text.to_lowercase().contains(&words.to_lowercase()), "{words}: {text}");
    }
    let page = campaign.read("model.html");
    for words in [
        "poles and zeros",
        "Crosses are poles, rings zeros",
        "fit against order",
        "What other rates and demands would show",
    ] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn exact_json_holds_every_judgement() {
    let campaign = Campaign::whole();
    let found = run(&campaign, &["--json"]).json();
    assert_eq!(found["recordings"].as_array().unwrap().len(), 2);
    // 2·2 orders and two delays, of two families from two inputs.
    assert_eq!(found["recordings"][0]["scanned"].as_array().unwrap().len(), 32);
    let judged = found["judgements"].as_array().unwrap();
    let lag = judged.iter().find(|j| j["model"]["kind"] == "delay_and_lag").unwrap();
    assert_eq!((&lag["estimated_on"], &lag["verdict"]), (&"dynamometer".into(), &"better".into()));
    assert_eq!(found["visibility"]["cases"].as_array().unwrap().len(), 20);
    let quiet = run(&campaign, &["--quiet"]);
    assert_eq!((quiet.code, quiet.stdout.as_str()), (Some(0), ""));
}

#[test]
fn regress_what_cannot_be_done_is_refused() {
    let campaign = Campaign::whole();
    campaign.run(&["torque-control", "bench.toml", "--highest-order", "0"]).assert_refused(2, &["--highest-order"]);
    campaign.run(&["torque-control", "bench.toml", "--plot", "x.bmp"]).assert_refused(2, &["x.bmp"]);
    for name in ["WhiteNoise_T_TN_1200.mf4", "BS_T_NT_1200.mf4"] {
        std::fs::remove_file(campaign.path(&format!("recordings/{name}"))).unwrap();
    }
    let steady = virtual_bench::simulate(
        &rig::bench_parameters::BenchParameters::default(),
        &rig::experiment::ExperimentPlan::ramp_n_nt(1200.0, 6.0),
        1,
    );
    let campaign = campaign.with("Ramp_N_NT_1200.mf4", &steady.unwrap());
    run(&campaign, &[]).assert_refused(3, &["no recording moves T_d*", "WhiteNoise_T_TN"]);
}
