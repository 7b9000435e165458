//! `dynoid friction`: friction and inertia of a simulated dynamometer.

use bench::virtual_bench::{BenchParameters, ExperimentPlan, simulate};

use crate::support::Campaign;

fn campaign() -> Campaign {
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
    for words in ["J_d", "c_0", "Coulomb friction", "δ_T", "used: recordings/NoShaft_N_NT_1200.mf4", "chosen"] {
        assert!(ran.stdout.contains(words), "{words}: {}", ran.stdout);
    }
    assert!(!ran.stdout.contains("BS_T_NT"), "{}", ran.stdout);
    assert!(campaign.read("friction.html").contains("Friction over speed"));
    let found = campaign.run(&["friction", "bench.toml", "--json"]).json();
    let interval = &found["inertia"]["inertia"]["interval"];
    let ends = [interval[0].as_f64().unwrap(), interval[1].as_f64().unwrap()];
    assert!(ends[0] < 0.601 && ends[1] > 0.599 && ends[1] - ends[0] < 0.03, "{ends:?}");
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
