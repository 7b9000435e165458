//! Replays of recordings.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use bench_model::model::BenchModel;
use bench_model::replay::{EncoderError, ReplayError, ReplayInputs, replay};
use bench_model::simulate::{DynoInput, InitialState, Inputs, Response, simulate};
use bench_model::skews::SignalSkews;
use rig::estimation::EstimateError;
use rig::results::{Part, Reason};
use rig::{Experiment, NotReplayed, Role};
use signal::Signal;

use bench_testkit::models::bench_a;

const SKEWS: SignalSkews = SignalSkews { engine_speed_s: 0.0, torque_s: -0.5e-3 };

/// A smooth engine torque with content up to the resonance.
fn engine_torque(count: usize) -> Vec<f64> {
    let tone = |t: f64, f: f64| (TAU * f * t + f).sin();
    (0..count)
        .map(|i| i as f64 * 1e-3)
        .map(|t| 60.0 + 15.0 * tone(t, 0.7) + 8.0 * tone(t, 3.1) + 4.0 * tone(t, 11.3) + 3.0 * tone(t, 19.7))
        .collect()
}

fn recording(label: &str, demands: Vec<(Role, Vec<f64>)>, response: Response) -> Experiment {
    let signal = |samples: Vec<f64>| Signal::new(0.0, 1e-3, samples).unwrap();
    let every = |samples: &[f64], n: usize| samples.iter().step_by(n).copied().collect::<Vec<f64>>();
    let mut signals: BTreeMap<Role, Signal> = demands.into_iter().map(|(role, x)| (role, signal(x))).collect();
    signals.insert(Role::EngineSpeed, Signal::new(0.0, 2e-3, every(&response.engine_speed_rad_s, 2)).unwrap());
    signals.insert(Role::AirGapTorque, Signal::new(0.0, 4e-3, every(&response.air_gap_torque_nm, 4)).unwrap());
    signals.insert(Role::DynoSpeed, signal(response.dyno_speed_rad_s));
    Experiment { file: label.into(), label: label.parse().unwrap(), signals }
}

fn speed_control() -> Experiment {
    let model = bench_a();
    let torque = engine_torque(8000);
    let demand: Vec<f64> = (0..8000).map(|i| 125.0 + 5.0 * (TAU * 0.4 * i as f64 * 1e-3).sin()).collect();
    let start = InitialState::steady(&model, 125.0, 60.0);
    let dyno = DynoInput::SpeedDemand(&demand);
    let inputs = Inputs { sample_time_s: 1e-3, engine_torque_nm: &torque, dyno };
    let response = simulate(&model, &inputs, &start).unwrap();
    let demands = vec![(Role::DynoSpeedDemand, demand), (Role::DynoTorqueDemand, response.torque_demand_nm.clone())];
    recording("Levels_N_NT", demands, response)
}

fn torque_control() -> Experiment {
    let model = bench_a();
    let torque = engine_torque(8000);
    let demand: Vec<f64> = (0..8000).map(|i| 60.0 + 10.0 * (TAU * 2.3 * (i / 10) as f64 * 1e-2).sin()).collect();
    let start = InitialState::steady(&model, 125.0, 60.0);
    let inputs = Inputs { sample_time_s: 1e-3, engine_torque_nm: &torque, dyno: DynoInput::TorqueDemand(&demand) };
    let response = simulate(&model, &inputs, &start).unwrap();
    recording("WhiteNoise_T_TN", vec![(Role::DynoTorqueDemand, demand)], response)
}

#[test]
fn exact_speed_control_replayed_on_its_own_model_fits() {
    let model = bench_a();
    let inputs = ReplayInputs { skews: SKEWS, ..ReplayInputs::default() };
    let found = replay(&speed_control(), &model, &inputs).unwrap();
    let quantities: Vec<&str> = found.signals.iter().map(|v| v.quantity.as_str()).collect();
    assert_eq!(quantities, ["N_d", "N_e", "T_d", "T_shaft", "T_d*"]);
    for signal in &found.signals {
        assert!(signal.fit_percent > 99.0, "{} {}", signal.quantity, signal.fit_percent);
    }
}

