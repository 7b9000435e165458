//! Experiments that recordings show by themselves.

use std::collections::BTreeMap;

use demo::campaign::bench_file;
use rig::bench_file::RunChannels;
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use rig::prepare::recognised;
use rig::{ExperimentLabel, Role, prepare_run};
use virtual_bench::simulate;

/// The experiment that a recording of a plan shows. Its channels are known, its label is not.
fn seen(plan: &ExperimentPlan, without: &[Role]) -> Option<ExperimentLabel> {
    let parameters = BenchParameters::default();
    let recording = simulate(&parameters, plan, 7).unwrap();
    let mut channels: BTreeMap<_, _> = bench_file(&parameters, "").channels;
    channels.retain(|role, _| !without.contains(role));
    let run = RunChannels { channels, speed_limit_rad_s: None };
    let roles: Vec<[Role; 1]> = run.channels.keys().map(|role| [*role]).collect();
    let compared: Vec<&[Role]> = roles.iter().map(|role| &role[..]).collect();
    let (experiment, _) = prepare_run("run.mf4", &recording, &run, &compared, ExperimentLabel::BS_T_NT).unwrap();
    recognised(&experiment).0
}

#[test]
fn exact_experiments_are_recognised_by_their_data() {
    let plans: [fn(f64, f64) -> ExperimentPlan; 7] = [
        ExperimentPlan::bs_t_nt,
        ExperimentPlan::white_noise_t_tn,
        ExperimentPlan::step_t_tn,
        ExperimentPlan::sine_t_tn,
        ExperimentPlan::levels_n_nt,
        ExperimentPlan::ramp_n_nt,
        ExperimentPlan::unfired_n_nt,
    ];
    for plan in plans.map(|plan| plan(1500.0, 20.0)) {
        assert_eq!(seen(&plan, &[]), Some(plan.label.clone()));
    }
}

#[test]
fn exact_where_signals_are_missing_no_experiment_is_claimed() {
    let without = [Role::DynoSpeedDemand, Role::DynoTorqueDemand];
    assert_eq!(seen(&ExperimentPlan::bs_t_nt(1500.0, 10.0), &without), None);
    // A recording without the engine may be one with the shaft off.
    assert_eq!(seen(&ExperimentPlan::no_shaft_n_nt(1500.0, 10.0), &[]), None);
}
