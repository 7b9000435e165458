//! Friction and inertia of a dynamometer that turns by itself, against what it was made of.

use std::collections::BTreeMap;

use part_friction::{Friction, FrictionError, FrictionOptions, Inertia, Term, TorqueUsed, Undetermined, estimate};
use rig::bench_parameters::BenchParameters;
use rig::dyno_friction::EstimatedFriction;
use rig::experiment::{ExperimentPlan, Waveform};
use rig::results::Parameter;
use rig::{ControlMode, Experiment, Role, prepare};
use signal::Signal;
use signal::excitation::Random;
use units::RPM_RAD_S;
use virtual_bench::simulate;

use bench_testkit::benches::{default_bench, in_parallel};

const OPTIONS: FrictionOptions =
    FrictionOptions { inertia_kg_m2: 0.6, slowest_rad_s: None, torque_limit_nm: Some(400.0) };

/// A dynamometer of J_d = 0.5 kg m² under a torque, by small steps; N_d at 1 kHz, T_d at 250 Hz and `late_s` late.
fn made(friction: [f64; 4], torque: impl Fn(f64) -> f64, late_s: f64, noise: f64, seed: u64) -> Experiment {
    let (inertia, step, duration_s) = (0.5, 1e-4, 30.0);
    let mut random = Random::new(seed);
    let slope = |t: f64, w: f64| {
        let [c, v, q, k] = friction;
        -(torque(t) + c * w.signum() + v * w + q * w * w.abs() + k * w.powi(3)) / inertia
    };
    let (mut speed, mut speeds) = (200.0, Vec::new());
    for i in 0..(duration_s / step) as usize {
        if i % 10 == 0 {
            speeds.push(speed + noise * random.normal());
        }
        let t = i as f64 * step;
        let half = speed + 0.5 * step * slope(t, speed);
        speed += step * slope(t + 0.5 * step, half);
    }
    let torques =
        (0..(duration_s / 4e-3) as usize).map(|i| torque(4e-3 * i as f64 - late_s) + 10.0 * noise * random.normal());
    let signals = [
        (Role::DynoSpeed, Signal::new(0.0, 1e-3, speeds).unwrap()),
        (Role::AirGapTorque, Signal::new(0.0, 4e-3, torques.collect()).unwrap()),
    ];
    Experiment { file: "made.mf4".to_owned(), label: "NoShaft_N_NT".parse().unwrap(), signals: BTreeMap::from(signals) }
}

fn driven(t: f64) -> f64 {
    10.0 * (0.9 * t).sin() - 5.0 * (2.3 * t).cos()
}

fn found(experiment: &Experiment) -> Friction {
    estimate(&[experiment], OPTIONS).unwrap()
}

fn inertia(friction: &Friction) -> (&Parameter, &Parameter) {
    match &friction.inertia {
        Inertia::Estimated { inertia, delay } => (inertia.as_ref(), delay.as_ref()),
        Inertia::Stated { .. } => panic!("{:?}", friction.inertia),
    }
}

fn holds(parameter: &Parameter, truth: f64) -> bool {
    let (low, high) = parameter.interval;
    (low..=high).contains(&truth)
}

#[test]
fn exact_inertia_friction_and_delay_of_a_motion_without_noise() {
    let made = made([1.5, 0.02, 0.0, 0.0], driven, 3e-3, 0.0, 1);
    let friction = found(&made);
    let (inertia, delay) = inertia(&friction);
    assert!((inertia.value - 0.5).abs() < 2e-5, "{inertia:?}");
    assert!((delay.value - 3e-3).abs() < 5e-6, "{delay:?}");
    let parameters = &friction.friction.parameters;
    assert!((parameters[0].value - 1.5).abs() < 2e-3, "{parameters:?}");
    assert!((parameters[1].value - 0.02).abs() < 2e-5, "{parameters:?}");
    let run_out = &friction.run_outs[0];
    let apart = run_out.measured_rad_s.iter().zip(&run_out.modelled_rad_s).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f64::max) < 0.05);
}

#[test]
fn stat_an_offset_is_found_where_both_directions_are_seen() {
    let mut swung = made([1.5, 0.02, 0.0, 0.0], |t| 150.0 * (1.5 * t).sin(), 0.0, 0.003, 5);
    let torque = swung.signals.get_mut(&Role::AirGapTorque).unwrap();
    *torque = torque.map(|t| t - 2.0);
    let friction = found(&swung);
    assert_eq!(friction.terms(), [Term::Offset, Term::Coulomb, Term::Viscous], "{:?}", friction.candidates);
    // Viscous friction is not compared: to a torque of one sine it does what a delay of the torque does.
    for (parameter, truth) in friction.friction.parameters.iter().zip([2.0, 1.5]) {
        assert!((parameter.value - truth).abs() < 4.0 * parameter.standard_error, "{parameter:?}, truth {truth}");
        assert!(parameter.standard_error < 0.1 * truth, "{parameter:?}");
    }
}

