//! The firing pulses that recordings show, against those of the virtual benches.

use bench_testkit::benches::{bench_file, default_bench, in_parallel};
use bench_testkit::recordings::BENCH_A;
use part_engine::engine_pulses;
use part_shaft::Parts;
use rig::bench_parameters::{BenchParameters, CycleHarmonic, MechanicsParameters};
use rig::dyno_friction::EstimatedFriction;
use rig::engine_pulses::EnginePulses;
use rig::experiment::{ExperimentPlan, Waveform};
use rig::{BenchFile, Experiment, prepare};
use virtual_bench::{Numerics, simulate_hidden};

fn recorded(parameters: &BenchParameters, plans: &[ExperimentPlan], bench: &BenchFile) -> Vec<Experiment> {
    let one = |i: usize| {
        let run = simulate_hidden(parameters, &plans[i], 3 + i as u64, Numerics::default()).unwrap();
        let file = format!("{}_{i}.mf4", plans[i].label);
        prepare(&file, &run.recording, bench, plans[i].label.clone()).unwrap().0
    };
    in_parallel(plans.len(), one)
}

fn estimated(experiments: &[Experiment], bench: &BenchFile) -> EnginePulses {
    with_run_outs(experiments, bench, None)
}

fn with_run_outs(experiments: &[Experiment], bench: &BenchFile, friction: Option<&EstimatedFriction>) -> EnginePulses {
    engine_pulses(&Parts::of(&experiments.iter().collect::<Vec<_>>(), bench), friction, &|_| true).unwrap()
}

/// The bench with the friction that is assumed of it: the middle of what dynamometers with a limit of 400 Nm can have.
fn with_middle_friction(bench: BenchParameters) -> BenchParameters {
    let mechanics =
        MechanicsParameters { coulomb_friction_nm: 0.8, viscous_friction_nm_s_per_rad: 0.01, ..bench.mechanics };
    BenchParameters { mechanics, ..bench }
}

/// Amplitude at a harmonic of the cycle, estimated with its standard error and true, Nm.
fn compared(found: &EnginePulses, truth: &BenchParameters, m: usize, at: (f64, f64)) -> [f64; 3] {
    let harmonic = &found.harmonics[m - 1];
    // What the recordings show is the mean torque; that of the cylinders is the level times their mean.
    let factors = &truth.engine.cylinder_factors;
    let level = match truth.engine.cycle_harmonics.is_empty() {
        true => at.0 * factors.len() as f64 / factors.iter().sum::<f64>(),
        false => at.0,
    };
    [
        harmonic.value.at(at.0, at.1).norm(),
        harmonic.standard_error_nm(at.0, at.1),
        truth.engine.waves(level, at.1)[m - 1].norm(),
    ]
}

#[test]
fn stat_pulses_of_unequal_cylinders_are_found_with_their_uncertainty() {
    let mut bench = with_middle_friction(BenchParameters::default());
    bench.engine.cylinder_factors = vec![1.08, 0.93, 1.03, 0.96];
    let plans = [ExperimentPlan::bs_t_nt(1300.0, 20.0), ExperimentPlan::ramp_n_nt(1300.0, 20.0)];
    let file = default_bench();
    let found = estimated(&recorded(&bench, &plans, &file), &file);
    assert_eq!(found.recordings.len(), 2);
    let (variation, truth) = (found.cycle_variation, bench.engine.cycle_variation);
    assert!((variation / truth - 1.0).abs() < 0.3, "{variation}, true {truth}");
    for m in [1, 2, 3, 4, 5, 6, 7, 8, 12] {
        let [amplitude, error, truth] = compared(&found, &bench, m, (60.0, 136.0));
        println!("{m}: {amplitude:.3} ± {error:.3} Nm, true {truth:.3}");
        assert!((amplitude - truth).abs() < 3.0 * error, "{m}: {amplitude} ± {error}, {truth}");
        // J_e is known to 2 %.
        assert!(!m.is_multiple_of(4) || (amplitude / truth - 1.0).abs() < 0.03, "{m}: {amplitude}, {truth}");
    }
    assert!(found.harmonics[3].is_estimated && found.harmonics[3].standard_error_nm(60.0, 136.0) < 6.0);
}

