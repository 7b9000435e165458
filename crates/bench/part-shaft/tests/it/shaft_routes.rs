//! The shaft by state space, black box and sample maximum likelihood: virtual benches drawn at random, and one
//! simulated by others.

use std::f64::consts::TAU;

use part_shaft::shaft::{ShaftInputs, Wanted, fit};
use part_shaft::shaft_routes::Timing;
use part_shaft::shaft_routes::black_box::{self, BlackBoxDoubt, BlackBoxRoute};
use part_shaft::shaft_routes::multisine::{self, DynoInertia, MultisineRoute};
use part_shaft::shaft_routes::state_space::{self, Skews, StateSpaceRoute};
use part_torque::air_gap_torque::NoisyTorque;
use part_torque::torque_control::{self, AirGapTorqueModel};
use rig::bench_parameters::BenchParameters;
use rig::estimation::EstimateError;
use rig::experiment::{ExperimentPlan, Test, Waveform};
use rig::facts::Engine;
use rig::results::{Estimate, Quantity};
use rig::{ControlMode, Experiment, Role};
use signal::excitation::{Multisine, Phases, Random, Timing as Length};
use units::RPM_RAD_S;
use virtual_bench::simulate;

use bench_testkit::benches::{bench_file, in_parallel};
use bench_testkit::recordings::{BENCH_A, recordings};

const ENGINE: Engine = Engine { cylinders: 4, strokes: 4 };

/// A bench and the speed it runs at, rpm.
struct Drawn {
    parameters: BenchParameters,
    speed_rpm: f64,
}

/// An experiment on it, and T_d as finely as it is known.
struct Recorded {
    experiment: Experiment,
    torque: NoisyTorque,
    inertia_kg_m2: f64,
    encoder_noise_rad_s: f64,
}

