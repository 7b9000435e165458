//! Analyses as documents: what is written is read back.

use bench_testkit::benches::{default_bench, in_parallel};
use bench_testkit::documents::read_back;
use bench_testkit::models::bench_a;
use part_controller::SpeedControllers;
use part_controller::noise_test::{NoiseTestOptions, noise_test};
use part_controller::speed_controller::speed_control;
use part_engine::engine_torque;
use part_friction::FrictionOptions;
use part_shaft::Parts;
use part_shaft::shaft_analysis::shaft_analysis;
use part_torque::TorqueControls;
use part_torque::model_comparison::{OrdersTried, compare_models};
use part_torque::torque_signals::torque_signals;
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use rig::results::{Outcome, Parameter, Part, Quantity, Reason, Trace};
use rig::{BenchFile, Experiment, ExperimentLabel, Role};
use study::{
    Analyses, Candidate, Gain, NextExperiments, Prepared, RecordedCourse, Source, StepResponse, document, lines,
};
use virtual_bench::{Assumption, simulate};
use work::Context;

use crate::comparison::document as model_document;
use crate::study::source;

/// Recordings of the default virtual bench, one of each that an analysis needs.
fn recorded(bench: &BenchFile) -> Prepared {
    let plans = [
        ("BS_T_NT_1200.mf4", ExperimentPlan::bs_t_nt(1200.0, 12.0)),
        ("WhiteNoise_T_TN_1200.mf4", ExperimentPlan::white_noise_t_tn(1200.0, 12.0)),
        ("Levels_N_NT_1200.mf4", ExperimentPlan::levels_n_nt(1200.0, 12.0)),
        ("NoShaft_N_NT.mf4", ExperimentPlan::no_shaft_n_nt(1500.0, 20.0)),
    ];
    let of = |i: usize| source(plans[i].0, Ok(simulate(&BenchParameters::default(), &plans[i].1, 5).unwrap()));
    let sources: Vec<Source> = in_parallel(plans.len(), of);
    Prepared::of(bench, sources, &Context::new())
}

fn next() -> NextExperiments {
    let gain = |quantity, now| Gain { quantity, value: 9.1, now, then: 0.02, is_enough_now: false };
    NextExperiments {
        now: vec![Parameter::new(Quantity::ProportionalGain, 9.0, 0.2, 50.0)],
        candidates: vec![Candidate {
            label: ExperimentLabel::MULTISINE_T_TN,
            is_designed: true,
            speed_rpm: 1200.0,
            duration_s: 60.0,
            peak_shaft_torque_nm: 131.5,
            safety: Some(design::safety::Safety::Safe),
            // Two delays with one symbol, and a gain that people read per rpm.
            gains: vec![
                gain(Quantity::ControllerDelay, Some(0.05)),
                gain(Quantity::TorqueControlDelay, None),
                gain(Quantity::ProportionalGain, Some(0.3)),
            ],
        }],
        enough: 0.01,
        assumptions: vec![Assumption::FeedForward, Assumption::TorqueLimit { torque_nm: 400.0 }],
    }
}

/// Reads a result twice. Estimates are in SI and written in the unit people read, so that a last digit may change once.
fn read_twice<T>(format: &bench_model::document::ResultFormat<T>, result: &T)
where
    T: serde::Serialize + serde::de::DeserializeOwned + PartialEq + std::fmt::Debug,
{
    let read = read_back(format, result);
    assert_eq!(read_back(format, &read), read);
}

