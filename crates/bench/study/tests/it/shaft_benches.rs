//! The shaft of many benches, each drawn at random with its clocks apart and its engine fired.

use std::f64::consts::TAU;

use part_shaft::shaft::{ShaftInputs, Wanted, fit};
use part_torque::air_gap_torque::NoisyTorque;
use part_torque::torque_control;
use rig::bench_parameters::{BenchParameters, Harmonic};
use rig::experiment::{ExperimentPlan, Waveform};
use rig::results::{Estimate, Outcome, Quantity};
use rig::{BenchFile, Experiment, Role};
use signal::excitation::Random;
use study::Source;
use units::RPM_RAD_S;
use virtual_bench::simulate;

use crate::study::{source, studied};
use bench_testkit::benches::{bench_file, in_parallel};
use bench_testkit::recordings::BENCH_A;

/// A bench drawn over realistic ranges, with what its bench file says.
pub(crate) struct Drawn {
    pub(crate) parameters: BenchParameters,
    file: BenchFile,
    speed_rpm: f64,
}

impl Drawn {
    pub(crate) fn new(seed: usize) -> Self {
        let mut random = Random::new(seed as u64);
        let mut within = |low: f64, high: f64| low + (high - low) * random.uniform();
        let mut parameters = BenchParameters::default();
        let mechanics = &mut parameters.mechanics;
        mechanics.dyno_inertia_kg_m2 = within(0.3, 1.2);
        mechanics.engine_inertia_kg_m2 = within(0.12, 0.5);
        let (dyno, engine) = (mechanics.dyno_inertia_kg_m2, mechanics.engine_inertia_kg_m2);
        let resonance_rad_s = TAU * within(12.0, 25.0);
        mechanics.shaft_stiffness_nm_per_rad = resonance_rad_s * resonance_rad_s * dyno * engine / (dyno + engine);
        let damping_ratio = within(0.05, 0.15);
        mechanics.shaft_damping_nm_s_per_rad =
            2.0 * damping_ratio * mechanics.shaft_stiffness_nm_per_rad / resonance_rad_s;
        parameters.clocks.engine_speed_skew_s = within(-2e-3, 2e-3);
        parameters.clocks.torque_skew_s = within(-2e-3, 2e-3);
        parameters.drive.delay_s = within(0.5e-3, 2e-3);
        parameters.drive.bandwidth_rad_s = TAU * within(60.0, 150.0);
        parameters.drive.additive_ripple_nm = within(0.0, 1.0);
        parameters.engine.cylinder_factors = (0..4).map(|_| within(0.93, 1.07)).collect();
        parameters.engine.cycle_variation = within(0.005, 0.03);
        parameters.sensors.dyno_eccentricity = within(0.0, 5e-4);
        parameters.sensors.engine_eccentricity = within(0.0, 5e-4);
        let file = bench_file(&dyno.to_string(), &engine.to_string(), "400 Nm", BENCH_A);
        Self { parameters, file, speed_rpm: within(1000.0, 3000.0).round() }
    }

    /// The truth of a parameter of the shaft's estimate.
    fn truth(&self, quantity: Quantity) -> f64 {
        let mechanics = &self.parameters.mechanics;
        match quantity {
            Quantity::Stiffness => mechanics.shaft_stiffness_nm_per_rad,
            Quantity::Damping => mechanics.shaft_damping_nm_s_per_rad,
            Quantity::DynoInertia => mechanics.dyno_inertia_kg_m2,
            Quantity::EngineInertia => mechanics.engine_inertia_kg_m2,
            Quantity::EngineSpeedSkew => self.parameters.clocks.engine_speed_skew_s,
            _ => panic!("{quantity} has no truth"),
        }
    }

