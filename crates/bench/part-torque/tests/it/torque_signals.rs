//! The torque signals of virtual benches, against what they were made of.

use part_controller::SpeedControllers;
use part_torque::TorqueControls;
use part_torque::timing::{self, Filter, shaft_filter};
use part_torque::torque_control;
use part_torque::torque_signals::{OnceATurn, RebuiltShaft, TorqueSignals, Trust, torque_signals};
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use rig::facts::BenchVariant;
use rig::results::{Outcome, Reason};
use rig::{Experiment, Role, prepare};
use signal::excitation::Random;
use virtual_bench::{HiddenTruth, Numerics, simulate, simulate_hidden};

use bench_testkit::benches::{default_bench, in_parallel};

fn recorded(parameters: &BenchParameters, plan: &ExperimentPlan, seed: u64) -> (Experiment, HiddenTruth) {
    let run = simulate_hidden(parameters, plan, seed, Numerics::default()).unwrap();
    let file = format!("{}.mf4", plan.label);
    (prepare(&file, &run.recording, &default_bench(), plan.label.clone()).unwrap().0, run.hidden)
}

fn of(experiment: &Experiment) -> TorqueSignals {
    of_all(&[experiment])
}

fn of_all(experiments: &[&Experiment]) -> TorqueSignals {
    let bench = default_bench();
    let limit = bench.limits.torque_nm;
    let (controllers, controls) = (SpeedControllers::of(experiments, limit), TorqueControls::of(experiments, limit));
    torque_signals(&controllers, &controls, &bench, &work::Context::new())
}

/// Root mean square error of smoother and filter, and how often the smoother's 95 % band holds the truth, without the
/// ends.
fn against_truth(shaft: &RebuiltShaft, truth: &HiddenTruth) -> (f64, f64, f64) {
    let edge = (0.5 / shaft.sample_time_s) as usize;
    let (mut smoothed, mut filtered, mut inside, mut count) = (0.0, 0.0, 0.0, 0.0);
    for k in edge..shaft.smoothed_nm.len() - edge {
        let at = ((shaft.start_s + k as f64 * shaft.sample_time_s) / truth.sample_time_s).round() as usize;
        let Some(torque) = truth.shaft_torque_nm.get(at) else { continue };
        let error = shaft.smoothed_nm[k] - torque;
        smoothed += error * error;
        filtered += (shaft.zero_phase_nm[k] - torque).powi(2);
        inside += f64::from(u8::from(error.abs() < 1.96 * shaft.standard_deviation_nm[k]));
        count += 1.0;
    }
    (f64::sqrt(smoothed / count), f64::sqrt(filtered / count), inside / count)
}

fn rebuilt(signals: &TorqueSignals) -> &RebuiltShaft {
    match &signals.recordings[0].shaft {
        Some(Outcome::Estimated(shaft)) => shaft,
        other => panic!("{other:?}"),
    }
}

fn centred(mut parameters: BenchParameters) -> BenchParameters {
    parameters.sensors.dyno_eccentricity = 0.0;
    parameters
}

#[test]
fn stat_the_smoother_is_nearer_to_the_shaft_torque_than_the_filter_and_knows_how_near() {
    let bench = centred(BenchParameters::default());
    let plans = [
        ExperimentPlan::bs_t_nt(1200.0, 20.0),
        ExperimentPlan::white_noise_t_tn(1200.0, 20.0),
        ExperimentPlan::white_noise_t_tn(3000.0, 20.0),
        ExperimentPlan::step_t_tn(2000.0, 20.0),
    ];
    let found = in_parallel(plans.len(), |i| {
        let (experiment, truth) = recorded(&bench, &plans[i], 3 + i as u64);
        let signals = of(&experiment);
        let shaft = rebuilt(&signals);
        (against_truth(shaft, &truth), shaft.noise.clone(), shaft.torque)
    });
    for (plan, ((smoothed, filtered, inside), noise, torque)) in plans.iter().zip(&found) {
        println!(
            "{} {torque:?}: smoother {smoothed:.3} Nm, filter {filtered:.3} Nm, inside {inside:.3}; {noise:?}",
            plan.label
        );
    }
    for (plan, ((smoothed, filtered, inside), _, _)) in plans.iter().zip(&found) {
        assert!(smoothed < filtered, "{}: {smoothed}, {filtered}", plan.label);
        assert!((0.88..=0.99).contains(inside), "{}: {inside}", plan.label);
    }
}