#[test]
fn stat_terms_are_kept_where_they_are_there() {
    let plain = found(&made([1.5, 0.02, 0.0, 0.0], driven, 0.0, 0.003, 2));
    assert_eq!(plain.terms(), [Term::Coulomb, Term::Viscous], "{:?}", plain.candidates);
    let windy = found(&made([1.5, 0.02, 2e-4, 0.0], driven, 0.0, 0.003, 3));
    assert_eq!(windy.terms(), [Term::Coulomb, Term::Viscous, Term::Quadratic], "{:?}", windy.candidates);
    for (parameter, truth) in windy.friction.parameters.iter().zip([1.5, 0.02, 2e-4]) {
        assert!((parameter.value - truth).abs() < 4.0 * parameter.standard_error, "{parameter:?}");
    }
    for point in &windy.curve {
        let w = point.speed_rad_s;
        let truth = 1.5 * w.signum() + 0.02 * w + 2e-4 * w * w.abs();
        assert!((point.torque_nm - truth).abs() < 2.5 * point.half_width_nm, "{point:?}, {truth}");
    }
}

#[test]
fn stat_a_run_out_without_torque_tells_friction_over_inertia_alone() {
    let made = made([1.5, 0.02, 0.0, 0.0], |_| 0.0, 0.0, 0.0, 1);
    let mut free = made.clone();
    let friction = found(&free);
    assert_eq!(friction.inertia, Inertia::Stated { inertia_kg_m2: 0.6, why: Undetermined::TorqueFree });
    assert!((friction.per_inertia.parameters[0].value - 3.0).abs() < 1e-3);
    assert!((friction.per_inertia.parameters[1].value - 0.04).abs() < 1e-5);
    assert!((friction.friction.parameters[0].value - 1.8).abs() < 1e-3);
    free.signals.remove(&Role::AirGapTorque);
    let unrecorded = found(&free);
    assert_eq!(unrecorded.inertia, Inertia::Stated { inertia_kg_m2: 0.6, why: Undetermined::NoTorque });
    assert!((unrecorded.per_inertia.parameters[0].value - 3.0).abs() < 1e-3);
}

#[test]
fn stat_drop_outs_are_left_out() {
    let mut made = made([1.5, 0.02, 0.0, 0.0], driven, 0.0, 0.003, 4);
    let speed = made.signals.get_mut(&Role::DynoSpeed).unwrap();
    for i in [700, 4000, 4001, 20_000] {
        speed.samples[i] = 0.0;
    }
    let friction = found(&made);
    assert_eq!(friction.run_outs.iter().map(|r| r.left_out).sum::<usize>(), 4);
    assert!((inertia(&friction).0.value - 0.5).abs() < 1e-3);
}

/// A bench with friction; steps of speed, or a run-out.
fn bench_with(coulomb: f64, viscous: f64, inertia: f64) -> BenchParameters {
    let mut parameters = BenchParameters::default();
    parameters.mechanics.coulomb_friction_nm = coulomb;
    parameters.mechanics.viscous_friction_nm_s_per_rad = viscous;
    parameters.mechanics.dyno_inertia_kg_m2 = inertia;
    parameters
}

fn steps() -> ExperimentPlan {
    let mut plan = ExperimentPlan::no_shaft_n_nt(600.0, 24.0);
    plan.speed_rad_s = Waveform::Square { first: 600.0 * RPM_RAD_S, second: 1800.0 * RPM_RAD_S, dwell_s: 4.0 };
    plan
}

fn run_out() -> ExperimentPlan {
    let mut plan = ExperimentPlan::no_shaft_n_nt(3000.0, 30.0);
    plan.label.mode = ControlMode::Tn;
    plan.dyno_torque_nm = Waveform::Constant { value: 0.0 };
    plan
}

fn recorded(parameters: &BenchParameters, plan: &ExperimentPlan, seed: u64) -> Experiment {
    let recording = simulate(parameters, plan, seed).unwrap();
    prepare("run.mf4", &recording, &default_bench(), plan.label.clone()).unwrap().0
}