/// Compression without load, gas torque with it, and reciprocating masses, by the torques and speeds of the recordings.
#[test]
fn stat_the_parts_of_a_harmonic_are_separated_by_torque_and_speed() {
    let mut bench = with_middle_friction(BenchParameters::default());
    bench.engine.cycle_variation = 0.0;
    bench.engine.cycle_harmonics = vec![CycleHarmonic::default(); 8];
    bench.engine.cycle_harmonics[3] =
        CycleHarmonic { unloaded_nm: [-30.0, 20.0], of_torque: [0.8, 0.6], of_speed_nm_s2: [1.5e-3, 0.0] };
    let at_torque =
        |plan: ExperimentPlan, value: f64| ExperimentPlan { engine_torque_nm: Waveform::Constant { value }, ..plan };
    let plans = [
        ExperimentPlan::bs_t_nt(1300.0, 15.0),
        at_torque(ExperimentPlan::ramp_n_nt(2000.0, 15.0), 40.0),
        at_torque(ExperimentPlan::levels_n_nt(1300.0, 15.0), 90.0),
        at_torque(ExperimentPlan::levels_n_nt(3000.0, 15.0), 60.0),
    ];
    let file = default_bench();
    let found = estimated(&recorded(&bench, &plans, &file), &file);
    println!("{:?}\n{:?}", found.recordings, found.harmonics[3]);
    for at in [(40.0, 130.0), (80.0, 130.0), (60.0, 200.0), (60.0, 310.0)] {
        let [amplitude, error, truth] = compared(&found, &bench, 4, at);
        println!("{at:?}: {amplitude:.2} ± {error:.2} Nm, true {truth:.2}");
        assert!(
            (amplitude - truth).abs() < 2.5 * error && error < 0.05 * truth,
            "{at:?}: {amplitude} ± {error}, {truth}"
        );
    }
}

/// The mean torque of the engine overcomes the friction of the dynamometer, once: with 14 Nm of it the pulses are those
/// of the truth, whether run-outs show it or the bench file states it.
#[test]
fn stat_large_friction_counts_once_in_the_mean_torque_of_the_pulses() {
    let mut bench = BenchParameters::default();
    (bench.mechanics.coulomb_friction_nm, bench.mechanics.viscous_friction_nm_s_per_rad) = (8.0, 0.045);
    let plans = [ExperimentPlan::bs_t_nt(1300.0, 20.0), ExperimentPlan::ramp_n_nt(1300.0, 20.0)];
    let mut file = default_bench();
    file.dynamometer_friction_uncertainty_percent = Some(2.0);
    let experiments = recorded(&bench, &plans, &file);
    let run_outs = EstimatedFriction {
        coulomb_nm: 8.0,
        viscous_nm_s_per_rad: 0.045,
        covariance: [[0.01, 0.0], [0.0, 1e-7]],
        speeds_rad_s: (5.0, 300.0),
        recordings: vec!["NoShaft_N_NT.mf4".to_owned()],
    };
    let stated = BenchFile {
        dynamometer_coulomb_friction_nm: Some(8.0),
        dynamometer_friction_nm_s_per_rad: Some(0.045),
        ..file.clone()
    };
    let ratio = |found: &EnginePulses| {
        let [amplitude, _, truth] = compared(found, &bench, 4, (60.0, 136.0));
        amplitude / truth
    };
    let shown = ratio(&with_run_outs(&experiments, &file, Some(&run_outs)));
    let of_file = ratio(&estimated(&experiments, &stated));
    let assumed = ratio(&estimated(&experiments, &file));
    println!("run-outs {shown:.3}, stated {of_file:.3}, assumed {assumed:.3} of the truth");
    assert!((shown - 1.0).abs() < 0.04, "{shown}");
    assert!((of_file - 1.0).abs() < 0.04, "{of_file}");
    // The class has at most a third of it, so that too small a torque seems to make the pulses.
    assert!(assumed > shown + 0.05, "{assumed} {shown}");
}

#[test]
fn regress_without_a_shaft_nothing_is_shown() {
    let bench = bench_file("0.6", "0.28", "400 Nm", BENCH_A);
    let experiments = recorded(&BenchParameters::default(), &[ExperimentPlan::no_shaft_n_nt(1200.0, 4.0)], &bench);
    assert!(engine_pulses(&Parts::of(&experiments.iter().collect::<Vec<_>>(), &bench), None, &|_| true).is_err());
}

#[test]
fn regress_where_nothing_fires_there_are_no_pulses() {
    let bench = BenchFile { cylinders: 0, ..bench_file("0.6", "0.28", "400 Nm", BENCH_A) };
    let experiments = recorded(&BenchParameters::default(), &[ExperimentPlan::bs_t_nt(1200.0, 12.0)], &bench);
    let parts = Parts::of(&experiments.iter().collect::<Vec<_>>(), &bench);
    assert!(engine_pulses(&parts, None, &|_| true).is_err());
}

