//! `dynoid diff`: whether a bench is still the same.

use crate::support::Campaign;
use recording::Recording;
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use virtual_bench::simulate;

/// The same two experiments as those of the usual campaign, on this bench and with other noise.
fn other(parameters: &BenchParameters) -> Campaign {
    let run = |plan: &ExperimentPlan, seed| -> Recording { simulate(parameters, plan, seed).expect("a bench") };
    Campaign::empty()
        .with("BS_T_NT_1200.mf4", &run(&ExperimentPlan::bs_t_nt(1200.0, 12.0), 21))
        .with("WhiteNoise_T_TN_1200.mf4", &run(&ExperimentPlan::white_noise_t_tn(1200.0, 12.0), 22))
}

#[test]
fn stat_the_same_bench_is_the_same_and_a_softer_shaft_is_found() {
    let first = Campaign::whole();
    first.run(&["study", "bench.toml", "--quiet"]);
    let compared = |second: &Campaign| {
        second.run(&["study", "bench.toml", "--quiet"]);
        first.write("second.json", second.read("study/model.json").as_bytes());
        first.run(&["diff", "study/model.json", "second.json", "--json"])
    };
    let same = compared(&other(&BenchParameters::default()));
    assert_eq!(same.code, Some(0), "{}{}", same.stdout, same.stderr);
    assert_eq!(same.json()["changed"], false);
    let mut softer = BenchParameters::default();
    softer.mechanics.shaft_stiffness_nm_per_rad *= 0.9;
    let changed = compared(&other(&softer));
    assert_eq!(changed.code, Some(1), "{}", changed.stdout);
    let parts = changed.json()["comparison"]["parts"].as_array().unwrap().clone();
    assert_eq!(parts[0]["part"], "shaft");
    assert!(parts[0]["test"]["adjusted_p_value"].as_f64() < Some(0.01), "{parts:?}");
    let page = first.run(&["diff", "study/model.json", "second.json", "--plot", "diff.html"]);
    assert!(page.stdout.contains("The bench has changed"), "{}", page.stdout);
    assert!(first.read("diff.html").contains("inertias and shaft"));
    let model: serde_json::Value = serde_json::from_str(&first.read("study/model.json")).unwrap();
    let stiffness = model["parameters"].as_array().unwrap().iter().find(|one| one["parameter"] == "stiffness").unwrap();
    assert!(stiffness["interval_95"][0].as_f64() < stiffness["value"].as_f64(), "{stiffness}");
    let itself = first.run(&["diff", "study/model.json", "study/model.json"]);
    assert!(itself.stdout.contains("both models come from recordings/BS_T_NT_1200.mf4"), "{}", itself.stdout);
}

#[test]
fn regress_what_is_no_bench_model_is_refused() {
    let campaign = Campaign::empty();
    campaign.write("model.json", b"{\"format\": \"dynoid model\", \"version\": 1}");
    campaign
        .run(&["diff", "model.json", "model.json"])
        .assert_refused(3, &["model.json", "a linear model of `dynoid fit`"]);
    campaign.write("study.json", b"{\"format\": \"dynoid-study\"}");
    campaign
        .run(&["diff", "study.json", "model.json"])
        .assert_refused(3, &["model.json", "a linear model of `dynoid fit`"]);
    std::fs::remove_file(campaign.path("model.json")).unwrap();
    campaign.run(&["diff", "study.json", "model.json"]).assert_refused(3, &["study.json", "model.json beside it"]);
}

#[test]
fn exact_a_study_says_what_has_changed_since_the_earlier_one_in_its_folder() {
    let campaign = Campaign::whole();
    let first = campaign.run(&["study", "bench.toml"]);
    assert!(!first.stdout.contains("Since the study of"), "{}", first.stdout);
    let words = |ran: &crate::support::Ran| ran.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    let again = words(&campaign.run(&["study", "bench.toml"]));
    assert!(
        again.contains("every number that both have is the same. Recordings, bench file and dynoid are the same."),
        "{again}"
    );
    campaign.write("bench.toml", crate::support::BENCH.replace("0.28 kg m²", "0.283 kg m²").as_bytes());
    let other_file = words(&campaign.run(&["study", "bench.toml"]));
    assert!(other_file.contains("no part has changed beyond chance. The largest difference: J_e +"), "{other_file}");
    assert!(other_file.contains("The sources differ: another bench file."), "{other_file}");
    let mut softer = BenchParameters::default();
    softer.mechanics.shaft_stiffness_nm_per_rad *= 0.9;
    let new = other(&softer);
    for name in ["BS_T_NT_1200.mf4", "WhiteNoise_T_TN_1200.mf4"] {
        let name = format!("recordings/{name}");
        std::fs::copy(new.path(&name), campaign.path(&name)).unwrap();
    }
    let json = campaign.run(&["study", "bench.toml", "--json"]).study();
    assert_eq!(json["earlier"]["changed"], true, "{}", json["earlier"]);
    assert_eq!(json["earlier"]["comparison"]["sources"]["bench_file"], false);
    campaign.write("study/model.json", b"{\"format\": \"dynoid bench model\", \"version\": 99}");
    let later = campaign.run(&["study", "bench.toml"]);
    assert!(later.stderr.contains("this study is not compared with it"), "{}", later.stderr);
}
