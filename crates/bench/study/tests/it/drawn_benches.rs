//! Whole studies of benches drawn over the class that dynoid is for: cylinders, delays and where they act, rasters,
//! skews, ripple, friction, and inertias that are not quite as stated.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use rig::BenchFile;
use rig::Severity;
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use rig::results::{DelayPlace, Outcome, Quantity};
use signal::excitation::Random;
use study::Study;
use virtual_bench::simulate;

use crate::recorded_bench::{found, kinds_of_alarms};
use crate::study::{source, studied};
use bench_testkit::benches::{bench_file, in_parallel};
use bench_testkit::recordings::BENCH_A;

/// Standard deviation of the stated inertias about the true ones.
const DYNO_INERTIA_ERROR: f64 = 0.008;
const ENGINE_INERTIA_ERROR: f64 = 0.015;

/// A bench drawn over the class, and what its user states of it.
struct Drawn {
    parameters: BenchParameters,
    file: BenchFile,
    speed_rpm: f64,
}

impl Drawn {
    fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut parameters = BenchParameters::default();
        draw_mechanics(&mut parameters, &mut random);
        draw_controller(&mut parameters, &mut random);
        draw_recording(&mut parameters, &mut random);
        let mut stated = |inertia: f64, error: f64| inertia * (1.0 + error * random.normal());
        let mechanics = &parameters.mechanics;
        let (dyno, engine) = (
            stated(mechanics.dyno_inertia_kg_m2, DYNO_INERTIA_ERROR),
            stated(mechanics.engine_inertia_kg_m2, ENGINE_INERTIA_ERROR),
        );
        let mut file = bench_file(&dyno.to_string(), &engine.to_string(), "400 Nm", BENCH_A);
        file.cylinders = parameters.engine.cylinder_factors.len() as u32;
        let speed_rpm = (1000.0 + 2000.0 * random.uniform()).round();
        Drawn { parameters, file, speed_rpm }
    }

    fn study(&self, seed: u64) -> Study {
        let plans = [
            ("BS_T_NT.mf4", ExperimentPlan::bs_t_nt(self.speed_rpm, 24.0)),
            ("WhiteNoise_T_TN.mf4", ExperimentPlan::white_noise_t_tn(self.speed_rpm, 24.0)),
            ("Levels_N_NT.mf4", ExperimentPlan::levels_n_nt(self.speed_rpm, 24.0)),
            ("Ramp_N_NT.mf4", ExperimentPlan::ramp_n_nt(self.speed_rpm, 24.0)),
        ];
        let recorded = |((file, plan), seed): (&(&str, ExperimentPlan), u64)| {
            source(file, Ok(simulate(&self.parameters, plan, seed).unwrap()))
        };
        studied(&self.file, plans.iter().zip(4 * seed..).map(recorded).collect())
    }

    fn truth(&self, quantity: Quantity) -> f64 {
        let BenchParameters { mechanics, controller, drive, clocks, .. } = &self.parameters;
        match quantity {
            Quantity::Stiffness => mechanics.shaft_stiffness_nm_per_rad,
            Quantity::Damping => mechanics.shaft_damping_nm_s_per_rad,
            Quantity::DynoInertia => mechanics.dyno_inertia_kg_m2,
            Quantity::EngineInertia => mechanics.engine_inertia_kg_m2,
            Quantity::EngineSpeedSkew => clocks.engine_speed_skew_s,
            Quantity::AirGapTorqueSkew => clocks.torque_skew_s,
            Quantity::ProportionalGain => controller.proportional_nm_s_per_rad,
            Quantity::IntegralGain => controller.integral_nm_per_rad,
            Quantity::ControllerDelay => controller.delay_s,
            Quantity::SpeedFeedForward => controller.speed_feed_forward_nm_s_per_rad,
            Quantity::AccelerationFeedForward => controller.acceleration_feed_forward_nm_s2_per_rad,
            Quantity::TorqueControlBandwidth => drive.bandwidth_rad_s,
            Quantity::TorqueControlDelay => drive.delay_s,
            _ => panic!("{quantity} has no truth"),
        }
    }
}

fn within(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * random.uniform()
}

/// One of several, each as likely.
fn one_of<T: Copy>(random: &mut Random, choices: &[T]) -> T {
    choices[((random.uniform() * choices.len() as f64) as usize).min(choices.len() - 1)]
}