/// A disc that runs out gives order 1 a torque in which the mean torque has no part. Recordings begin at any angle of
/// it, so that two with different mean torques show different ones.
#[test]
fn stat_once_a_turn_errors_of_encoders_do_not_grow_with_the_torque() {
    let file = bench_file("1.03", "0.2256", "600 Nm", BENCH_A);
    let mut bench = BenchParameters::default();
    (bench.mechanics.dyno_inertia_kg_m2, bench.mechanics.engine_inertia_kg_m2) = (1.03, 0.2256);
    (bench.mechanics.shaft_stiffness_nm_per_rad, bench.mechanics.shaft_damping_nm_s_per_rad) = (4850.0, 7.5);
    let constant = |value| ExperimentPlan {
        engine_torque_nm: Waveform::Constant { value },
        ..ExperimentPlan::levels_n_nt(1700.0, 10.0)
    };
    let mut experiments = Vec::new();
    for (sign, plan) in [(1.0, ExperimentPlan::bs_t_nt(1700.0, 10.0)), (-1.0, constant(45.0)), (1.0, constant(65.0))] {
        (bench.sensors.dyno_eccentricity, bench.sensors.engine_eccentricity) = (sign * 3e-4, sign * -4.5e-4);
        experiments.extend(recorded(&bench, &[plan], &file));
    }
    let found = estimated(&experiments, &file);
    let at = (200.0, 178.0);
    let [amplitude, error, truth] = compared(&found, &bench, 2, at);
    println!("{amplitude:.3} ± {error:.3} Nm, true {truth:.3}, {:?}", found.harmonics[1]);
    assert!((amplitude - truth).abs() < 2.5 * error && error < 6.0, "{amplitude} ± {error}, {truth}");
}

/// Firings come at the crank's own angle. Against its mean angle, strong pulses of a light engine swing it, which would
/// move torque from each harmonic to others.
#[test]
fn stat_harmonics_are_those_of_the_angle_that_the_pulses_swing() {
    let mut bench = with_middle_friction(BenchParameters::default());
    bench.engine.cycle_variation = 0.0;
    bench.engine.firing_harmonics.iter_mut().for_each(|harmonic| harmonic.relative_amplitude *= 1.5);
    let plans = [ExperimentPlan::bs_t_nt(900.0, 15.0), ExperimentPlan::ramp_n_nt(1000.0, 15.0)];
    let file = default_bench();
    let found = estimated(&recorded(&bench, &plans, &file), &file);
    for m in [4, 8, 12] {
        let [amplitude, error, truth] = compared(&found, &bench, m, (60.0, 100.0));
        println!("{m}: {amplitude:.3} ± {error:.3} Nm, true {truth:.3}");
        assert!((amplitude / truth - 1.0).abs() < 0.02, "{m}: {amplitude} ± {error}, {truth}");
    }
}

/// Ignition angles leave the charge, which pulses follow, too: torques that they set show no slope over the torque.
#[test]
fn stat_torques_that_ignition_angles_set_leave_other_torques_uncertain() {
    let bench = with_middle_friction(BenchParameters::default());
    let constant = |value| ExperimentPlan {
        engine_torque_nm: Waveform::Constant { value },
        ..ExperimentPlan::ramp_n_nt(1300.0, 15.0)
    };
    let file = default_bench();
    let error = |plans: &[ExperimentPlan]| {
        let found = estimated(&recorded(&bench, plans, &file), &file);
        let [amplitude, error, truth] = compared(&found, &bench, 4, (150.0, 136.0));
        println!("{amplitude:.1} ± {error:.1} Nm, true {truth:.1}");
        assert!((amplitude - truth).abs() < 2.5 * error, "{amplitude} ± {error}, {truth}");
        error / truth
    };
    let by_ignition = error(&[ExperimentPlan::bs_t_nt(1300.0, 15.0), constant(60.0)]);
    let of_one_torque = error(&[constant(60.0), constant(60.0)]);
    let by_charge = error(&[ExperimentPlan::bs_t_nt(1300.0, 15.0), constant(60.0), constant(110.0)]);
    assert!(by_ignition > 0.03 && by_charge < 0.02, "{by_ignition}, {by_charge}");
    // Firings that differ from cycle to cycle make the torque of a window vary, and show no slope either.
    assert!(of_one_torque > 0.03, "{of_one_torque}");
}
