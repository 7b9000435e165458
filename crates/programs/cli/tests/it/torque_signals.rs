//! `dynoid torque-signals`: the torque signals of simulated recordings.

use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use virtual_bench::simulate;

use crate::support::Campaign;

#[test]
fn stat_delays_filter_shaft_torque_load_cell_and_trust_are_said() {
    let steps = simulate(&BenchParameters::default(), &ExperimentPlan::step_t_tn(1200.0, 24.0), 5).unwrap();
    let campaign = Campaign::whole().with("Step_T_TN_1200.mf4", &steps);
    let ran = campaign.run(&["torque-signals", "bench.toml", "--plot", "torque.html"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let text = ran.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in [
        "T_d,meas",
        "moving average over 16 samples of N_d",
        "7.5 ms late",
        "identify with T_d,calc",
        "T_shaft rebuilt",
        "ω_n",
        "steady T_d,calc can be trusted",
    ] {
        assert!(text.to_lowercase().contains(&words.to_lowercase()), "{words}: {text}");
    }
    let page = campaign.read("torque.html");
    assert!(page.contains("shaft torque rebuilt") && page.contains("95 % band"));
}

#[test]
fn exact_the_rebuilt_torque_is_written_as_a_recording() {
    let campaign = Campaign::whole();
    let recording = "recordings/WhiteNoise_T_TN_1200.mf4";
    let ran = campaign.run(&["torque-signals", "bench.toml", recording, "--out", "shaft.csv", "--json"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let found = ran.json();
    assert_eq!(found["recordings"][0]["filter"]["found"]["best"]["filter"]["length"], 16);
    let samples = found["recordings"][0]["shaft"]["found"]["samples"].as_u64().unwrap();
    let text = campaign.read("shaft.csv");
    assert_eq!(text.lines().count() as u64, samples + 1);
    let heading = text.lines().next().unwrap();
    assert!(
        heading.contains("shaft_torque [Nm]") && heading.contains("shaft_torque_standard_deviation [Nm]"),
        "{heading}"
    );
    let quiet = campaign.run(&["torque-signals", "bench.toml", recording, "--quiet"]);
    assert_eq!((quiet.code, quiet.stdout.as_str()), (Some(0), ""));
}

#[test]
fn regress_what_cannot_be_done_is_refused_before_any_work() {
    let campaign = Campaign::whole();
    campaign.run(&["torque-signals", "bench.toml", "--out", "x.doc"]).assert_refused(2, &["x.doc", ".mf4"]);
    let recording = "recordings/BS_T_NT_1200.mf4";
    campaign.run(&["torque-signals", "bench.toml", recording, "--out", recording]).assert_refused(2, &["is read"]);
    campaign.write("recordings/WhiteNoise_T_TN_1200.mf4", b"no recording");
    let ran = campaign.run(&["torque-signals", "bench.toml", "recordings/WhiteNoise_T_TN_1200.mf4"]);
    ran.assert_refused(3, &["WhiteNoise_T_TN_1200.mf4", "none of the recordings"]);
}

/// Recordings that were read, and of which nothing can be said: too short, or with channels that never change.
#[test]
fn regress_recordings_that_tell_nothing_end_with_a_code_that_says_so() {
    let short = simulate(&BenchParameters::default(), &ExperimentPlan::white_noise_t_tn(1200.0, 0.05), 1).unwrap();
    let mut still = simulate(&BenchParameters::default(), &ExperimentPlan::bs_t_nt(1200.0, 6.0), 1).unwrap();
    for channel in &mut still.channels {
        let first = channel.samples[0];
        channel.samples.fill(first);
    }
    let campaign = Campaign::whole().with("WhiteNoise_T_TN_1200.mf4", &short).with("BS_T_NT_1200.mf4", &still);
    for command in ["torque-signals", "engine", "lines", "controller"] {
        for recording in ["recordings/WhiteNoise_T_TN_1200.mf4", "recordings/BS_T_NT_1200.mf4"] {
            let ran = campaign.run(&[command, "bench.toml", recording]);
            assert_eq!(ran.code, Some(3), "{command} {recording}: {}{}", ran.stdout, ran.stderr);
            assert!(!ran.stdout.contains("is not recorded; record it"), "{}", ran.stdout);
        }
    }
}