/// In a ramp no order has one frequency, so the smoother has no oscillation for it. What it leaves out, the filter
/// shows.
#[test]
fn stat_where_the_speed_changes_the_band_of_the_smoother_still_holds_the_shaft_torque() {
    let (experiment, truth) =
        recorded(&centred(BenchParameters::default()), &ExperimentPlan::ramp_n_nt(1200.0, 20.0), 5);
    let signals = of(&experiment);
    let shaft = rebuilt(&signals);
    let (smoothed, _, inside) = against_truth(shaft, &truth);
    println!("off by {smoothed:.3} Nm, inside {inside:.3}, routes {:.3} Nm apart", shaft.routes_apart_nm);
    assert!(inside > 0.9, "{inside}: off by {smoothed}, routes {} apart", shaft.routes_apart_nm);
}

/// The virtual bench's controller reads the speed that is recorded, so nothing tells the encoder's error from a motion.
#[test]
fn stat_an_unknown_once_a_turn_error_is_said_and_stands_at_order_1() {
    let (experiment, truth) = recorded(&BenchParameters::default(), &ExperimentPlan::bs_t_nt(1200.0, 20.0), 3);
    let signals = of(&experiment);
    let shaft = rebuilt(&signals);
    let OnceATurn::Unknown(worth_nm) = shaft.once_a_turn else { panic!("{:?}", shaft.once_a_turn) };
    // J 10⁻⁴ ω² at 1200 rpm.
    assert!((worth_nm - 0.6e-4 * 125.66_f64.powi(2)).abs() < 0.01, "{worth_nm}");
    let (smoothed, ..) = against_truth(shaft, &truth);
    // The encoder's error is 2·10⁻⁴.
    assert!((smoothed - 2.0 * worth_nm / 2f64.sqrt()).abs() < 0.15, "{smoothed}, {worth_nm}");
}

#[test]
fn exact_the_length_of_the_moving_average() {
    let lengths = [1, 2, 3, 5, 8, 16, 17, 31, 32, 48, 63, 64];
    let found = in_parallel(lengths.len(), |i| {
        let mut parameters = BenchParameters::default();
        parameters.sensors.moving_average = lengths[i];
        parameters.clocks.torque_decimation = [1, 2, 4, 5, 10][i % 5];
        parameters.clocks.torque_skew_s = 1e-4 * (i % 7) as f64 - 3e-4;
        let plan = match i % 2 {
            0 => ExperimentPlan::white_noise_t_tn(1500.0, 10.0),
            _ => ExperimentPlan::bs_t_nt(1200.0, 10.0),
        };
        shaft_filter(&recorded(&parameters, &plan, i as u64).0)
    });
    for (length, filter) in lengths.iter().zip(&found) {
        let filter = filter.as_ref().unwrap();
        assert_eq!(filter.moving_average_length(), Some(*length), "{filter:?}");
        let own = 1e-3 * (*length as f64 - 1.0) / 2.0;
        assert!((filter.best.filter_delay_s - own).abs() < 1e-12);
        assert!((filter.best.inertia_kg_m2 - 0.6).abs() < 1e-3, "{filter:?}");
        assert!(filter.is_decided(), "{filter:?}");
    }
}

/// With noise of its own upon the system's shaft torque, as much as its acceleration part has, and an inertia that is
/// not the bench file's.
#[test]
#[ignore = "slow"]
fn stat_the_length_of_the_moving_average_of_every_length_under_noise() {
    let right = in_parallel(128, |i| {
        let mut random = Random::new(i as u64);
        let mut parameters = BenchParameters::default();
        parameters.sensors.moving_average = 1 + i % 64;
        parameters.clocks.torque_decimation = [1, 2, 4, 5][i % 4];
        parameters.clocks.torque_skew_s = 2e-3 * (random.uniform() - 0.5);
        parameters.engine.cycle_variation = 0.03 * random.uniform();
        let speed_rpm = 900.0 + 3000.0 * random.uniform();
        let plan = match i % 3 {
            0 => ExperimentPlan::white_noise_t_tn(speed_rpm, 20.0),
            1 => ExperimentPlan::bs_t_nt(speed_rpm, 20.0),
            _ => ExperimentPlan::step_t_tn(speed_rpm, 20.0),
        };
        let (mut experiment, _) = recorded(&parameters, &plan, i as u64);
        let spread = shaft_filter(&experiment).unwrap().spread_nm;
        let shaft = experiment.signals.get_mut(&Role::SystemShaftTorque).unwrap();
        *shaft = shaft.map(|t| t + 0.1 * spread * random.normal());
        let found = shaft_filter(&experiment);
        let length = found.as_ref().and_then(|filter| filter.moving_average_length());
        let decided = found.as_ref().is_some_and(|filter| filter.is_decided());
        (length == Some(1 + i % 64), decided, i)
    });
    let wrong: Vec<usize> = right.iter().filter(|r| !r.0).map(|r| r.2).collect();
    let claimed_wrong: Vec<usize> = right.iter().filter(|r| !r.0 && r.1).map(|r| r.2).collect();
    println!("wrong: {wrong:?}, claimed all the same: {claimed_wrong:?}");
    assert!(wrong.len() <= 6 && claimed_wrong.len() <= 2);
}