#[test]
fn stat_friction_and_inertia_of_the_virtual_bench() {
    let friction = found(&recorded(&bench_with(3.0, 0.02, 0.55), &steps(), 3));
    let (inertia, delay) = inertia(&friction);
    println!("{inertia:?}\n{delay:?}\n{:#?}", friction.friction.parameters);
    assert!(holds(inertia, 0.55) && inertia.standard_error < 0.005, "{inertia:?}");
    // N_d is the mean over a gate of 1 ms that ends at its stamp.
    assert!((delay.value + 0.5e-3).abs() < 4.0 * delay.standard_error + 0.1e-3, "{delay:?}");
    for (parameter, truth) in friction.friction.parameters.iter().zip([3.0, 0.02]) {
        assert!((parameter.value - truth).abs() < 4.0 * parameter.standard_error, "{parameter:?}");
    }
}

#[test]
fn stat_run_out_of_the_virtual_bench() {
    let friction = found(&recorded(&bench_with(3.0, 0.02, 0.6), &run_out(), 3));
    println!("{:?}\n{:#?}", friction.inertia, friction.per_inertia.parameters);
    assert!(matches!(friction.inertia, Inertia::Stated { .. }));
    for (parameter, truth) in friction.per_inertia.parameters.iter().zip([5.0, 0.02 / 0.6]) {
        assert!((parameter.value - truth).abs() < 4.0 * parameter.standard_error + 0.01 * truth, "{parameter:?}");
    }
}

#[test]
#[ignore = "slow"]
fn stat_intervals_of_inertia_and_friction_cover() {
    const RUNS: usize = 80;
    let covered = in_parallel(RUNS, |i| {
        let mut random = Random::new(1000 + i as u64);
        let mut within = |low: f64, high: f64| low + (high - low) * random.uniform();
        let (coulomb, viscous, inertia_truth) = (within(0.5, 6.0), within(0.005, 0.05), within(0.3, 0.9));
        let mut parameters = bench_with(coulomb, viscous, inertia_truth);
        parameters.clocks.torque_skew_s = within(-2e-3, 2e-3);
        let skew = parameters.clocks.torque_skew_s;
        let friction = found(&recorded(&parameters, &steps(), i as u64));
        let (inertia, delay) = inertia(&friction);
        let [c, v] = &friction.friction.parameters[..2] else { panic!() };
        let middle = &friction.curve[friction.curve.len() / 2];
        let truth = coulomb + viscous * middle.speed_rad_s;
        [
            holds(inertia, inertia_truth),
            holds(c, coulomb),
            holds(v, viscous),
            (middle.torque_nm - truth).abs() < middle.half_width_nm,
            holds(delay, skew - 0.5e-3),
            friction.terms().len() == 2,
        ]
    });
    let names = ["J_d", "c_0", "c_1", "T_fric in the middle", "δ_T", "no more terms than there are"];
    for (k, name) in names.iter().enumerate() {
        let share = covered.iter().filter(|c| c[k]).count() as f64 / RUNS as f64;
        println!("{name}: {share:.3}");
        assert!(share >= 0.9, "{name}: {share}");
    }
}

/// The line of the bench model from two recordings of a bench with this friction.
fn line_of(parameters: &BenchParameters, seed: u64) -> EstimatedFriction {
    let plans = if seed.is_multiple_of(2) { [steps(), run_out()] } else { [steps(), steps()] };
    let both = [0, 1].map(|i| recorded(parameters, &plans[i], 100 * i as u64 + seed));
    let stated = default_bench().dynamometer_inertia();
    estimate(&[&both[0], &both[1]], OPTIONS).unwrap().linear(stated).unwrap()
}

/// Tells whether the 95 % intervals of the line hold the friction at the lowest, the middle and the highest speed.
fn covered(seed: u64) -> [bool; 3] {
    let mut random = Random::new(3000 + seed);
    let mut within = |low: f64, high: f64| low + (high - low) * random.uniform();
    let (coulomb, viscous) = (within(0.0, 3.0), within(0.0, 0.03));
    let line = line_of(&bench_with(coulomb, viscous, within(0.4, 0.8)), seed);
    let (low, high) = line.speeds_rad_s;
    [low, 0.5 * (low + high), high].map(|speed| {
        let apart = line.torque_nm(speed) - coulomb - viscous * speed;
        let holds = apart.abs() < line.half_width_nm(speed);
        if !holds {
            println!("{seed}, {speed:.0} rad/s: off by {apart:.3} Nm, ± {:.3} Nm", line.half_width_nm(speed));
        }
        holds
    })
}