    /// Estimate of the shaft in a study of two recordings; none where T_d,calc is stamped before the T_d* that it
    /// follows, which strikes what rests on the torques.
    fn study(&self, seed: u64) -> Option<Estimate> {
        let plans = [
            ("BS_T_NT.mf4", ExperimentPlan::bs_t_nt(self.speed_rpm, 20.0)),
            ("WhiteNoise_T_TN.mf4", ExperimentPlan::white_noise_t_tn(self.speed_rpm, 10.0)),
        ];
        let recorded = |((file, plan), seed): (&(&str, ExperimentPlan), u64)| {
            source(file, Ok(simulate(&self.parameters, plan, seed).unwrap()))
        };
        let sources: Vec<Source> = plans.iter().zip(2 * seed..).map(recorded).collect();
        match studied(&self.file, sources).shaft {
            Outcome::Estimated(shaft) => Some(shaft.estimate),
            Outcome::NotEstimated { needs } => {
                let (clocks, drive) = (&self.parameters.clocks, &self.parameters.drive);
                assert!(clocks.torque_skew_s + drive.delay_s < 0.0, "{needs:?}: {clocks:?} {drive:?}");
                None
            }
        }
    }

    /// K, B, J_d and J_e from 64 s of a white torque demand of so much standard deviation.
    fn inertias(&self, deviation_nm: f64, seed: u64) -> Estimate {
        let experiment = self.white_noise((60.0, deviation_nm), 64.0, seed);
        let demand = experiment.signal(Role::DynoTorqueDemand).unwrap();
        // Nothing is known of J_d but its order of magnitude.
        let wanted = Wanted::Inertias { demand, firings_per_turn: 2.0 };
        fit(&inputs(&experiment, 0.6), wanted).unwrap().estimate
    }

    /// A recording of a white torque demand of so much mean and standard deviation.
    pub(crate) fn white_noise(&self, (mean, standard_deviation): (f64, f64), duration_s: f64, seed: u64) -> Experiment {
        let mut plan = ExperimentPlan::white_noise_t_tn(self.speed_rpm, duration_s);
        plan.dyno_torque_nm = Waveform::WhiteNoise { mean, standard_deviation };
        let recording = simulate(&self.parameters, &plan, seed).unwrap();
        rig::prepare("WhiteNoise_T_TN.mf4", &recording, &self.file, plan.label).unwrap().0
    }
}

/// Inputs of the shaft's estimate, J_d being known exactly.
pub(crate) fn inputs(experiment: &Experiment, inertia_kg_m2: f64) -> ShaftInputs<'_> {
    let torque_model = torque_control::estimate(experiment, Some(400.0)).unwrap().model;
    let signal = |role| experiment.signal(role).unwrap();
    let torque = torque_model.finer_air_gap_torque(signal(Role::DynoTorqueDemand), 8);
    ShaftInputs {
        file: &experiment.file,
        dyno_speed: signal(Role::DynoSpeed),
        engine_speed: signal(Role::EngineSpeed),
        torque: vec![NoisyTorque::new(torque, 0.005)],
        inertia_kg_m2: Some((inertia_kg_m2, 0.0)),
        friction_slope_nm_s_per_rad: ShaftInputs::usual_friction(inertia_kg_m2),
        encoder_noise_rad_s: 0.03 * RPM_RAD_S,
        gate_s: (1e-3, 1e-4),

        torque_control: None,
        firings_per_turn: 0.0,
    }
}

/// One parameter in many benches: its error, relative or not, and whether its interval holds the truth.
struct Judged {
    errors: Vec<f64>,
    held: usize,
}

impl Judged {
    fn of(quantity: Quantity, rows: &[(Drawn, Estimate)], relative: bool) -> Self {
        let mut judged = Judged { errors: Vec::new(), held: 0 };
        for (bench, estimate) in rows {
            let (found, truth) = (estimate.parameter(quantity).unwrap(), bench.truth(quantity));
            judged.errors.push((found.value - truth).abs() / if relative { truth } else { 1.0 });
            judged.held += usize::from(found.interval.0 <= truth && truth <= found.interval.1);
        }
        let largest = judged.errors.iter().copied().fold(0.0, f64::max);
        println!("{quantity}: largest error {largest:.2e}, {} of {} in the interval", judged.held, rows.len());
        judged
    }