#[test]
fn stat_a_lag_and_a_delay_are_not_taken_for_an_average() {
    let (mut experiment, _) = recorded(&BenchParameters::default(), &ExperimentPlan::white_noise_t_tn(1500.0, 20.0), 1);
    let speed = experiment.signal(Role::DynoSpeed).unwrap().samples.clone();
    let calculated = experiment.signal(Role::AirGapTorque).unwrap().clone();
    let mut with = |acceleration: &dyn Fn(usize) -> f64| {
        let values = calculated.samples.iter().enumerate().map(|(i, t)| t + 0.7 * acceleration(4 * i)).collect();
        experiment.signals.insert(Role::SystemShaftTorque, calculated.with_samples(values));
        shaft_filter(&experiment).unwrap()
    };
    let (mut state, mut lagged) = (0.0, vec![0.0]);
    let keep = (-1.0 / 10.0_f64).exp();
    for w in speed.windows(2) {
        state = keep * state + (1.0 - keep) * (w[1] - w[0]) / 1e-3;
        lagged.push(state);
    }
    let lag = with(&|k| lagged[k]);
    assert!(
        matches!(lag.best.filter, Filter::Lag { time_constant_s } if (time_constant_s / 0.01 - 1.0).abs() < 0.1),
        "{lag:?}"
    );
    assert!((lag.best.inertia_kg_m2 - 0.7).abs() < 0.02);
    let delay = with(&|k| if k > 12 { (speed[k - 11] - speed[k - 12]) / 1e-3 } else { 0.0 });
    assert_eq!(delay.best.filter, Filter::Delay, "{delay:?}");
    assert!((delay.best.delay_s - 11.5e-3).abs() < 1e-9);
}

#[test]
fn stat_delays_of_the_default_bench_agree_and_the_load_cell_is_late() {
    let (experiment, _) = recorded(&BenchParameters::default(), &ExperimentPlan::white_noise_t_tn(1200.0, 30.0), 2);
    let signals = of(&experiment);
    let delays = signals.recordings[0].delays.estimated().unwrap();
    let late = |role: Role| delays.iter().find(|d| d.role == role).unwrap();
    for delay in delays {
        println!(
            "{:?} {:?} {:?} {:?} {:?}",
            delay.role,
            delay.against_demand,
            delay.against_speed_bend,
            delay.routes,
            delay.routes_agree()
        );
    }
    let calculated = late(Role::AirGapTorque).against_demand.as_ref().unwrap();
    assert!(calculated.value < 4e-3, "within a sample: {calculated:?}");
    let cell = late(Role::LoadCellTorque).against_demand.as_ref().unwrap();
    assert!(cell.value - calculated.value > 8e-3);
    assert_eq!(late(Role::AirGapTorque).routes_agree(), Some(true));
    assert_eq!(late(Role::LoadCellTorque).routes_agree(), Some(true));
    let (_, parameters) = signals.load_cell().unwrap();
    assert!((parameters[1].value / (std::f64::consts::TAU * 75.0) - 1.0).abs() < 0.02, "{parameters:?}");
}

