//! Predictions against a virtual bench without anything that the model does not have.

use bench_model::disturbances::Disturbances;
use bench_model::friction::DynoFriction;
use bench_model::model::{ModelParameter, ModelUncertainty, PartCovariance};
use bench_model::prediction::{PeakOf, PredictionError, PredictionInputs, peak_errors, predict};
use rig::bench_file::Limits;
use rig::bench_parameters::{BenchParameters, CycleHarmonic};
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan, TorqueTarget, Waveform};
use units::RPM_RAD_S;
use virtual_bench::Numerics;

use bench_testkit::runs::{clean, run, smooth};

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn with_inputs<T>(
    parameters: &BenchParameters,
    plan: &ExperimentPlan,
    limits: Limits,
    act: impl FnOnce(&PredictionInputs<'_>) -> T,
) -> T {
    let demands = Demands::of(plan, 7, DEMAND_HOLD_S);
    let model = bench_model::model::BenchModel::of(parameters);
    act(&PredictionInputs {
        plan,
        demands: &demands,
        model: &model,
        engine: &parameters.engine,
        firing_seed: None,
        friction: DynoFriction::default(),
        disturbances: Disturbances::default(),
        limits,
    })
}

/// Largest errors of N_d in rpm and of T_shaft in Nm.
fn errors(plan: &ExperimentPlan) -> (f64, f64) {
    // An engine that fires every millisecond takes its torque up as the linear model does.
    let mut parameters = smooth();
    (parameters.engine.cylinder_factors, parameters.engine.strokes) = (vec![1.0; 50], 2);
    let truth = run(&parameters, plan, Numerics::default()).hidden;
    let prediction = with_inputs(&parameters, plan, Limits::default(), |inputs| predict(inputs).unwrap());
    // What is predicted is what the encoder reads: the mean over the last millisecond.
    let true_speed = &truth.dyno_speed_rad_s;
    let read: Vec<f64> = true_speed.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    let speed = largest_difference(&prediction.response.dyno_speed_rad_s[1..], &read) / RPM_RAD_S;
    (speed, largest_difference(&prediction.response.shaft_torque_nm, &truth.shaft_torque_nm))
}

#[test]
fn exact_predictions_are_what_the_virtual_bench_does() {
    let (speed, shaft) = errors(&ExperimentPlan::ramp_n_nt(1200.0, 8.0));
    assert!(speed < 0.5 && shaft < 0.5, "ramp: {speed} rpm, {shaft} Nm");
    let (speed, shaft) = errors(&ExperimentPlan::white_noise_t_tn(1200.0, 8.0));
    assert!(speed < 1.0 && shaft < 2.0, "noise: {speed} rpm, {shaft} Nm");
    let (speed, shaft) = errors(&ExperimentPlan::step_t_tn(1200.0, 8.0));
    assert!(speed < 1.0 && shaft < 2.0, "step: {speed} rpm, {shaft} Nm");
    let (speed, _) = errors(&ExperimentPlan::no_shaft_n_nt(1200.0, 8.0));
    assert!(speed < 0.5, "no shaft: {speed} rpm");
}

#[test]
fn exact_friction_of_the_dynamometer_is_that_of_the_virtual_bench() {
    let mut parameters = smooth();
    (parameters.engine.cylinder_factors, parameters.engine.strokes) = (vec![1.0; 50], 2);
    parameters.mechanics.coulomb_friction_nm = 1.2;
    parameters.mechanics.viscous_friction_nm_s_per_rad = 0.02;
    let friction = DynoFriction { coulomb_nm: 1.2, viscous_nm_s_per_rad: 0.02, beside: None };
    for plan in [ExperimentPlan::step_t_tn(3000.0, 6.0), ExperimentPlan::ramp_n_nt(1200.0, 6.0)] {
        let truth = run(&parameters, &plan, Numerics::default()).hidden;
        let of = |friction: DynoFriction| {
            with_inputs(&parameters, &plan, Limits::default(), |inputs| {
                predict(&PredictionInputs { friction, ..*inputs }).unwrap().response
            })
        };
        let (with, without) = (of(friction), of(DynoFriction::default()));
        let shaft = largest_difference(&with.shaft_torque_nm, &truth.shaft_torque_nm);
        assert!(shaft < 2.0, "{:?}: {shaft} Nm", plan.label);
        // In torque control the shaft has the friction in addition to T_d.
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let [with, without, truth] =
            [&with.shaft_torque_nm, &without.shaft_torque_nm, &truth.shaft_torque_nm].map(|values| mean(values));
        assert!((with - truth).abs() < 0.2, "{:?}: {with} for {truth} Nm", plan.label);
        let in_torque_control = plan.label.mode == rig::ControlMode::Tn;
        assert_eq!((with - without - friction.torque_nm(3000.0 * RPM_RAD_S)).abs() < 0.3, in_torque_control);
    }
}

#[test]
fn regress_an_engine_does_not_turn_backwards() {
    let parameters = clean();
    for (rpm, is_refused) in [(-1500.0, true), (25_000.0, true), (0.0, false), (1500.0, false)] {
        let plan = ExperimentPlan::levels_n_nt(rpm, 1.0);
        let plan = ExperimentPlan { speed_rad_s: Waveform::Constant { value: rpm * RPM_RAD_S }, ..plan };
        let found = with_inputs(&parameters, &plan, Limits::default(), |inputs| predict(inputs).map(drop));
        assert_eq!(matches!(found, Err(PredictionError::EngineSpeed { .. })), is_refused, "{rpm}: {found:?}");
    }
    let error = PredictionError::EngineSpeed { speed_rad_s: -1500.0 * RPM_RAD_S, time_s: 0.25 }.to_string();
    assert!(error.contains("0.250 s") && error.contains("-1500 rpm") && error.contains("turns forwards"), "{error}");
}

/// Root mean square of the error of T_shaft where both fire alike, and how much too high the predicted peak is, Nm.
fn errors_fired(parameters: &BenchParameters, plan: &ExperimentPlan) -> (f64, f64) {
    let truth = run(parameters, plan, Numerics::default()).hidden.shaft_torque_nm;
    let found = with_inputs(parameters, plan, Limits::default(), |inputs| {
        predict(&PredictionInputs { firing_seed: Some(7), ..*inputs }).unwrap().response.shaft_torque_nm
    });
    let sum: f64 = found.iter().zip(&truth).map(|(found, truth)| (found - truth).powi(2)).sum();
    let peak = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    ((sum / truth.len() as f64).sqrt(), peak(&found) - peak(&truth))
}

/// Order 1 of 1100 rpm and order 2 of 600 rpm are at the resonance: a crank angle without the pulses' own swing gives
/// 10 and 50 Nm.
#[test]
fn exact_firing_pulses_are_those_of_the_virtual_bench() {
    let plans = [
        ExperimentPlan::bs_t_nt(600.0, 4.0),
        ExperimentPlan::bs_t_nt(1100.0, 4.0),
        ExperimentPlan::levels_n_nt(1500.0, 4.0),
        ExperimentPlan::step_t_tn(1200.0, 4.0),
        ExperimentPlan::white_noise_t_tn(1200.0, 4.0),
    ];
    for plan in plans {
        let (rms, peak) = errors_fired(&clean(), &plan);
        assert!(rms < 0.5 && peak.abs() < 0.5, "{:?}: {rms:.3} Nm, peak {peak:+.3} Nm", plan.label);
    }
}

/// Of a half order at the resonance, the phase against the demands decides on the peak: over the seeds it takes every
/// value of the cycle, not those of one firing interval.
#[test]
fn stat_the_cylinder_at_the_start_is_any_of_them() {
    let mut parameters = clean();
    parameters.engine.firing_harmonics.clear();
    parameters.engine.cylinder_factors = vec![1.3, 1.0, 0.7, 1.0];
    parameters.engine.cycle_variation = 0.0;
    let plan =
        ExperimentPlan { engine_torque_nm: Waveform::Constant { value: 60.0 }, ..ExperimentPlan::bs_t_nt(1100.0, 0.5) };
    let half_order = 0.5 * 1100.0 * RPM_RAD_S;
    let phase = |seed: u64| {
        let shaft = with_inputs(&parameters, &plan, Limits::default(), |inputs| {
            predict(&PredictionInputs { firing_seed: Some(seed), ..*inputs }).unwrap().response.shaft_torque_nm
        });
        let part = |(k, torque): (usize, &f64)| {
            let (sine, cosine) = (half_order * 1e-3 * k as f64).sin_cos();
            (torque * cosine, torque * sine)
        };
        let (c, s) = shaft.iter().enumerate().map(part).fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
        s.atan2(c)
    };
    let mut quarters = [0; 4];
    for seed in 0..40 {
        quarters[((phase(seed) / std::f64::consts::TAU).rem_euclid(1.0) * 4.0) as usize] += 1;
    }
    // Ten are expected in each; fewer than three in any has a probability below 1 %.
    assert!(quarters.iter().all(|count| *count >= 3), "{quarters:?}");
}

/// The same engine by harmonics of the firing order and by harmonics of the working cycle.
#[test]
fn exact_harmonics_of_the_cycle_are_those_of_the_firing_order() {
    let mut by_firing = clean();
    by_firing.engine.cylinder_factors.fill(1.0);
    let mut by_cycle = by_firing.clone();
    by_cycle.engine.cycle_harmonics = vec![CycleHarmonic::default(); 16];
    for (harmonic, n) in by_firing.engine.firing_harmonics.iter().zip(1..) {
        let (sine, cosine) = harmonic.phase_rad.sin_cos();
        by_cycle.engine.cycle_harmonics[4 * n - 1].of_torque =
            [cosine, sine].map(|part| part * harmonic.relative_amplitude);
    }
    by_cycle.engine.firing_harmonics.clear();
    by_cycle.engine.cylinder_factors = vec![1.2, 0.9, 1.0, 1.1];
    let plan = ExperimentPlan::bs_t_nt(900.0, 2.0);
    let predicted = |parameters: &BenchParameters| {
        with_inputs(parameters, &plan, Limits::default(), |inputs| {
            predict(&PredictionInputs { firing_seed: Some(7), ..*inputs }).unwrap().response.shaft_torque_nm
        })
    };
    assert!(largest_difference(&predicted(&by_firing), &predicted(&by_cycle)) < 1e-6);
    let simulated = |parameters: &BenchParameters| run(parameters, &plan, Numerics::default()).hidden.shaft_torque_nm;
    assert!(largest_difference(&simulated(&by_firing), &simulated(&by_cycle)) < 1e-6);
}

#[test]
fn exact_pulses_of_a_motored_engine_are_those_of_the_virtual_bench() {
    let mut parameters = clean();
    parameters.engine.motored_torque_nm = -40.0;
    parameters.engine.motored_pulsation = 1.5;
    let plan = ExperimentPlan { is_motored: true, ..ExperimentPlan::levels_n_nt(1100.0, 4.0) };
    let (rms, peak) = errors_fired(&parameters, &plan);
    assert!(rms < 0.5 && peak.abs() < 0.5, "{rms:.3} Nm, peak {peak:+.3} Nm");
    // Without them the prediction is far off.
    parameters.engine.motored_pulsation = 0.0;
    let smooth = with_inputs(&parameters, &plan, Limits::default(), |inputs| predict(inputs).unwrap());
    parameters.engine.motored_pulsation = 1.5;
    let truth = run(&parameters, &plan, Numerics::default()).hidden.shaft_torque_nm;
    assert!(largest_difference(&smooth.response.shaft_torque_nm, &truth) > 10.0);
}

#[test]
fn exact_in_torque_control_the_engine_breathes_and_ignites_as_on_the_virtual_bench() {
    let mut parameters = clean();
    parameters.engine.intake_lag_s = 0.15;
    let retarded = Waveform::Square { first: 0.9, second: 0.7, dwell_s: 0.8 };
    for ignition_efficiency in [Waveform::Constant { value: 1.0 }, retarded] {
        let plan = ExperimentPlan { ignition_efficiency, ..ExperimentPlan::step_t_tn(1500.0, 4.0) };
        let (rms, peak) = errors_fired(&parameters, &plan);
        assert!(rms < 0.5 && peak.abs() < 0.5, "{rms:.3} Nm, peak {peak:+.3} Nm");
    }
    // The lag matters: without it the shaft torque is another one.
    let plan = ExperimentPlan::step_t_tn(1500.0, 4.0);
    let shaft = |parameters: &BenchParameters| {
        with_inputs(parameters, &plan, Limits::default(), |inputs| predict(inputs).unwrap().response.shaft_torque_nm)
    };
    assert!(largest_difference(&shaft(&parameters), &shaft(&clean())) > 2.0);
}

#[test]
fn exact_peaks_stand_against_their_limits() {
    let plan = ExperimentPlan::step_t_tn(1200.0, 8.0);
    let limits = Limits { torque_nm: Some(84.0), shaft_torque_nm: Some(500.0), ..Limits::default() };
    let peaks = with_inputs(&smooth(), &plan, limits, |inputs| predict(inputs).unwrap().peaks);
    let beyond: Vec<PeakOf> = peaks.iter().filter(|peak| peak.is_beyond_limit()).map(|peak| peak.of).collect();
    assert_eq!(beyond, [PeakOf::TorqueDemand]);
    assert_eq!(peaks.len(), 4);
}

#[test]
fn exact_errors_of_peaks_follow_the_model() {
    // The speed's peak at rest hangs on nothing; the shaft's peak after a step on its stiffness.
    let plan = ExperimentPlan {
        engine_torque_nm: Waveform::Square { first: 30.0, second: 90.0, dwell_s: 1.0 },
        ..ExperimentPlan::bs_t_nt(1200.0, 3.0)
    };
    let of_stiffness = |error: f64| {
        let part = PartCovariance {
            parameters: vec![ModelParameter::Stiffness],
            covariance: vec![vec![error * error]],
            degrees_of_freedom: 100.0,
        };
        ModelUncertainty::new(&[part]).unwrap()
    };
    let shaft = |uncertainty: &ModelUncertainty| {
        with_inputs(&smooth(), &plan, Limits::default(), |inputs| peak_errors(inputs, uncertainty))[3]
    };
    assert_eq!(shaft(&ModelUncertainty::default()), 0.0);
    let (one, two) = (shaft(&of_stiffness(20.0)), shaft(&of_stiffness(40.0)));
    assert!(one > 0.0 && (two / one - 2.0).abs() < 1e-6, "{one}, {two}");
}

#[test]
fn regress_what_cannot_be_predicted_is_refused_in_words() {
    let mut plan = ExperimentPlan::step_t_tn(1200.0, 2.0);
    plan.torque_target = TorqueTarget::Shaft;
    let error = with_inputs(&smooth(), &plan, Limits::default(), |inputs| predict(inputs).unwrap_err());
    assert_eq!(error, PredictionError::ShaftTorqueControl);
    let mut unstable = smooth();
    unstable.controller.proportional_nm_s_per_rad *= 200.0;
    unstable.drive.torque_limit_nm = 1e12;
    let plan = ExperimentPlan::ramp_n_nt(1200.0, 6.0);
    let error = with_inputs(&unstable, &plan, Limits::default(), |inputs| predict(inputs).unwrap_err());
    assert_eq!(error, PredictionError::Unstable);
}

#[test]
fn regress_pulses_that_grow_without_bound_are_refused() {
    let mut unstable = smooth();
    unstable.controller.proportional_nm_s_per_rad *= 40.0;
    unstable.drive.torque_limit_nm = 1e12;
    // At rest nothing grows; the pulses have the time of settling for it.
    let mut plan = ExperimentPlan::bs_t_nt(1200.0, 0.1);
    plan.engine_torque_nm = Waveform::Constant { value: 60.0 };
    let (rest, pulsed) = with_inputs(&unstable, &plan, Limits::default(), |inputs| {
        (predict(inputs), predict(&PredictionInputs { firing_seed: Some(1), ..*inputs }))
    });
    assert!(rest.is_ok());
    assert_eq!(pulsed.unwrap_err(), PredictionError::Unstable);
}