#[test]
fn stat_line_of_the_bench_model_holds_the_friction() {
    for holds in in_parallel(2, |i| covered(500 + i as u64)) {
        assert!(holds.iter().filter(|holds| **holds).count() >= 2, "{holds:?}");
    }
    let line = line_of(&bench_with(1.5, 0.02, 0.6), 4);
    assert!(line.speeds_rad_s.0 < 70.0 && line.speeds_rad_s.1 > 250.0, "{line:?}");
    assert!((line.torque_nm(150.0) - 4.5).abs() < 0.3 && line.half_width_nm(150.0) < 0.5, "{line:?}");
}

#[test]
#[ignore = "slow"]
fn stat_intervals_of_the_line_of_the_bench_model_cover() {
    const RUNS: usize = 40;
    let found = in_parallel(RUNS, |i| covered(i as u64));
    for (k, place) in ["lowest", "middle", "highest"].iter().enumerate() {
        let share = found.iter().filter(|holds| holds[k]).count() as f64 / RUNS as f64;
        println!("{place} speed: {share:.3}");
        assert!(share >= 0.88, "{place} speed: {share}");
    }
}

/// Where T_d* does not tell what T_d does between its samples: T_d,calc alone, and the load cell alone, 8 ms late and
/// with a resonance at 75 Hz.
#[test]
#[ignore = "slow"]
fn stat_intervals_cover_without_the_demand_and_with_the_load_cell_alone() {
    const RUNS: usize = 40;
    for (source, without) in [
        (TorqueUsed::Calculated, vec![Role::DynoTorqueDemand]),
        (TorqueUsed::LoadCell, vec![Role::AirGapTorque]),
        (TorqueUsed::LoadCell, vec![Role::AirGapTorque, Role::DynoTorqueDemand]),
    ] {
        let found = in_parallel(RUNS, |i| {
            let mut random = Random::new(2000 + i as u64);
            let mut within = |low: f64, high: f64| low + (high - low) * random.uniform();
            let (coulomb, viscous, truth) = (within(0.0, 6.0), within(0.0, 0.05), within(0.3, 0.9));
            let plan = if i % 2 == 0 { steps() } else { ExperimentPlan::no_shaft_n_nt(1200.0, 15.0) };
            let mut experiment = recorded(&bench_with(coulomb, viscous, truth), &plan, i as u64);
            without.iter().for_each(|role| drop(experiment.signals.remove(role)));
            let friction = found(&experiment);
            assert!(friction.run_outs.iter().all(|run_out| run_out.torque == Some(source)));
            let (inertia, delay) = inertia(&friction);
            let middle = &friction.curve[friction.curve.len() / 2];
            let apart = middle.torque_nm - (coulomb + viscous * middle.speed_rad_s);
            // The cell's own delay, and that of its resonance at low frequencies, 2ζ/ω_n.
            let of_cell = 8e-3 + 2.0 * 0.25 / (std::f64::consts::TAU * 75.0);
            let late = if source == TorqueUsed::LoadCell { of_cell } else { 0.0 } - 0.5e-3;
            let errors =
                [inertia.value / truth - 1.0, inertia.standard_error / truth, delay.value, delay.standard_error];
            ([holds(inertia, truth), holds(delay, late), apart.abs() < middle.half_width_nm], errors)
        });
        let share = |k: usize| found.iter().filter(|f| f.0[k]).count() as f64 / RUNS as f64;
        for parity in 0..2 {
            let own: Vec<&[f64; 4]> = found.iter().skip(parity).step_by(2).map(|f| &f.1).collect();
            let mean = |k: usize| own.iter().map(|e| e[k]).sum::<f64>() / own.len() as f64;
            println!("{source:?} without {without:?}: {:?}", [0, 1, 2, 3].map(mean));
        }
        println!("J_d, δ_T, T_fric in the middle: {:?}", [0, 1, 2].map(share));
        assert!([0, 1, 2].iter().all(|k| share(*k) >= 0.875), "{source:?}");
    }
}

#[test]
fn regress_friction_that_no_dynamometer_has_is_refused() {
    let driven_by_engine = made([-20.0, 0.0, 0.0, 0.0], driven, 0.0, 0.003, 4);
    let text = estimate(&[&driven_by_engine], OPTIONS).unwrap_err().to_string();
    assert!(["made.mf4", "would drive", "shaft on", "sign"].iter().all(|word| text.contains(word)), "{text}");
    let mut negative = made([1.5, 0.02, 0.0, 0.0], driven, 0.0, 0.003, 4);
    let torque = negative.signals.get_mut(&Role::AirGapTorque).unwrap();
    *torque = torque.map(|t| -t);
    let text = estimate(&[&negative], OPTIONS).unwrap_err().to_string();
    assert!(["T_d,calc", "sign = -1", "air_gap_torque"].iter().all(|word| text.contains(word)), "{text}");
    // A recording with the engine on that is labelled as one without shaft.
    let plan = ExperimentPlan::bs_t_nt(1200.0, 15.0);
    let recording = simulate(&BenchParameters::default(), &plan, 3).unwrap();
    let mut mislabelled = prepare("bs.mf4", &recording, &default_bench(), "BS_T_NT".parse().unwrap()).unwrap().0;
    mislabelled.label = "NoShaft_N_NT".parse().unwrap();
    let text = estimate(&[&mislabelled], OPTIONS).unwrap_err().to_string();
    assert!(text.contains("shaft on") && text.contains("label"), "{text}");
}