fn draw_mechanics(parameters: &mut BenchParameters, random: &mut Random) {
    let mechanics = &mut parameters.mechanics;
    let (dyno, engine) = (within(random, 0.3, 1.2), within(random, 0.15, 0.45));
    let resonance_rad_s = TAU * within(random, 9.0, 28.0);
    let stiffness = resonance_rad_s * resonance_rad_s * dyno * engine / (dyno + engine);
    (mechanics.dyno_inertia_kg_m2, mechanics.engine_inertia_kg_m2) = (dyno, engine);
    mechanics.shaft_stiffness_nm_per_rad = stiffness;
    mechanics.shaft_damping_nm_s_per_rad = 2.0 * within(random, 0.05, 0.2) * stiffness / resonance_rad_s;
    mechanics.coulomb_friction_nm = within(random, 0.3, 1.5);
    mechanics.viscous_friction_nm_s_per_rad = within(random, 0.001, 0.02);
    let cylinders = one_of(random, &[3, 4, 6]);
    parameters.engine.cylinder_factors = (0..cylinders).map(|_| within(random, 0.9, 1.1)).collect();
    parameters.engine.cycle_variation = within(random, 0.005, 0.03);
}

fn draw_controller(parameters: &mut BenchParameters, random: &mut Random) {
    let inertia = parameters.mechanics.dyno_inertia_kg_m2 + parameters.mechanics.engine_inertia_kg_m2;
    let controller = &mut parameters.controller;
    controller.delay_s = one_of(random, &[0.001, 0.002, 0.003]);
    controller.delay_place =
        one_of(random, &[DelayPlace::MeasuredSpeed, DelayPlace::SpeedError, DelayPlace::WholeOutput]);
    controller.proportional_nm_s_per_rad = inertia * within(random, 0.8, 4.0);
    controller.integral_nm_per_rad = inertia * within(random, 1.0, 4.0);
    controller.speed_feed_forward_nm_s_per_rad = within(random, 0.004, 0.02);
    controller.acceleration_feed_forward_nm_s2_per_rad = -within(random, 0.02, 0.2);
    let drive = &mut parameters.drive;
    drive.delay_s = within(random, 0.8e-3, 1.5e-3);
    drive.bandwidth_rad_s = within(random, 400.0, 900.0);
    drive.additive_ripple_nm = within(random, 0.5, 1.6);
    drive.multiplicative_ripple = within(random, 0.01, 0.03);
}

fn draw_recording(parameters: &mut BenchParameters, random: &mut Random) {
    let clocks = &mut parameters.clocks;
    (clocks.engine_speed_decimation, clocks.torque_decimation) =
        one_of(random, &[(1, 4), (2, 4), (4, 4), (1, 10), (4, 10)]);
    clocks.engine_speed_skew_s = within(random, -1.5e-3, 1.5e-3);
    clocks.torque_skew_s = within(random, -0.8e-3, 0.8e-3);
    let sensors = &mut parameters.sensors;
    sensors.dyno_eccentricity = within(random, 0.0, 3e-4);
    sensors.engine_eccentricity = within(random, 0.0, 3e-4);
    sensors.speed_noise_rad_s = within(random, 0.01, 0.07) * units::RPM_RAD_S;
    sensors.calc_noise_nm = within(random, 0.05, 0.3);
}

const JUDGED: [Quantity; 11] = [
    Quantity::Stiffness,
    Quantity::Damping,
    Quantity::DynoInertia,
    Quantity::EngineSpeedSkew,
    Quantity::ProportionalGain,
    Quantity::IntegralGain,
    Quantity::ControllerDelay,
    Quantity::SpeedFeedForward,
    Quantity::AccelerationFeedForward,
    Quantity::TorqueControlDelay,
    Quantity::TorqueControlBandwidth,
];

/// One quantity over all benches.
#[derive(Default)]
struct Tally {
    estimated: usize,
    held: usize,
    largest_error: f64,
    half_widths: Vec<f64>,
}

impl Tally {
    fn of(quantity: Quantity, rows: &[(Drawn, Study)]) -> Self {
        let mut tally = Tally::default();
        for (seed, (bench, study)) in rows.iter().enumerate() {
            let Some(found) = found(study, quantity) else { continue };
            let truth = bench.truth(quantity);
            let holds = (found.interval.0..=found.interval.1).contains(&truth);
            tally.estimated += 1;
            tally.held += usize::from(holds);
            let error = (found.value / truth - 1.0).abs();
            tally.largest_error = tally.largest_error.max(error);
            tally.half_widths.push(0.5 * (found.interval.1 - found.interval.0) / truth.abs());
            let apart = (found.value - truth) / found.standard_error;
            if apart.abs() > 4.0 {
                println!(
                    "bench {seed}: {} is {:.4e}, truth {truth:.4e}, {apart:.1} standard errors",
                    quantity.symbol(),
                    found.value
                );
            }
        }
        tally.half_widths.sort_by(f64::total_cmp);
        tally
    }