#[test]
#[ignore = "slow"]
fn stat_intervals_of_the_load_cell_cover() {
    const RUNS: usize = 50;
    let covered = in_parallel(RUNS, |i| {
        let mut random = Random::new(500 + i as u64);
        let mut within = |low: f64, high: f64| low + (high - low) * random.uniform();
        let mut parameters = BenchParameters::default();
        parameters.sensors.cell_delay_s = within(2e-3, 12e-3);
        parameters.sensors.cell_resonance_hz = within(50.0, 100.0);
        parameters.sensors.cell_damping_ratio = within(0.1, 0.5);
        parameters.sensors.cell_noise_nm = within(0.0, 0.5);
        let sensors = parameters.sensors.clone();
        let (experiment, _) = recorded(&parameters, &ExperimentPlan::white_noise_t_tn(1200.0, 24.0), i as u64);
        let control = torque_control::estimate(&experiment, Some(400.0)).unwrap();
        let delays = timing::estimate(&[&experiment], Some(&control), 0.6).unwrap().delays;
        let found = &delays.iter().find_map(|delay| delay.dynamics.as_ref()).unwrap().parameters;
        let truth =
            [sensors.cell_delay_s, std::f64::consts::TAU * sensors.cell_resonance_hz, sensors.cell_damping_ratio];
        let holds = |k: usize| found[k].interval.0 <= truth[k] && truth[k] <= found[k].interval.1;
        let near = |k: usize| (found[k].value - truth[k]).abs() < 0.02 * truth[k];
        ([holds(0), holds(1), holds(2)], [near(0), near(1), near(2)])
    });
    let share = |is_right: &dyn Fn(usize) -> bool| (0..RUNS).filter(|i| is_right(*i)).count() as f64 / RUNS as f64;
    let held = [0, 1, 2].map(|k| share(&|i| covered[i].0[k]));
    let near = [0, 1, 2].map(|k| share(&|i| covered[i].1[k]));
    println!("τ_cell, ω_n, ζ: covered {held:?}, within 2 % {near:?}");
    // Binomial(50, 0.95) is at least 43 with probability 0.996.
    let least = [0.86; 3];
    assert!(held.iter().zip(&least).all(|(share, least)| share >= least), "{held:?}");
    assert!(near.iter().all(|share| *share >= 0.95), "{near:?}");
}

/// N_d bends half a gate later than T_d acts; orders of the engine at which nothing is coherent lie in the band.
#[test]
#[ignore = "slow"]
fn stat_the_bend_of_the_speed_is_found_between_engine_orders() {
    let errors = in_parallel(8, |seed| {
        let (experiment, _) =
            recorded(&BenchParameters::default(), &ExperimentPlan::white_noise_t_tn(1200.0, 30.0), seed as u64);
        let signals = of(&experiment);
        let delay =
            signals.recordings[0].delays.estimated().unwrap().iter().find(|d| d.role == Role::AirGapTorque).unwrap();
        let bend = delay.against_speed_bend.clone().unwrap();
        ((bend.value + 0.5e-3).abs(), bend.standard_error)
    });
    assert!(errors.iter().all(|(error, standard)| *error < 1e-4 && *standard < 5e-5), "{errors:?}");
}

#[test]
fn stat_an_inverter_that_misjudges_its_machine_is_not_trusted() {
    let trust = |error: f64| {
        let mut parameters = BenchParameters::default();
        parameters.drive.knowledge.cold_error = error;
        let plans = [ExperimentPlan::step_t_tn(1200.0, 24.0), ExperimentPlan::bs_t_nt(1200.0, 20.0)];
        let experiments: Vec<Experiment> = plans.iter().map(|plan| recorded(&parameters, plan, 5).0).collect();
        of_all(&experiments.iter().collect::<Vec<_>>()).trust.unwrap()
    };
    let right = trust(0.0);
    assert_eq!(right.verdict, Trust::Trusted, "{:?} {:?}", right.offset, right.gain);
    let wrong = trust(0.05);
    println!("{:?}\n{:?}\n{:?}", wrong.offset, wrong.gain, wrong.torques_nm);
    assert_eq!(wrong.verdict, Trust::Off);
    // T_d = 1.05 T_d,calc, and the load cell reads T_d.
    let gain = wrong.gain.unwrap();
    assert!((gain.value - (1.0 / 1.05 - 1.0)).abs() < 3.0 * gain.standard_error + 2e-3, "{gain:?}");
}

#[test]
fn regress_a_bench_without_load_cell_has_no_trust_check() {
    let mut parameters = BenchParameters::torque_flange();
    assert_eq!(parameters.variant, BenchVariant::TorqueFlange);
    parameters.mechanics.flywheel = None;
    let plan = ExperimentPlan::white_noise_t_tn(1200.0, 8.0);
    let recording = simulate(&parameters, &plan, 1).unwrap();
    let (experiment, _) = prepare("WhiteNoise_T_TN.mf4", &recording, &default_bench(), plan.label).unwrap();
    let signals = of(&experiment);
    assert!(signals.trust.is_none() && signals.recordings[0].filter.is_none());
    assert!(matches!(signals.recordings[0].shaft, Some(Outcome::Estimated(_))));
}