    fn within(&self, tolerance: f64) -> f64 {
        self.errors.iter().filter(|e| **e <= tolerance).count() as f64 / self.errors.len() as f64
    }

    fn coverage(&self) -> f64 {
        self.held as f64 / self.errors.len() as f64
    }
}

#[test]
#[ignore = "slow: 200 benches"]
fn stat_the_shaft_of_200_benches_whose_clocks_are_apart() {
    let studies = in_parallel(200, |i| {
        let bench = Drawn::new(1000 + i);
        let estimate = bench.study(i as u64)?;
        Some((bench, estimate))
    });
    let rows: Vec<(Drawn, Estimate)> = studies.into_iter().flatten().collect();
    println!("{} of 200 benches have torques in their order", rows.len());
    assert!(rows.len() > 150, "{}", rows.len());
    for (quantity, tolerance, relative) in
        [(Quantity::Stiffness, 0.02, true), (Quantity::Damping, 0.1, true), (Quantity::EngineSpeedSkew, 1e-4, false)]
    {
        let judged = Judged::of(quantity, &rows, relative);
        assert!(judged.within(tolerance) >= 0.95, "{quantity}: {:?}", judged.errors);
        // What the model of the signals lacks is in every interval; on benches that lack little they hold a little
        // more. A skew has a floor, and may hold always.
        let most = if quantity == Quantity::EngineSpeedSkew { 1.0 } else { 0.995 };
        assert!((0.9..=most).contains(&judged.coverage()), "{quantity}: {}", judged.coverage());
    }
}

#[test]
fn stat_the_four_parameters_of_the_default_bench_with_a_strong_engine() {
    let file = bench_file("0.6", "0.28", "400 Nm", BENCH_A);
    let bench = with_strong_engine(Drawn { parameters: BenchParameters::default(), file, speed_rpm: 1500.0 });
    let estimate = bench.inertias(28.0, 7);
    for quantity in [Quantity::Stiffness, Quantity::Damping, Quantity::DynoInertia, Quantity::EngineInertia] {
        let (found, truth) = (estimate.parameter(quantity).unwrap(), bench.truth(quantity));
        println!("{quantity}: {} ± {}, truth {truth}", found.value, found.standard_error);
        assert!((found.value - truth).abs() < 0.05 * truth, "{found:?}, truth {truth}");
        assert!(found.standard_error < 0.02 * truth, "{found:?}");
    }
}

/// Order 2 of 270 Nm upon a mean of 60 Nm, cycles apart by 3 %.
fn with_strong_engine(mut bench: Drawn) -> Drawn {
    bench.parameters.engine.firing_harmonics = vec![Harmonic { relative_amplitude: 4.5, phase_rad: 0.4 }];
    bench.parameters.engine.cycle_variation = 0.03;
    bench
}

#[test]
#[ignore = "slow: 40 benches"]
fn stat_all_four_parameters_with_a_strong_engine() {
    let rows = in_parallel(40, |i| {
        let bench = with_strong_engine(Drawn::new(3000 + i));
        let estimate = bench.inertias(28.0, i as u64);
        (bench, estimate)
    });
    for quantity in [Quantity::Stiffness, Quantity::Damping, Quantity::DynoInertia] {
        let judged = Judged::of(quantity, &rows, true);
        assert!(judged.within(0.05) == 1.0, "{quantity}: {:?}", judged.errors);
        assert!(judged.coverage() >= 0.85, "{quantity}: {}", judged.coverage());
    }
    let held = rows.iter().filter(|(_, estimate)| {
        let inertia = estimate.parameter(Quantity::EngineInertia).unwrap();
        inertia.standard_error < 0.05 * inertia.value
    });
    assert!(held.count() >= 38);
    let judged = Judged::of(Quantity::EngineInertia, &rows, true);
    assert!(judged.within(0.05) >= 0.95, "{:?}", judged.errors);
    assert!(judged.coverage() >= 0.85, "{}", judged.coverage());
}