    fn coverage(&self) -> f64 {
        self.held as f64 / self.estimated.max(1) as f64
    }

    fn print(&self, quantity: Quantity, benches: usize) {
        let median = self.half_widths.get(self.half_widths.len() / 2).copied().unwrap_or(f64::NAN);
        println!(
            "{:6} estimated on {:3} of {benches}, held {:5.1} %, largest error {:8.3} %, median half-width {:7.3} %",
            quantity.symbol(),
            self.estimated,
            100.0 * self.coverage(),
            100.0 * self.largest_error,
            100.0 * median
        );
    }
}

/// Studies with a warning or error of each kind.
fn alarms(rows: &[(Drawn, Study)]) -> BTreeMap<String, usize> {
    let mut alarms: BTreeMap<String, usize> = BTreeMap::new();
    for (bench, (_, study)) in rows.iter().enumerate() {
        let raised = study.diagnostics.iter().filter(|found| found.severity != Severity::Note);
        raised.for_each(|found| println!("bench {bench}: {:?}", found.finding));
        if let Outcome::NotEstimated { needs } = &study.torque_control {
            println!("bench {bench}: no torque control: {needs:?}");
        }
        kinds_of_alarms(&study.diagnostics).into_iter().for_each(|kind| *alarms.entry(kind).or_default() += 1);
    }
    alarms
}

/// Benches to draw, and from which seed on: thresholds were not chosen on these.
fn drawn() -> (usize, u64) {
    let of =
        |name: &str, otherwise: u64| std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(otherwise);
    (of("DYNOID_BENCHES", 200) as usize, of("DYNOID_FIRST_BENCH", 50_000))
}

#[test]
#[ignore = "slow: studies of 200 benches"]
fn stat_studies_of_benches_drawn_over_the_whole_class() {
    let (benches, first) = drawn();
    let rows: Vec<(Drawn, Study)> = in_parallel(benches, |i| {
        let bench = Drawn::new(first + i as u64);
        let study = bench.study(first + i as u64);
        (bench, study)
    });
    let tallies: Vec<(Quantity, Tally)> =
        JUDGED.iter().map(|quantity| (*quantity, Tally::of(*quantity, &rows))).collect();
    tallies.iter().for_each(|(quantity, tally)| tally.print(*quantity, benches));
    let without = |part: fn(&Study) -> bool| rows.iter().filter(|(_, study)| part(study)).count();
    println!("without a feed-forward: {}", without(|study| matches!(study.feed_forward, Outcome::NotEstimated { .. })));
    let alarms = alarms(&rows);
    println!("studies with a warning of each kind, of {benches} clean ones: {alarms:?}");
    for (quantity, tally) in &tallies {
        assert!(tally.coverage() >= 0.9, "{quantity}: {}", tally.coverage());
        assert!(10 * tally.estimated >= 9 * benches, "{quantity}: {}", tally.estimated);
    }
    for (kind, count) in alarms {
        assert!(50 * count <= benches, "{kind}: {count} of {benches}");
    }
}

/// T_d,calc at 100 Hz shows steps of T_d* every 10 ms always at the same age, so that delay and lag cannot be
/// separated. J_d and K were up to 10 % wrong, as T_d,calc was then taken for T_d between its samples.
#[test]
fn regress_steps_that_samples_see_at_one_age_leave_the_shaft_right() {
    let seed = 70_088;
    let bench = Drawn::new(seed);
    let study = bench.study(seed);
    // Neither is claimed. They are not estimated, or their intervals hold every drive of the class: whether samples
    // separate the two is itself decided by a test, in which the noise has a part.
    let says_nothing = |(quantity, largest): (Quantity, f64)| {
        found(&study, quantity).is_none_or(|one| one.interval.0 < 0.0 && one.interval.1 > largest)
    };
    let drawn = [(Quantity::TorqueControlDelay, 1.5e-3), (Quantity::TorqueControlBandwidth, 900.0)];
    assert!(drawn.into_iter().all(says_nothing));
    for quantity in [Quantity::Stiffness, Quantity::DynoInertia] {
        let (found, truth) = (found(&study, quantity).unwrap(), bench.truth(quantity));
        assert!((found.value / truth - 1.0).abs() < 0.005, "{found:?} {truth}");
        assert!((found.interval.0..=found.interval.1).contains(&truth), "{found:?} {truth}");
    }
    let warned: Vec<_> = study.diagnostics.iter().filter(|found| found.severity != Severity::Note).collect();
    assert!(warned.is_empty(), "{warned:?}");
}