#[test]
fn regress_what_a_recording_does_not_tell_is_said() {
    let (whole, _) = recorded(&BenchParameters::default(), &ExperimentPlan::white_noise_t_tn(1200.0, 6.0), 1);
    let without = |role: Role| {
        let mut other = whole.clone();
        other.signals.remove(&role);
        of(&other).recordings.remove(0)
    };
    let recording = without(Role::DynoSpeed);
    assert_eq!(recording.shaft.map(|shaft| shaft.estimated().is_some()), Some(false));
    assert_eq!(recording.filter.map(|shaft| shaft.estimated().is_some()), Some(false));
    let recording = without(Role::DynoTorqueDemand);
    assert!(recording.delays.estimated().is_none());
    assert!(matches!(recording.delays.needs(), [Reason::Channel { role: Role::DynoTorqueDemand, .. }]));
    assert!(recording.shaft.is_some_and(|shaft| shaft.estimated().is_some()));
    let mut still = whole.clone();
    let demand = still.signals.get_mut(&Role::DynoTorqueDemand).unwrap();
    *demand = demand.map(|_| 60.0);
    assert!(of(&still).recordings[0].delays.estimated().is_none());
    let mut unrelated = whole.clone();
    let shaft = unrelated.signals.get_mut(&Role::SystemShaftTorque).unwrap();
    *shaft = shaft.with_samples((0..shaft.len()).map(|i| (0.37 * i as f64).sin()).collect());
    let not_explained = Reason::NotExplained { file: unrelated.file.clone() };
    assert_eq!(of(&unrelated).recordings[0].filter, Some(Outcome::because(not_explained)));
}

/// Of the first samples, about which less is known than about those in the middle.
#[test]
fn regress_the_deviation_of_the_first_samples_is_positive_and_covers() {
    let bench = centred(BenchParameters::default());
    let found = in_parallel(4, |i| {
        let plan = ExperimentPlan::white_noise_t_tn([1200.0, 2000.0][i % 2], 10.0);
        let (experiment, truth) = recorded(&bench, &plan, 40 + i as u64);
        let signals = of(&experiment);
        let shaft = rebuilt(&signals);
        let at = |k: usize| ((shaft.start_s + k as f64 * shaft.sample_time_s) / truth.sample_time_s).round() as usize;
        let error = |k: usize| shaft.smoothed_nm[k] - truth.shaft_torque_nm[at(k)];
        let first: Vec<(f64, f64)> = (0..25).map(|k| (error(k), shaft.standard_deviation_nm[k])).collect();
        let settled = shaft.standard_deviation_nm[shaft.standard_deviation_nm.len() / 2];
        (first, settled)
    });
    let mut inside = 0.0;
    for (first, settled) in &found {
        println!("{settled:.3}: {first:.3?}");
        assert!(first.iter().all(|(_, deviation)| *deviation > 0.9 * settled), "{first:?}, settled {settled}");
        inside += first.iter().filter(|(error, deviation)| error.abs() < 1.96 * deviation).count() as f64;
    }
    let share = inside / (25 * found.len()) as f64;
    assert!(share > 0.8, "{share}");
}

#[test]
fn regress_a_torque_of_the_wrong_sign_tells_no_delay_and_no_shaft_torque() {
    let (mut experiment, _) = recorded(&BenchParameters::default(), &ExperimentPlan::white_noise_t_tn(1200.0, 15.0), 2);
    let torque = experiment.signals.get_mut(&Role::AirGapTorque).unwrap();
    *torque = torque.map(|t| -t);
    let signals = of(&experiment);
    let recording = &signals.recordings[0];
    let wrong = Reason::WrongSign { file: experiment.file.clone(), role: Role::AirGapTorque };
    assert_eq!(recording.shaft, Some(Outcome::because(wrong.clone())));
    assert_eq!(recording.filter, Some(Outcome::because(wrong.clone())));
    let delays = recording.delays.estimated().unwrap();
    assert!(delays.iter().all(|delay| delay.role != Role::AirGapTorque), "{delays:?}");
    assert!(signals.trust.is_none());
    let engine =
        part_engine::engine_torque(&part_shaft::Parts::of(&[&experiment], &default_bench()), &work::Context::new());
    assert_eq!(engine.masses, Outcome::because(wrong));
}
