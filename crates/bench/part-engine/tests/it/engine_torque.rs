//! The engine's torque of virtual benches, against what it was.

use part_engine::{Cycle, EngineRecording, EngineTorque, InertiaSource, engine_torque};
use part_shaft::Parts;
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use rig::results::Reason;
use rig::{BenchFile, Experiment, prepare};
use virtual_bench::{HiddenTruth, Numerics, simulate_hidden};

use bench_testkit::benches::{bench_file, default_bench, in_parallel};
use bench_testkit::recordings::BENCH_A;

fn recorded(parameters: &BenchParameters, plan: &ExperimentPlan, seed: u64) -> (Experiment, HiddenTruth) {
    let run = simulate_hidden(parameters, plan, seed, Numerics::default()).unwrap();
    let file = format!("{}.mf4", plan.label);
    (prepare(&file, &run.recording, &default_bench(), plan.label.clone()).unwrap().0, run.hidden)
}

fn of(experiment: &Experiment, bench: &BenchFile) -> EngineTorque {
    engine_torque(&Parts::of(&[experiment], bench), &work::Context::new())
}

fn centred(mut parameters: BenchParameters) -> BenchParameters {
    parameters.sensors.dyno_eccentricity = 0.0;
    parameters.sensors.engine_eccentricity = 0.0;
    parameters
}

/// The mean of the true torque from an instant on: T_e jumps between its samples where another cylinder takes over,
/// speeds do not.
fn true_mean(truth: &HiddenTruth, from_s: f64, duration_s: f64) -> f64 {
    let place = |t: f64| ((t / truth.sample_time_s).floor() as usize, (t / truth.sample_time_s).fract());
    let at = |x: &[f64], t: f64| {
        let (k, part) = place(t);
        x[k] + part * (x[k + 1] - x[k])
    };
    let integral = |x: &[f64], t: f64| {
        let (k, part) = place(t);
        let whole: f64 = x[..k].iter().zip(&x[1..]).map(|(a, b)| 0.5 * (a + b)).sum();
        truth.sample_time_s * (whole + part * (x[k] + 0.5 * part * (x[k + 1] - x[k])))
    };
    let mechanics = BenchParameters::default().mechanics;
    let impulse = |t: f64| {
        mechanics.dyno_inertia_kg_m2 * at(&truth.dyno_speed_rad_s, t)
            + mechanics.engine_inertia_kg_m2 * at(&truth.engine_speed_rad_s, t)
            + integral(&truth.air_gap_torque_nm, t)
    };
    (impulse(from_s + duration_s) - impulse(from_s)) / duration_s
}

/// Root mean square error of smoother and filter, how often the band holds the truth, and the same of cycles.
struct Judged {
    smoothed_nm: f64,
    filtered_nm: f64,
    inside: f64,
    cycles_nm: f64,
    cycles_inside: f64,
}

fn judged(recording: &EngineRecording, truth: &HiddenTruth) -> Judged {
    let engine = recording.engine.estimated().unwrap();
    let edge = (0.5 / engine.sample_time_s) as usize;
    let (mut smoothed, mut filtered, mut inside, mut count) = (0.0, 0.0, 0.0, 0.0);
    for k in edge..engine.smoothed_nm.len() - edge {
        let at = ((engine.start_s + k as f64 * engine.sample_time_s) / truth.sample_time_s).round() as usize;
        let Some(torque) = truth.engine_torque_nm.get(at) else { continue };
        let error = engine.smoothed_nm[k] - torque;
        smoothed += error * error;
        filtered += (engine.zero_phase_nm[k] - torque).powi(2);
        inside += f64::from(u8::from(error.abs() < 1.96 * engine.standard_deviation_nm[k]));
        count += 1.0;
    }
    let (mut squares, mut held, mut cycles) = (0.0, 0.0, 0.0);
    for cycle in recording.cycles.estimated().iter().flat_map(|all| &all.cycles) {
        let error = cycle.mean_nm - true_mean(truth, cycle.start_s, cycle.duration_s);
        squares += error * error;
        held += f64::from(u8::from(error.abs() < 1.96 * cycle.standard_deviation_nm));
        cycles += 1.0;
    }
    Judged {
        smoothed_nm: f64::sqrt(smoothed / count),
        filtered_nm: f64::sqrt(filtered / count),
        inside: inside / count,
        cycles_nm: f64::sqrt(squares / cycles),
        cycles_inside: held / cycles,
    }
}