#[test]
fn exact_analyses_are_read_as_they_were_written() {
    let bench = default_bench();
    let prepared = recorded(&bench);
    let experiments: Vec<&Experiment> = prepared.experiments().iter().collect();
    let (context, limit) = (Context::new(), bench.limits.torque_nm);
    let parts = Parts::of(&experiments, &bench);
    let (controllers, torque_controls) =
        (SpeedControllers::of(&experiments, limit), TorqueControls::of(&experiments, limit));

    let found_lines = lines(prepared.experiments(), &bench, &context);
    assert_eq!(read_back(&document::LINES, &found_lines), found_lines);
    let torques = torque_signals(&controllers, &torque_controls, &bench, &context);
    read_twice(&document::TORQUE_SIGNALS, &torques);
    let control = speed_control(&controllers, &context);
    assert!(control.controllers[0].found.estimated().is_some());
    read_back(&document::SPEED_CONTROL, &control);
    let orders = OrdersTried { highest: 1, longest_delay: 1 };
    let compared = compare_models(&torque_controls, orders, &context).unwrap();
    read_back(&document::TORQUE_CONTROL, &compared);
    let without_shaft: Vec<&Experiment> =
        experiments.iter().copied().filter(|one| one.label.is_without_shaft()).collect();
    let friction = part_friction::estimate(&without_shaft, FrictionOptions::of(&bench)).unwrap();
    read_twice(&document::FRICTION, &friction);
    let shaft = shaft_analysis(&parts, &context);
    assert!(shaft.recordings.iter().any(|one| one.shaft.estimated().is_some()));
    read_back(&document::SHAFT, &shaft);
    let engine = engine_torque(&parts, &context);
    assert!(engine.masses.estimated().is_some());
    read_twice(&document::ENGINE_TORQUE, &engine);

    let signals = || vec![(Role::DynoSpeed, Trace { start_s: 0.0, sample_time_s: 1e-3, values: vec![1.0; 5] })];
    let label = ExperimentLabel::STEP_T_TN;
    let missing = Reason::Recording { any_of: vec![ExperimentLabel::BS_T_NT] };
    let all = Analyses {
        courses: vec![RecordedCourse { file: "step.mf4".to_owned(), label, signals: signals() }],
        step: Some(StepResponse { file: "step.mf4".to_owned(), at_s: 2.0, signals: signals() }),
        over_speed: Vec::new(),
        lines: found_lines,
        torque_signals: torques,
        speed_control: control,
        pi_study: Some(Outcome::because(missing.clone())),
        torque_control: Outcome::Estimated(compared),
        friction: Outcome::because(Reason::of_analysis("no recording is without shaft")),
        shaft,
        engine_torque: engine,
        next: Outcome::NotEstimated { needs: vec![missing, Reason::Part { part: Part::Shaft }] },
    };
    let read = read_back(&document::ANALYSES, &all);
    // The first reason stands where it always stood; the others are beside it.
    assert_eq!((read.next, read.friction, read.pi_study), (all.next, all.friction, all.pi_study));
}

#[test]
fn exact_further_experiments_are_read_as_they_were_written() {
    let read = read_back(&document::NEXT_EXPERIMENTS, &next());
    let quantities: Vec<Quantity> = read.candidates[0].gains.iter().map(|gain| gain.quantity).collect();
    assert_eq!(quantities, [Quantity::ControllerDelay, Quantity::TorqueControlDelay, Quantity::ProportionalGain]);
    read_twice(&document::NEXT_EXPERIMENTS, &next());
}

#[test]
fn exact_a_comparison_of_models_is_read_as_it_was_written() {
    let mut other = bench_a().with(bench_model::model::ModelParameter::Stiffness, 2377.7);
    other.torque_limit_nm = Some(123.0);
    let found = study::compare_models(&model_document(bench_a(), "a"), &model_document(other, "b"));
    assert!(found.parts.iter().any(|part| part.parameters.iter().any(|one| one.degrees_of_freedom.is_infinite())));
    assert_eq!(read_back(&document::MODEL_COMPARISON, &found), found);
}

#[test]
fn exact_a_noise_test_is_read_as_it_was_written() {
    let bench = default_bench();
    let recording = simulate(&BenchParameters::default(), &ExperimentPlan::bs_t_nt(1200.0, 8.0), 5).unwrap();
    let prepared = Prepared::of(&bench, vec![source("BS_T_NT.mf4", Ok(recording))], &Context::new());
    let options = NoiseTestOptions { draws: 2, ..NoiseTestOptions::default() };
    let found = noise_test(&prepared.experiments()[0], &options, &Context::new()).unwrap();
    read_twice(&document::NOISE_TEST, &found);
}