impl Drawn {
    fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut within = |low: f64, high: f64| low + (high - low) * random.uniform();
        let mut parameters = BenchParameters::default();
        let mechanics = &mut parameters.mechanics;
        mechanics.dyno_inertia_kg_m2 = within(0.3, 1.2);
        mechanics.engine_inertia_kg_m2 = within(0.12, 0.5);
        let (dyno, engine) = (mechanics.dyno_inertia_kg_m2, mechanics.engine_inertia_kg_m2);
        let resonance_rad_s = TAU * within(12.0, 25.0);
        mechanics.shaft_stiffness_nm_per_rad = resonance_rad_s * resonance_rad_s * dyno * engine / (dyno + engine);
        mechanics.shaft_damping_nm_s_per_rad =
            2.0 * within(0.05, 0.15) * mechanics.shaft_stiffness_nm_per_rad / resonance_rad_s;
        parameters.clocks.engine_speed_skew_s = within(-2e-3, 2e-3);
        parameters.clocks.torque_skew_s = within(-2e-3, 2e-3);
        parameters.drive.delay_s = within(0.5e-3, 2e-3);
        parameters.drive.bandwidth_rad_s = TAU * within(60.0, 150.0);
        parameters.drive.additive_ripple_nm = within(0.0, 1.0);
        parameters.engine.cylinder_factors = (0..4).map(|_| within(0.93, 1.07)).collect();
        parameters.engine.cycle_variation = within(0.005, 0.03);
        parameters.sensors.dyno_eccentricity = within(0.0, 5e-4);
        parameters.sensors.engine_eccentricity = within(0.0, 5e-4);
        Drawn { parameters, speed_rpm: within(1000.0, 3000.0).round() }
    }

    /// The default bench with perfect sensors, drive and engine.
    fn exact() -> Self {
        let mut parameters = BenchParameters::default();
        let sensors = &mut parameters.sensors;
        (sensors.dyno_eccentricity, sensors.engine_eccentricity) = (0.0, 0.0);
        (sensors.speed_noise_rad_s, sensors.speed_resolution_rad_s) = (0.0, 0.0);
        (sensors.calc_noise_nm, sensors.demand_resolution_nm) = (0.0, 0.0);
        (parameters.drive.additive_ripple_nm, parameters.drive.multiplicative_ripple) = (0.0, 0.0);
        parameters.engine.cycle_variation = 0.0;
        Drawn { parameters, speed_rpm: 1213.0 }
    }

    fn truth(&self, quantity: Quantity) -> f64 {
        let mechanics = &self.parameters.mechanics;
        match quantity {
            Quantity::Stiffness => mechanics.shaft_stiffness_nm_per_rad,
            Quantity::Damping => mechanics.shaft_damping_nm_s_per_rad,
            Quantity::DynoInertia => mechanics.dyno_inertia_kg_m2,
            Quantity::EngineInertia => mechanics.engine_inertia_kg_m2,
            _ => panic!("{quantity} has no truth"),
        }
    }

    fn experiment(&self, plan: &ExperimentPlan, seed: u64) -> Experiment {
        let recording = simulate(&self.parameters, plan, seed).unwrap();
        let inertia = self.parameters.mechanics.dyno_inertia_kg_m2.to_string();
        let file = bench_file(&inertia, "0.28", "400 Nm", BENCH_A);
        rig::prepare("drawn.mf4", &recording, &file, plan.label.clone()).unwrap().0
    }

    fn torque_model(&self, seed: u64) -> AirGapTorqueModel {
        let white = self.experiment(&ExperimentPlan::white_noise_t_tn(self.speed_rpm, 20.0), seed);
        torque_control::estimate(&white, Some(400.0)).unwrap().model
    }

    fn recorded(&self, plan: &ExperimentPlan, seed: u64) -> Recorded {
        let experiment = self.experiment(plan, seed);
        let inertia_kg_m2 = self.parameters.mechanics.dyno_inertia_kg_m2;
        let noise = self.parameters.sensors.speed_noise_rad_s;
        let torque_model = match plan.label.mode {
            ControlMode::Nt => self.torque_model(seed + 1000),
            ControlMode::Tn => torque_control::estimate(&experiment, Some(400.0)).unwrap().model,
        };
        Recorded::new(experiment, &torque_model, inertia_kg_m2, noise)
    }

    /// White torque demands.
    fn white(&self, duration_s: f64, seed: u64) -> Recorded {
        self.recorded(&ExperimentPlan::white_noise_t_tn(self.speed_rpm, duration_s), seed)
    }

    /// Sines from 0.5 to 40 Hz at once, every `period_s`.
    fn periodic(&self, period_s: f64, duration_s: f64, seed: u64) -> Recorded {
        let period = (period_s / 0.01).round() as usize;
        let harmonics = ((0.5 * period_s) as usize..=(40.0 * period_s) as usize).collect();
        let sines = Multisine::flat(period, harmonics, 12.0, Phases::Schroeder);
        let values = sines.generate(Length { sample_time_s: 0.01, length: period }).unwrap().samples;
        let mut plan = ExperimentPlan::step_t_tn(self.speed_rpm, duration_s);
        plan.label.test = Test::Multisine;
        plan.dyno_torque_nm =
            Waveform::Periodic { sample_time_s: 0.01, values: values.iter().map(|x| 60.0 + x).collect() };
        self.recorded(&plan, seed)
    }
}

impl Recorded {
    fn new(
        experiment: Experiment,
        torque_model: &AirGapTorqueModel,
        inertia_kg_m2: f64,
        encoder_noise_rad_s: f64,
    ) -> Self {
        let signal = |role| experiment.signal(role).unwrap();
        let demand = signal(Role::DynoTorqueDemand);
        let torque_model = torque_model.refit_ripple(demand, signal(Role::AirGapTorque)).unwrap();
        let torque = NoisyTorque::new(torque_model.finer_air_gap_torque(demand, 8), 0.005);
        Recorded { experiment, torque, inertia_kg_m2, encoder_noise_rad_s }
    }

    fn inputs(&self) -> ShaftInputs<'_> {
        let signal = |role| self.experiment.signal(role).unwrap();
        ShaftInputs {
            file: &self.experiment.file,
            dyno_speed: signal(Role::DynoSpeed),
            engine_speed: signal(Role::EngineSpeed),
            torque: vec![self.torque.clone()],
            inertia_kg_m2: Some((self.inertia_kg_m2, 0.0)),
            friction_slope_nm_s_per_rad: ShaftInputs::usual_friction(self.inertia_kg_m2),
            encoder_noise_rad_s: self.encoder_noise_rad_s,
            gate_s: (1e-3, 1e-5),
            torque_control: None,
            firings_per_turn: 0.0,
        }
    }

    fn timing(&self) -> Timing {
        Timing::of(&fit(&self.inputs(), Wanted::Shaft).unwrap().estimate).unwrap()
    }

    fn state_space(&self, timing: &Timing) -> StateSpaceRoute {
        state_space::estimate(&self.inputs(), timing, Skews::Estimated).unwrap()
    }

    fn black_box(&self, timing: &Timing) -> BlackBoxRoute {
        black_box::estimate(&self.inputs(), timing, ENGINE, self.experiment.label.mode).unwrap()
    }

    fn multisine(&self, timing: &Timing, inertia: DynoInertia) -> Result<MultisineRoute, EstimateError> {
        let demand = self.experiment.signal(Role::DynoTorqueDemand).unwrap();
        multisine::estimate(&self.inputs(), demand, timing, inertia, ENGINE)
    }
}