#[test]
fn stat_the_smoother_is_nearer_to_the_engine_torque_than_the_filter_and_knows_how_near() {
    let mut bench = centred(BenchParameters::default());
    bench.engine.cylinder_factors = vec![1.06, 0.95, 1.02, 0.97];
    bench.clocks.engine_speed_skew_s = 1.1e-3;
    bench.clocks.torque_skew_s = -0.7e-3;
    let plans = [
        ExperimentPlan::bs_t_nt(1200.0, 12.0),
        ExperimentPlan::white_noise_t_tn(1200.0, 12.0),
        ExperimentPlan::white_noise_t_tn(3000.0, 12.0),
        ExperimentPlan::step_t_tn(2000.0, 12.0),
    ];
    let found = in_parallel(plans.len(), |i| {
        let (experiment, truth) = recorded(&bench, &plans[i], 3 + i as u64);
        let engine = of(&experiment, &default_bench());
        let recording = engine.recordings[0].clone();
        (judged(&recording, &truth), recording)
    });
    for (plan, (judged, recording)) in plans.iter().zip(&found) {
        let engine = recording.engine.estimated().unwrap();
        println!(
            "{}: smoother {:.3} Nm, filter {:.3} Nm, inside {:.3}; cycles {:.3} Nm, inside {:.3}; {:?}\n{:?}",
            plan.label,
            judged.smoothed_nm,
            judged.filtered_nm,
            judged.inside,
            judged.cycles_nm,
            judged.cycles_inside,
            engine.noise,
            recording.cycles.estimated().map(|c| (c.variation_nm, &c.cylinders, &c.orders)),
        );
    }
    for (plan, (judged, _)) in plans.iter().zip(&found) {
        assert!(judged.smoothed_nm < judged.filtered_nm, "{}", plan.label);
        assert!((0.88..=0.99).contains(&judged.inside), "{}: {}", plan.label, judged.inside);
        assert!((0.88..=1.0).contains(&judged.cycles_inside), "{}: {}", plan.label, judged.cycles_inside);
    }
}

/// Once-a-turn errors of the encoders are motions that the smoother's model lacks.
#[test]
fn stat_encoder_errors_widen_the_band() {
    let found = in_parallel(3, |i| {
        let plans = [
            ExperimentPlan::step_t_tn(3500.0, 12.0),
            ExperimentPlan::step_t_tn(2400.0, 12.0),
            ExperimentPlan::bs_t_nt(3700.0, 12.0),
        ];
        let plan = plans[i].clone();
        let (experiment, truth) = recorded(&BenchParameters::default(), &plan, 9);
        let recording = of(&experiment, &default_bench()).recordings[0].clone();
        (judged(&recording, &truth), recording.engine.estimated().unwrap().noise.widening)
    });
    for (judged, widening) in &found {
        println!("band {:.3}, widened {widening:.2} times", judged.inside);
    }
    assert!(found.iter().all(|(judged, widening)| judged.inside > 0.9 && (1.2..6.0).contains(widening)));
}

/// The first of them is any cylinder; what is compared with each is the true torque over its part of the cycle.
#[test]
fn stat_unequal_cylinders_are_found_in_the_order_in_which_they_fire() {
    let found = in_parallel(4, |i| {
        let mut bench = centred(BenchParameters::default());
        let is_equal = i >= 2;
        bench.engine.cylinder_factors = if is_equal { vec![1.0; 4] } else { vec![1.05, 1.0, 0.93, 1.02] };
        let (experiment, truth) = recorded(&bench, &ExperimentPlan::white_noise_t_tn(1200.0, 16.0), i as u64);
        let engine = of(&experiment, &default_bench());
        let cycles = engine.recordings[0].cycles.estimated().unwrap().clone();
        let apart = |c: usize| {
            let of_cycle = |cycle: &Cycle| {
                let quarter_s = 0.25 * cycle.duration_s;
                true_mean(&truth, cycle.start_s + c as f64 * quarter_s, quarter_s)
                    - true_mean(&truth, cycle.start_s, cycle.duration_s)
            };
            cycles.cycles.iter().map(of_cycle).sum::<f64>() / cycles.cycles.len() as f64
        };
        let truth: Vec<f64> = (0..4).map(apart).collect();
        (is_equal, cycles.cylinders, truth)
    });
    for (is_equal, found, truth) in &found {
        println!("{is_equal}: {found:?}, truth {truth:?}");
    }
    for (is_equal, found, truth) in &found {
        assert!((found.alike_probability > 0.001) == *is_equal, "{found:?}");
        assert!((found.once_a_turn.alike_probability.unwrap() > 0.001) == *is_equal, "{found:?}");
        for (cylinder, truth) in found.cylinders.iter().zip(truth) {
            assert!((cylinder.apart_nm - truth).abs() < 0.2, "{cylinder:?}, truth {truth}");
        }
    }
}

