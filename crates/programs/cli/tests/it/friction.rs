//! `dynoid friction`: friction and inertia of a simulated dynamometer.

use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use virtual_bench::simulate;

use crate::support::Campaign;

pub(crate) fn campaign() -> Campaign {
    let mut parameters = BenchParameters::default();
    parameters.mechanics.coulomb_friction_nm = 3.0;
    parameters.mechanics.viscous_friction_nm_s_per_rad = 0.02;
    let recording = simulate(&parameters, &ExperimentPlan::no_shaft_n_nt(1200.0, 12.0), 4).unwrap();
    Campaign::whole().with("NoShaft_N_NT_1200.mf4", &recording)
}

#[test]
fn stat_friction_and_inertia_are_said_of_the_recordings_without_shaft() {
    let campaign = campaign();
    let ran = campaign.run(&["friction", "bench.toml", "--plot", "friction.html"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    for words in ["J_d", "c_0", "Coulomb friction", "δ_T", "recordings/NoShaft_N_NT_1200.mf4", "chosen"] {
        assert!(ran.stdout.contains(words), "{words}: {}", ran.stdout);
    }
    assert!(!ran.stdout.contains("BS_T_NT"), "{}", ran.stdout);
    let page = campaign.read("friction.html");
    assert!(page.contains("Friction over speed") && page.contains("Dots: some of the measured speeds"));
    let found = campaign.run(&["friction", "bench.toml", "--json"]).json();
    let interval = &found["inertia"]["inertia"]["interval"];
    let ends = [interval[0].as_f64().unwrap(), interval[1].as_f64().unwrap()];
    assert!(ends[0] < 0.601 && ends[1] > 0.599 && ends[1] - ends[0] < 0.03, "{ends:?}");
}

/// Without T_d* the interval of J_d is wide, and it is said what would make it narrower.
#[test]
fn regress_what_narrows_the_inertia_is_said_where_t_d_demand_is_missing() {
    let campaign = campaign();
    let remedy = "A recording with T_d*, named in the bench file as dyno_torque_demand, makes it narrower";
    let width = |bench: &str| {
        let interval = campaign.run(&["friction", bench, "--json"]).json()["inertia"]["inertia"]["interval"].clone();
        interval[1].as_f64().unwrap() - interval[0].as_f64().unwrap()
    };
    let text = campaign.read("bench.toml");
    let without: Vec<&str> = text.lines().filter(|line| !line.starts_with("dyno_torque_demand")).collect();
    campaign.write("without.toml", without.join("\n").as_bytes());
    assert!(width("without.toml") > width("bench.toml"));
    // A screen breaks lines where they end.
    let shown = |bench: &str| {
        let screen = campaign.run(&["friction", bench]).stdout;
        screen.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    assert!(shown("without.toml").contains(remedy));
    assert!(!shown("bench.toml").contains(remedy));
}

#[test]
fn regress_recordings_with_shaft_are_refused_with_what_to_run() {
    let campaign = campaign();
    let named = campaign.run(&["friction", "bench.toml", "recordings/BS_T_NT_1200.mf4"]);
    named.assert_refused(3, &["BS_T_NT_1200.mf4", "shaft on", "NoShaft_N_NT"]);
    std::fs::remove_file(campaign.path("recordings/NoShaft_N_NT_1200.mf4")).unwrap();
    campaign.run(&["friction", "bench.toml"]).assert_refused(3, &["no recording without shaft", "NoShaft_N_NT"]);
    campaign.run(&["friction", "bench.toml", "--slowest", "-3"]).assert_refused(2, &["--slowest"]);
}

#[test]
fn regress_a_stated_inertia_is_doubted_either_way_and_within_its_uncertainty_not() {
    let campaign = campaign();
    let bench = campaign.read("bench.toml");
    let line = bench.lines().find(|line| line.starts_with("dynamometer_inertia")).unwrap();
    for (stated, words) in [("1.2 kg m²", "50 % below"), ("0.3 kg m²", "% above")] {
        let other = bench.replace(line, &format!("dynamometer_inertia = \"{stated}\""));
        campaign.write("other.toml", other.as_bytes());
        let ran = campaign.run(&["friction", "other.toml"]);
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
        for word in ["warning: J_d comes out", words, "correct dynamometer_inertia"] {
            assert!(ran.stderr.contains(word), "{word}: {}", ran.stderr);
        }
    }
    let wide = "dynamometer_inertia = \"0.62 kg m²\"\ndynamometer_inertia_uncertainty_percent = 5";
    campaign.write("wide.toml", bench.replace(line, wide).as_bytes());
    let ran = campaign.run(&["friction", "wide.toml"]);
    assert!(!ran.stderr.contains("J_d comes out"), "{}", ran.stderr);
    assert!(ran.stdout.contains("T_d from T_d* through the torque control"), "{}", ran.stdout);
}

#[test]
fn regress_the_load_cell_is_named_where_it_stands_in_for_the_calculated_torque() {
    let campaign = campaign();
    let bench = campaign.read("bench.toml");
    let line = bench.lines().find(|line| line.starts_with("air_gap_torque")).unwrap();
    campaign.write("cell.toml", bench.replace(line, "air_gap_torque = \"NotThere\"").as_bytes());
    let ran = campaign.run(&["friction", "cell.toml"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(ran.stdout.contains("T_d from the load cell"), "{}", ran.stdout);
    assert!(ran.stderr.contains("T_d is taken from the load cell, T_d,meas"), "{}", ran.stderr);
    let nowhere = campaign.run(&["friction", "bench.toml", "--plot", "nodir/x.html"]);
    assert!(nowhere.code == Some(4) && nowhere.stderr.contains("--plot"), "{}", nowhere.stderr);
}