/// A parameter is within a part of the truth.
fn is_near(estimate: &Estimate, quantity: Quantity, truth: f64, part: f64) {
    let found = estimate.parameter(quantity).unwrap();
    println!("{quantity} = {} ± {}, truth {truth}", found.value, found.standard_error);
    assert!((found.value - truth).abs() <= part * truth, "{found:?}, truth {truth}");
}

/// Part of the benches in whose interval the truth lies, and the largest error as a part of the truth.
fn judged(rows: &[(Drawn, Estimate)], quantity: Quantity) -> (f64, f64) {
    let mut largest: f64 = 0.0;
    let mut held = 0;
    let pairs: Vec<_> =
        rows.iter().filter_map(|(bench, e)| Some((bench.truth(quantity), e.parameter(quantity)?))).collect();
    for (truth, found) in &pairs {
        largest = largest.max((found.value / truth - 1.0).abs());
        held += usize::from(found.interval.0 <= *truth && *truth <= found.interval.1);
    }
    println!("{quantity}: {held} of {} in the interval, largest error {largest:.1e}", pairs.len());
    (held as f64 / pairs.len() as f64, largest)
}

/// No error is as large as its limit, a part of the truth, and four of five intervals or more contain the truth.
fn are_near_and_held(rows: &[(Drawn, Estimate)], limits: &[(Quantity, f64)]) {
    for (quantity, largest) in limits {
        let (coverage, error) = judged(rows, *quantity);
        assert!(coverage >= 0.8 && error < *largest, "{quantity}: {coverage}, {error}");
    }
}

#[test]
fn exact_state_space_finds_the_shaft_of_a_perfect_bench() {
    let bench = Drawn::exact();
    let found = bench.white(16.0, 3).state_space(&Timing::synchronous(1e-3));
    is_near(&found.estimate, Quantity::Stiffness, bench.truth(Quantity::Stiffness), 1e-3);
    is_near(&found.estimate, Quantity::Damping, bench.truth(Quantity::Damping), 5e-3);
    assert!(found.validation.fit_percent > 99.0, "{}", found.validation.fit_percent);
}

#[test]
fn exact_multisine_finds_shaft_and_inertia_of_a_perfect_bench() {
    let bench = Drawn::exact();
    let found = bench.periodic(2.0, 24.0, 3).multisine(&Timing::synchronous(1e-3), DynoInertia::Estimated).unwrap();
    assert_eq!(found.period_s, 2.0);
    for (quantity, part) in [(Quantity::Stiffness, 1e-3), (Quantity::Damping, 3e-3), (Quantity::DynoInertia, 1e-3)] {
        is_near(&found.estimate, quantity, bench.truth(quantity), part);
    }
}

#[test]
fn stat_black_box_of_a_motored_engine_tells_both_inertias() {
    let bench = Drawn { parameters: BenchParameters::default(), speed_rpm: 1200.0 };
    let recorded = bench.recorded(&ExperimentPlan::unfired_n_nt(1200.0, 20.0), 4);
    let found = recorded.black_box(&Timing::synchronous(1e-3));
    for quantity in [Quantity::DynoInertia, Quantity::EngineInertia, Quantity::Stiffness, Quantity::Damping] {
        is_near(&found.estimate, quantity, bench.truth(quantity), 0.003);
    }
    println!("{:?} {}", found.chi_squared, found.probability);
    assert_eq!(found.chi_squared.1, 4.0);
    assert!(!found.doubts.contains(&BlackBoxDoubt::EngineInertiaTooSmall), "{found:?}");
}

#[test]
fn stat_the_engine_s_speed_control_is_no_two_mass_bench() {
    let bench = Drawn { parameters: BenchParameters::default(), speed_rpm: 1200.0 };
    let found = bench.white(20.0, 4).black_box(&Timing::synchronous(1e-3));
    is_near(&found.estimate, Quantity::Stiffness, bench.truth(Quantity::Stiffness), 0.06);
    // The control acts a firing late, which the model does not know and the coefficients show.
    assert!(found.doubts.contains(&BlackBoxDoubt::NotTwoMasses), "{found:?}");
}