/// Equal cylinders and an encoder of which nothing is known: what comes back with every turn is not taken for a
/// cylinder's.
#[test]
fn stat_an_encoder_error_is_not_taken_for_cylinders() {
    let mut bench = centred(BenchParameters::default());
    bench.engine.cylinder_factors = vec![1.0; 4];
    bench.sensors.engine_eccentricity = 3e-4;
    let (experiment, _) = recorded(&bench, &ExperimentPlan::white_noise_t_tn(2000.0, 12.0), 5);
    let engine = of(&experiment, &default_bench());
    let cylinders = &engine.recordings[0].cycles.estimated().unwrap().cylinders;
    assert!(cylinders.alike_probability < 1e-6, "{cylinders:?}");
    let turn = &cylinders.once_a_turn;
    assert!(turn.alike_probability.unwrap() > 0.001, "{turn:?}");
    // Four cylinders see the pattern's cosine alone, whatever its sine is.
    assert!(turn.encoder_error < 4e-4 && turn.encoder_error > 0.0, "{turn:?}");
    // The interval holds the difference that is the encoder's alone.
    let holds = |c: &part_engine::Cylinder| c.apart_nm.abs() < 1.96 * c.whole_error_nm();
    assert!(cylinders.cylinders.iter().all(holds), "{cylinders:?}");
    let by_noise = |c: &part_engine::Cylinder| c.apart_nm.abs() > 1.96 * c.standard_error_nm;
    assert!(cylinders.cylinders.iter().any(by_noise), "{cylinders:?}");
}

#[test]
fn stat_the_engine_inertia_is_estimated_where_it_can_be_and_else_the_bench_files() {
    let bench = centred(BenchParameters::default());
    let (steps, _) = recorded(&bench, &ExperimentPlan::bs_t_nt(1200.0, 12.0), 1);
    let wrong = bench_file("0.6", "0.35", "400 Nm", BENCH_A);
    let alone = of(&steps, &wrong);
    let masses = alone.masses.estimated().unwrap();
    assert_eq!(masses.inertia_from, InertiaSource::BenchFile);
    assert_eq!(masses.values[6], 0.35);
    let (noise, _) = recorded(&bench, &ExperimentPlan::white_noise_t_tn(1500.0, 30.0), 2);
    let both = engine_torque(&Parts::of(&[&steps, &noise], &wrong), &work::Context::new());
    let masses = both.masses.estimated().unwrap();
    assert_eq!(masses.inertia_from, InertiaSource::Estimated(noise.file.clone()));
    assert!((masses.values[6] - 0.28).abs() < 0.01, "{masses:?}");
}

#[test]
fn exact_what_cannot_be_estimated_is_said() {
    let bench = centred(BenchParameters::default());
    let (fast, _) = recorded(&bench, &ExperimentPlan::white_noise_t_tn(5700.0, 8.0), 1);
    let found = of(&fast, &default_bench());
    let cycles = &found.recordings[0].cycles;
    assert!(
        matches!(cycles.needs(), [Reason::FiringsTooFast { needed_hz, rate_hz, .. }] if needed_hz > rate_hz),
        "{cycles:?}"
    );
    let none = engine_torque(&Parts::of(&[], &default_bench()), &work::Context::new());
    assert!(matches!(none.masses.needs(), [Reason::Recording { .. }]) && none.recordings.is_empty());
}
