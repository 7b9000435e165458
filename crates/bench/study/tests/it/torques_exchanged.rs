//! Channels of T_d* and T_d,calc that are exchanged in the bench file.

use bench_testkit::benches::bench_file;
use bench_testkit::recordings::{BENCH_A, recordings as drawn};
use recording::Recording;
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use rig::results::Outcome;
use rig::{Diagnostic, Finding, Severity};
use study::{Study, experiment_of};
use virtual_bench::simulate;

use crate::study::{source, studied};

/// Places of both channels in the names of a bench.
const TORQUE_DEMAND: usize = 3;
const TORQUE_CALCULATED: usize = 4;

fn mixed_up() -> [&'static str; 7] {
    let mut names = BENCH_A;
    names.swap(TORQUE_DEMAND, TORQUE_CALCULATED);
    names
}

fn recordings() -> Vec<(&'static str, Recording)> {
    let parameters = BenchParameters::default();
    let plans = [
        ("BS_T_NT_1200.mf4", ExperimentPlan::bs_t_nt(1200.0, 12.0)),
        ("WhiteNoise_T_TN_1200.mf4", ExperimentPlan::white_noise_t_tn(1200.0, 12.0)),
    ];
    plans.into_iter().map(|(file, plan)| (file, simulate(&parameters, &plan, 5).unwrap())).collect()
}

fn study_of(names: [&str; 7], recordings: &[(&'static str, Recording)]) -> Study {
    let bench = bench_file("0.6", "0.28", "400 Nm", names);
    studied(&bench, recordings.iter().map(|(file, recording)| source(file, Ok(recording.clone()))).collect())
}

fn exchanged(study: &Study) -> Vec<&Diagnostic> {
    study.diagnostics.iter().filter(|found| matches!(found.finding, Finding::TorquesExchanged { .. })).collect()
}

#[test]
fn exact_exchanged_torques_are_an_error_that_names_both_and_strikes_the_parts() {
    let recordings = recordings();
    assert_eq!(exchanged(&study_of(BENCH_A, &recordings)), Vec::<&Diagnostic>::new());
    let study = study_of(mixed_up(), &recordings);
    let found = exchanged(&study);
    let [
        Diagnostic {
            severity: Severity::Error, finding: Finding::TorquesExchanged { demand, torque, later_s }, ..
        },
    ] = found.as_slice()
    else {
        panic!("{:?}", study.diagnostics);
    };
    assert_eq!((demand.as_str(), torque.as_str()), ("DynoTorqueCalc", "DynoTorqueDemand"));
    assert!((1e-3..6e-3).contains(later_s), "{later_s}");
    assert!(matches!(study.speed_controller, Outcome::NotEstimated { .. }));
    assert!(matches!(study.torque_control, Outcome::NotEstimated { .. }));
    assert!(matches!(study.shaft, Outcome::NotEstimated { .. }) && study.model.is_none());
}

fn check_drawn(benches: impl IntoIterator<Item = u32>) {
    let is_noted = |names: [&str; 7], file: &str, recording: &Recording| {
        let bench = bench_file("0.6", "0.28", "600 Nm", names);
        let found = experiment_of(&bench, &source(file, Ok(recording.clone())));
        let diagnostics = found.map_or_else(|refused| refused, |(_, doubts)| doubts);
        diagnostics.iter().any(|found| matches!(found.finding, Finding::TorquesExchanged { .. }))
    };
    for bench in benches {
        for (file, recording) in drawn(&format!("drawn/bench-{bench}")) {
            assert!(!is_noted(BENCH_A, &file, &recording), "{bench}: {file}");
            assert_eq!(is_noted(mixed_up(), &file, &recording), file.contains("_TN"), "{bench}: {file}");
        }
    }
}

/// One bench of each set of rasters: T_d,calc at 250, 500 and 100 Hz.
#[test]
fn ref_exchanged_torques_are_found_and_right_ones_are_not() {
    check_drawn([203, 205, 207]);
}

#[test]
#[ignore = "slow"]
fn ref_exchanged_torques_of_all_drawn_benches_are_found_and_right_ones_are_not() {
    check_drawn(200..216);
}
