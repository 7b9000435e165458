//! `dynoid lines`: the lines of simulated recordings, named.

use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use virtual_bench::simulate;

use crate::support::{BENCH, Campaign};

#[test]
fn stat_the_firing_is_named_in_table_json_and_picture() {
    let campaign = Campaign::whole();
    let ran = campaign.run(&["lines", "bench.toml", "--plot", "lines.html"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let summed = ran.stdout.lines().filter(|line| line.contains("order 2, firing")).count();
    assert!(summed == 1 && ran.stdout.contains("--each"), "{}", ran.stdout);
    assert!(ran.stdout.lines().count() < 60, "{}", ran.stdout);
    let each = campaign.run(&["lines", "bench.toml", "--each", "--all"]);
    let firing = each.stdout.lines().find(|line| line.contains("N_e"));
    assert!(firing.is_some_and(|line| line.contains("40.0") && line.contains("order 2, firing")), "{}", each.stdout);
    assert!(campaign.read("lines.html").contains("engine orders"));
    let found = campaign.run(&["lines", "bench.toml", "recordings/BS_T_NT_1200.mf4", "--json"]).json();
    let signals = found["recordings"][0]["parts"][0]["signals"].as_array().unwrap();
    let speed = signals.iter().find(|signal| signal["role"] == "engine_speed").unwrap();
    assert_eq!(speed["lines"][0]["cause"]["cause"], "order");
    assert_eq!(speed["lines"][0]["cause"]["order"], 2.0);
}

#[test]
fn regress_recordings_that_cannot_be_looked_at_are_named() {
    let campaign = Campaign::whole();
    campaign.write("recordings/broken_BS_T_NT.mf4", b"no recording");
    std::fs::copy(campaign.path("recordings/BS_T_NT_1200.mf4"), campaign.path("recordings/tuesday.mf4")).unwrap();
    let ran = campaign.run(&["lines", "bench.toml"]);
    assert_eq!(ran.code, Some(3));
    assert!(ran.stdout.contains("order 2, firing"), "{}", ran.stdout);
    assert!(ran.stderr.contains("broken_BS_T_NT.mf4") && ran.stderr.contains("tuesday.mf4"), "{}", ran.stderr);
    campaign.write("nameless.toml", BENCH.split("[channels]").next().unwrap().as_bytes());
    let ran = campaign.run(&["lines", "nameless.toml", "recordings/BS_T_NT_1200.mf4"]);
    assert_eq!(ran.code, Some(3));
    assert!(ran.stderr.contains("nameless.toml") && ran.stderr.contains("[channels]"), "{}", ran.stderr);
}

#[test]
fn stat_orders_over_the_speed_come_in_table_json_and_map() {
    let recording = simulate(&BenchParameters::default(), &ExperimentPlan::ramp_n_nt(1200.0, 12.0), 4).unwrap();
    let campaign = Campaign::empty().with("Ramp_N_NT_1200.mf4", &recording);
    let ran = campaign.run(&["lines", "bench.toml", "--plot", "map.svg"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(ran.stdout.contains("orders over the speed") && ran.stdout.contains("2, firing"), "{}", ran.stdout);
    let map = campaign.read("map.svg");
    assert!(map.contains("Campbell map") && map.contains("folded orders"), "{} bytes", map.len());
    let found = campaign.run(&["lines", "bench.toml", "--json"]).json();
    let signals = found["over_speed"].as_array().unwrap();
    let speed = signals.iter().find(|signal| signal["role"] == "engine_speed").unwrap();
    let firing = &speed["orders"][0];
    assert_eq!((&firing["order"], &firing["is_firing"]), (&2.0.into(), &true.into()));
    assert!(firing["points"][0]["standard_error"].as_f64().unwrap() > 0.0);
}

#[test]
fn regress_a_recording_that_shows_nothing_says_why() {
    let campaign = Campaign::empty();
    let torque: String =
        (0..2000).map(|k| format!("{:.3},{}\n", 0.001 * f64::from(k), (0.1 * f64::from(k)).sin())).collect();
    campaign.write("recordings/a_BS_T_NT.csv", format!("time [s],DynoTorqueCalc [Nm]\n{torque}").as_bytes());
    let ran = campaign.run(&["lines", "bench.toml", "recordings/a_BS_T_NT.csv"]);
    assert!(ran.stderr.contains("no speed is recorded") && ran.stderr.contains("bench file"), "{}", ran.stderr);
}