#[test]
fn regress_a_demand_that_does_not_repeat_is_refused_with_what_to_record() {
    let bench = Drawn::exact();
    let timing = Timing::synchronous(1e-3);
    for recorded in [bench.white(12.0, 3), bench.periodic(4.0, 12.0, 3)] {
        let refused = recorded.multisine(&timing, DynoInertia::Stated).unwrap_err().to_string();
        assert!(refused.contains("record Multisine_T_TN"), "{refused}");
    }
}

#[test]
fn regress_a_flange_is_refused() {
    let recorded = Drawn::exact().white(12.0, 3);
    let inputs = ShaftInputs { inertia_kg_m2: None, ..recorded.inputs() };
    let refused = state_space::estimate(&inputs, &Timing::synchronous(1e-3), Skews::Given);
    assert!(matches!(refused, Err(EstimateError::Unsuitable { .. })), "{refused:?}");
}

/// The same data with torque and inertias in a unit `part` of the size.
fn in_other_unit<'a>(inputs: &ShaftInputs<'a>, part: f64) -> ShaftInputs<'a> {
    let smaller = |torque: &NoisyTorque| NoisyTorque {
        signal: torque.signal.with_samples(torque.signal.samples.iter().map(|x| x / part).collect()),
        noise_nm: torque.noise_nm / part,
        ..torque.clone()
    };
    let (slope, uncertainty) = inputs.friction_slope_nm_s_per_rad;
    ShaftInputs {
        torque: inputs.torque.iter().map(smaller).collect(),
        inertia_kg_m2: inputs.inertia_kg_m2.map(|(value, uncertainty)| (value / part, uncertainty / part)),
        friction_slope_nm_s_per_rad: (slope / part, uncertainty / part),
        ..inputs.clone()
    }
}

#[test]
#[ignore = "slow"]
fn prop_parameters_go_with_the_unit_of_torque() {
    let bench = Drawn { parameters: BenchParameters::default(), speed_rpm: 1213.0 };
    let timing = Timing::synchronous(1e-3);
    let periodic = bench.periodic(2.0, 16.0, 3);
    let demand = periodic.experiment.signal(Role::DynoTorqueDemand).unwrap();
    let motored = bench.recorded(&ExperimentPlan::unfired_n_nt(1200.0, 20.0), 4);
    let by_periods = |inputs: &ShaftInputs<'_>| {
        multisine::estimate(inputs, demand, &timing, DynoInertia::Estimated, ENGINE).unwrap().estimate
    };
    goes_with_the_unit(&periodic.inputs(), by_periods);
    goes_with_the_unit(&periodic.inputs(), |inputs| {
        state_space::estimate(inputs, &timing, Skews::Estimated).unwrap().estimate
    });
    goes_with_the_unit(&motored.inputs(), |inputs| {
        black_box::estimate(inputs, &timing, ENGINE, ControlMode::Nt).unwrap().estimate
    });
}

fn goes_with_the_unit(inputs: &ShaftInputs<'_>, route: impl Fn(&ShaftInputs<'_>) -> Estimate) {
    const PART: f64 = 7.0;
    let (own, other) = (route(inputs), route(&in_other_unit(inputs, PART)));
    for quantity in [Quantity::Stiffness, Quantity::Damping, Quantity::DynoInertia, Quantity::EngineInertia] {
        let Some((a, b)) = own.parameter(quantity).zip(other.parameter(quantity)) else { continue };
        assert!((b.value * PART / a.value - 1.0).abs() < 1e-4, "{quantity}: {a:?}, {b:?}");
        assert!((b.standard_error * PART / a.standard_error - 1.0).abs() < 0.05, "{quantity}: {a:?}, {b:?}");
    }
}

/// Of 64 intervals of 95 %, 54 or fewer contain the truth once in 800 times.
#[test]
#[ignore = "slow: 64 benches"]
fn stat_state_space_of_64_benches() {
    let rows = in_parallel(64, |i| {
        let bench = Drawn::new(5000 + i as u64);
        let recorded = bench.white(14.0, i as u64);
        let estimate = recorded.state_space(&recorded.timing()).estimate;
        (bench, estimate)
    });
    let limits = [(Quantity::Stiffness, 0.03), (Quantity::Damping, 0.3)];
    are_near_and_held(&rows, &limits);
    for (quantity, _) in limits {
        let (coverage, _) = judged(&rows, quantity);
        assert!(coverage >= 55.0 / 64.0, "{quantity}: {coverage}");
    }
}