#[test]
fn exact_torque_control_replayed_on_its_own_model_fits() {
    let model = bench_a();
    let inputs = ReplayInputs { skews: SKEWS, ..ReplayInputs::default() };
    let found = replay(&torque_control(), &model, &inputs).unwrap();
    for signal in &found.signals {
        assert!(signal.fit_percent > 99.0, "{} {}", signal.quantity, signal.fit_percent);
    }
}

#[test]
fn exact_a_wrong_stiffness_shows_in_the_replay() {
    let mut model = bench_a();
    model.mechanics.stiffness_nm_per_rad *= 0.8;
    let inputs = ReplayInputs { skews: SKEWS, ..ReplayInputs::default() };
    let found = replay(&torque_control(), &model, &inputs).unwrap();
    let shaft = found.signals.iter().find(|v| v.quantity == "T_shaft").unwrap();
    assert!(shaft.fit_percent < 95.0, "{}", shaft.fit_percent);
}

#[test]
fn exact_missing_signals_and_short_stretches_are_errors() {
    let model = bench_a();
    let inputs = ReplayInputs { stretch_s: Some((1.0, 1.5)), ..ReplayInputs::default() };
    assert!(matches!(
        replay(&speed_control(), &model, &inputs),
        Err(ReplayError::Recording(EstimateError::TooShort { .. }))
    ));
    let mut experiment = speed_control();
    experiment.signals.remove(&Role::EngineSpeed);
    let error = replay(&experiment, &model, &ReplayInputs::default()).unwrap_err();
    assert!(matches!(error, ReplayError::Recording(EstimateError::MissingSignal { role: Role::EngineSpeed, .. })));
}

#[test]
fn exact_a_study_learns_what_a_replay_lacks() {
    let reason = |experiment: &Experiment, model: &BenchModel| {
        NotReplayed::from(replay(experiment, model, &ReplayInputs::default()).unwrap_err())
    };
    let without = BenchModel { speed_controller: None, ..bench_a() };
    let part = Part::SpeedController;
    assert_eq!(reason(&speed_control(), &without), NotReplayed::Lacks(Reason::Part { part }));
    let mut experiment = speed_control();
    experiment.signals.remove(&Role::EngineSpeed);
    let (file, role) = (experiment.file.clone(), Role::EngineSpeed);
    assert_eq!(reason(&experiment, &bench_a()), NotReplayed::Lacks(Reason::Channel { file, role }));
    let mut slow = bench_a();
    slow.speed_controller.as_mut().unwrap().sample_time_s = 2e-3;
    assert!(matches!(reason(&speed_control(), &slow), NotReplayed::Clock { controller_s: 2e-3, .. }));
}

#[test]
fn exact_a_known_encoder_error_does_no_harm() {
    let mut experiment = speed_control();
    let speed = experiment.signals.get_mut(&Role::DynoSpeed).unwrap();
    let mut angle = 0.0;
    for n in &mut speed.samples {
        angle += *n * 1e-3;
        *n *= 1.0 + 3e-4 * f64::cos(angle) - 2e-4 * f64::sin(angle);
    }
    let fit = |encoder_error| {
        let inputs = ReplayInputs { skews: SKEWS, encoder_error, ..ReplayInputs::default() };
        let found = replay(&experiment, &bench_a(), &inputs).unwrap();
        found.signals.into_iter().find(|v| v.quantity == "T_shaft").unwrap().fit_percent
    };
    let known = fit(Some(EncoderError { cosine: 3e-4, sine: -2e-4 }));
    assert!(known > 98.5, "{known}");
    assert!(fit(None) < known - 3.0);
}

#[test]
fn exact_once_a_turn_error_of_the_engine_encoder_is_found() {
    let model = bench_a();
    for clean in [speed_control(), torque_control()] {
        let mut experiment = clean;
        let engine = experiment.signals.get_mut(&Role::EngineSpeed).unwrap();
        let mut angle = 1.1;
        for n in &mut engine.samples {
            angle += 2e-3 * *n;
            *n *= 1.0 + 5e-4 * f64::sin(angle);
        }
        let inputs = ReplayInputs { skews: SKEWS, ..ReplayInputs::default() };
        for signal in replay(&experiment, &model, &inputs).unwrap().signals {
            assert!(signal.fit_percent > 97.0, "{} {} {}", experiment.label, signal.quantity, signal.fit_percent);
        }
    }
}