/// The run-out of a flywheel dynamometer that is kept beside the project: time, s, and speed, rad/s.
fn flywheel() -> Option<(Vec<f64>, Vec<f64>)> {
    let text = std::fs::read_to_string(testdata::shared("reference/inertia-dyno/unloaded_spindown.txt")?).unwrap();
    let rows: Vec<Vec<f64>> =
        text.lines().map(|line| line.split_whitespace().filter_map(|cell| cell.parse().ok()).collect()).collect();
    let mut last = f64::NEG_INFINITY;
    let later = rows.iter().filter(|row| {
        let is_later = row.len() >= 6 && row[5] > last;
        last = if is_later { row[5] } else { last };
        is_later
    });
    Some(later.map(|row| (row[5] * 1e-3, row[3] * RPM_RAD_S)).unzip())
}

/// Published (spindown.m, with J = 0.8489 kg m²): dω/dt = −1.74e-7 ω³ + 2.903e-5 ω² − 3.222e-3 ω − 3.097e-2, from 4 s
/// past the peak down to 4 rad/s.
#[test]
fn ref_run_out_of_a_flywheel_dynamometer() {
    let Some((time_s, speed)) = flywheel() else { return };
    let peak = (0..speed.len()).max_by(|a, b| speed[*a].total_cmp(&speed[*b])).unwrap();
    let samples = speed[peak + 200..].to_vec();
    let signal = Signal::new(time_s[peak + 200], 0.02, samples).unwrap();
    let experiment = Experiment {
        file: "unloaded_spindown.txt".to_owned(),
        label: "NoShaft_T_TN".parse().unwrap(),
        signals: BTreeMap::from([(Role::DynoSpeed, signal)]),
    };
    let options = FrictionOptions { inertia_kg_m2: 0.8489, slowest_rad_s: Some(4.0), torque_limit_nm: None };
    let friction = estimate(&[&experiment], options).unwrap();
    let published = |w: f64| 1.74e-7 * w.powi(3) - 2.903e-5 * w * w + 3.222e-3 * w + 3.097e-2;
    println!("terms {:?}, left out {}", friction.terms(), friction.run_outs[0].left_out);
    friction.per_inertia.parameters.iter().for_each(|p| println!("{} {} ± {}", p.quantity, p.value, p.standard_error));
    for point in &friction.curve {
        let ours = point.torque_nm / 0.8489;
        let theirs = published(point.speed_rad_s);
        println!(
            "{:6.2} rad/s: ours {ours:.4} ± {:.4}, published {theirs:.4}",
            point.speed_rad_s,
            point.half_width_nm / 0.8489
        );
        assert!((ours / theirs - 1.0).abs() < 0.05, "{} rad/s: {ours}, published {theirs}", point.speed_rad_s);
    }
}

#[test]
fn regress_recordings_that_tell_nothing_of_friction_say_which_would() {
    let whole = made([1.5, 0.02, 0.0, 0.0], driven, 0.0, 0.003, 4);
    let refused = |experiment: &Experiment, words: &[&str]| {
        let text = estimate(&[experiment], OPTIONS).unwrap_err().to_string();
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    };
    assert!(matches!(estimate(&[], OPTIONS), Err(FrictionError::NoRecording)));
    let with_shaft = Experiment { label: "BS_T_NT".parse().unwrap(), ..whole.clone() };
    refused(&with_shaft, &["made.mf4", "BS_T_NT", "shaft on", "NoShaft_N_NT"]);
    let mut without_speed = whole.clone();
    without_speed.signals.remove(&Role::DynoSpeed);
    refused(&without_speed, &["N_d", "dyno_speed"]);
    let speed = |f: &dyn Fn(f64) -> f64| {
        let mut other = whole.clone();
        let speed = other.signals.get_mut(&Role::DynoSpeed).unwrap();
        *speed = speed.map(f);
        other
    };
    refused(&speed(&|_| 100.0), &["between 955 and 955 rpm", "NoShaft_N_NT"]);
    refused(&speed(&|_| 0.0), &["turns faster than 10 rpm", "record longer"]);
}
