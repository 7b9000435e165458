//! `dynoid controller`: the speed controller of simulated recordings, and the study of a known one.

use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use virtual_bench::simulate;

use crate::support::{Campaign, dynoid};

fn campaign() -> Campaign {
    let levels = simulate(&BenchParameters::default(), &ExperimentPlan::levels_n_nt(1200.0, 20.0), 6).unwrap();
    Campaign::whole().with("Levels_N_NT_1200.mf4", &levels)
}

#[test]
fn stat_pi_delay_structure_feed_forward_and_limit_are_said() {
    let campaign = campaign();
    let ran = campaign.run(&["controller", "bench.toml", "--plot", "controller.html"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let text = ran.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in [
        "PI alone",
        "outside the 99 % region",
        "inside the 99 % region",
        "b_1",
        "forward Euler",
        "second integrator",
        "No term beyond PI and delay is found at the 1 % level",
        "k_a",
        "No term beyond k and k_a is found",
        "beyond straight",
        "no recording rests at a limit of T_d*",
        "The constant part of the feed-forward, m",
    ] {
        assert!(text.to_lowercase().contains(&words.to_lowercase()), "{words}: {text}");
    }
    assert!(!text.contains("WhiteNoise_T_TN"), "{text}");
    let page = campaign.read("controller.html");
    assert!(page.contains("correlation of residual") && page.contains("static feed-forward over"));
}

#[test]
fn exact_the_result_is_json_without_samples() {
    let campaign = campaign();
    let ran = campaign.run(&["controller", "bench.toml", "--json"]);
    let found = ran.json();
    let controller = &found["controllers"][0]["found"]["found"];
    let k_p = controller["with_delay"]["parameters"][0]["value"].as_f64().unwrap();
    assert!((k_p - 0.9385).abs() < 1e-3, "{k_p}");
    assert!(controller["validation_without_delay"]["share_outside"].as_f64().unwrap() > 0.05);
    assert!(controller["validation"]["measured"].is_null());
    assert_eq!(controller["structure"]["found"]["rounds"][0]["tests"].as_array().unwrap().len(), 4);
    assert_eq!(found["limits"][0]["found"]["found"]["kind"], "not_reached");
    let quiet = campaign.run(&["controller", "bench.toml", "recordings/BS_T_NT_1200.mf4", "--quiet"]);
    assert_eq!((quiet.code, quiet.stdout.as_str()), (Some(0), ""));
}

#[test]
fn exact_the_study_is_repeatable_and_shows_the_published_table() {
    let campaign = campaign();
    let recording = "recordings/BS_T_NT_1200.mf4";
    let study = ["controller", "noise-test", "bench.toml", recording, "--draws", "3", "--plot", "study.svg"];
    let ran = campaign.run(&study);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    for words in [
        "table 7.1",
        "1.8896",
        "low-pass 1 Hz, SNR 13",
        "T_d* from N_d",
        "N_d from T_d*",
        "3 draws",
        "100 % (29 … 100 %)",
    ] {
        assert!(ran.stdout.to_lowercase().contains(&words.to_lowercase()), "{words}: {}", ran.stdout);
    }
    assert!(campaign.read("study.svg").contains("over all draws"));
    assert_eq!(ran.stdout, campaign.run(&study).stdout);
    let other = ["controller", "noise-test", "bench.toml", recording, "--draws", "2", "--k-p", "1.5", "--json"];
    let found = campaign.run(&other).json();
    assert_eq!(found["cases"].as_array().unwrap().len(), 6);
    let mean = found["cases"][0]["summaries"][0]["mean"].as_f64().unwrap();
    assert!((mean - 1.5).abs() < 1e-6, "{mean}");
    let coverage = &found["cases"][2]["summaries"][0]["coverage"];
    assert_eq!(coverage["of"], 2);
    let [lower, upper] = ["lower", "upper"].map(|end| coverage[end].as_f64().unwrap());
    assert!(lower < 0.2 && upper - lower > 0.8, "{coverage}");
}

#[test]
fn regress_what_cannot_be_done_is_refused_with_the_remedy() {
    let campaign = campaign();
    campaign.run(&["controller"]).assert_refused(2, &["BENCH.toml"]);
    campaign
        .run(&["controller", "bench.toml", "recordings/Levels_N_NT_1200.mf4"])
        .assert_refused(3, &["constant N_d*", "BS_T_NT"]);
    let white_noise = ["controller", "noise-test", "bench.toml", "recordings/WhiteNoise_T_TN_1200.mf4"];
    campaign.run(&white_noise).assert_refused(3, &["speed control (NT)"]);
    let folder = std::env::temp_dir();
    dynoid(&folder, &["controller", "noise-test", "--band-pass", "50,20"]).assert_refused(2, &["--band-pass", "lower"]);
    dynoid(&folder, &["controller", "noise-test", "--band-pass", "20"])
        .assert_refused(2, &["--band-pass", "two corners"]);
    dynoid(&folder, &["controller", "noise-test", "--draws", "1"]).assert_refused(2, &["--draws"]);
    dynoid(&folder, &["controller", "noise-test", "--low-pass", "600", "--draws", "2"]).assert_refused(3, &["600"]);
}