#[test]
#[ignore = "slow: 16 benches"]
fn stat_multisine_of_16_benches() {
    let rows = in_parallel(16, |i| {
        let bench = Drawn::new(5000 + i as u64);
        let recorded = bench.periodic(2.0, 24.0, i as u64);
        let estimate = recorded.multisine(&recorded.timing(), DynoInertia::Estimated).unwrap().estimate;
        (bench, estimate)
    });
    are_near_and_held(
        &rows,
        &[
            (Quantity::Stiffness, 0.02),
            (Quantity::Damping, 0.1),
            (Quantity::DynoInertia, 0.02),
            (Quantity::EngineInertia, 0.1),
        ],
    );
}

/// Where two masses explain the coefficients, the parameters are near the truth; where they do not, intervals are wide
/// enough.
#[test]
#[ignore = "slow: 16 benches"]
fn stat_black_box_of_16_motored_benches() {
    let rows = in_parallel(16, |i| {
        let bench = Drawn::new(7000 + i as u64);
        let recorded = bench.recorded(&ExperimentPlan::unfired_n_nt(bench.speed_rpm, 30.0), i as u64);
        let route = black_box::estimate(&recorded.inputs(), &recorded.timing(), ENGINE, ControlMode::Nt);
        (bench, route)
    });
    let found = rows.into_iter().filter_map(|(bench, route)| Some((bench, route.ok()?)));
    let (sure, doubted): (Vec<_>, Vec<_>) = found.partition(|(_, route)| route.doubts.is_empty());
    assert!(sure.len() >= 8 && sure.len() + doubted.len() >= 14, "{} and {}", sure.len(), doubted.len());
    let estimates = |rows: Vec<(Drawn, BlackBoxRoute)>| rows.into_iter().map(|(bench, route)| (bench, route.estimate));
    let mut rows: Vec<_> = estimates(sure).collect();
    are_near_and_held(
        &rows,
        &[
            (Quantity::Stiffness, 0.01),
            (Quantity::Damping, 0.03),
            (Quantity::DynoInertia, 0.003),
            (Quantity::EngineInertia, 0.01),
        ],
    );
    rows.extend(estimates(doubted));
    for quantity in [Quantity::Stiffness, Quantity::Damping, Quantity::DynoInertia, Quantity::EngineInertia] {
        let (coverage, _) = judged(&rows, quantity);
        assert!(coverage >= 0.8, "{quantity}: {coverage}");
    }
}

/// An experiment of bench A by the start of its file's name.
fn bench_a(all: &[(String, recording::Recording)], name: &str) -> Experiment {
    let file = bench_file("0.6", "0.28", "400 Nm", BENCH_A);
    let (name, recording) = all.iter().find(|(file, _)| file.starts_with(name)).unwrap();
    rig::prepare(name, recording, &file, file.label_of(name).unwrap()).unwrap().0
}

#[test]
fn ref_bench_a_by_state_space_and_black_box() {
    let all = recordings("bench-a");
    if all.is_empty() {
        return;
    }
    let white = bench_a(&all, "WhiteNoise");
    let torque_model = torque_control::estimate(&white, Some(400.0)).unwrap().model;
    let recorded = |experiment| Recorded::new(experiment, &torque_model, 0.6, 0.03 * RPM_RAD_S);
    for name in ["BS_T_NT_1200", "WhiteNoise"] {
        let recorded = recorded(bench_a(&all, name));
        let found = recorded.state_space(&recorded.timing());
        println!("{name}: fit {} %, bias {:?}", found.validation.fit_percent, found.bias_taken_off);
        is_near(&found.estimate, Quantity::Stiffness, 2437.7, 0.01);
        // Its simulator's steps are worth K · 25 µs of damping.
        is_near(&found.estimate, Quantity::Damping, 5.8 + 2437.7 * 25e-6, 0.03);
    }
    let motored = recorded(bench_a(&all, "Unfired"));
    let found = motored.black_box(&motored.timing());
    println!("{:?} {} {:?}", found.chi_squared, found.probability, found.doubts);
    for (quantity, truth) in [
        (Quantity::DynoInertia, 0.6),
        (Quantity::EngineInertia, 0.28),
        (Quantity::Stiffness, 2437.7),
        (Quantity::Damping, 5.86),
    ] {
        is_near(&found.estimate, quantity, truth, 0.05);
    }
}
