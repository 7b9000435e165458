//! Benches, what their users state of them, and what a study of their recordings finds.

use std::collections::{BTreeMap, BTreeSet};

use foreign_bench::campaign::{NAMES, campaign};
use foreign_bench::{Bench, Random, draw};
use numerics::parallel;
use rig::results::{Estimate, Quantity};
use rig::{BenchFile, Diagnostic, Severity};
use study::{Campaign, Prepared, Source, Study, run};

use crate::support::{RPM, drawn};

/// Standard deviations of the stated inertias about the true ones, relative.
const STATED: [f64; 2] = [0.008, 0.015];
/// Length of each recording, s.
const RECORDED_S: f64 = 24.0;

/// A bench and its study.
pub(crate) struct Known {
    pub(crate) seed: u64,
    pub(crate) bench: Bench,
    pub(crate) file: BenchFile,
    pub(crate) study: Study,
    /// Lowest speed of the recordings, rad/s.
    pub(crate) speed_rad_s: f64,
}

impl Known {
    /// The bench of a seed.
    pub(crate) fn of(seed: u64) -> Self {
        let bench = draw(seed);
        let mut random = Random::new(seed ^ 0x57a7_ed00);
        let file = bench_file(&bench, &mut random);
        let speed_rad_s = RPM * random.between(1000.0, 2600.0).round();
        let source = |(file, recording): (String, recording::Recording)| Source {
            sha256: format!("hash of {file}"),
            file,
            recording: Ok(recording),
        };
        let sources = campaign(&bench, speed_rad_s, RECORDED_S, seed).into_iter().map(source).collect();
        let recordings = Prepared::of(&file, sources, &work::Context::new());
        let campaign = Campaign { bench: &file, bench_file: ("bench.toml", "as written"), recordings, seed: Some(3) };
        let study = run(campaign, &work::Context::new()).unwrap();
        Known { seed, bench, file, study, speed_rad_s }
    }

    fn truth(&self, quantity: Quantity) -> f64 {
        let Bench { train, controller, drive, .. } = &self.bench;
        match quantity {
            Quantity::Stiffness => train.stiffness_nm_per_rad,
            Quantity::Damping => train.damping_nm_s_per_rad,
            Quantity::ProportionalGain => controller.proportional_nm_s_per_rad,
            Quantity::IntegralGain => controller.integral_nm_per_rad,
            Quantity::ControllerDelay => 1e-3 * controller.delay_ms as f64,
            Quantity::SpeedFeedForward => controller.speed_gain_nm_s_per_rad,
            Quantity::AccelerationFeedForward => controller.acceleration_gain_nm_s2_per_rad,
            Quantity::TorqueControlDelay => drive.delay_s,
            Quantity::TorqueControlBandwidth => drive.bandwidth_rad_s,
            _ => panic!("{quantity} has no truth"),
        }
    }
}

/// The bench file of a user who knows the inertias about well.
fn bench_file(bench: &Bench, random: &mut Random) -> BenchFile {
    let mut stated = |inertia: f64, error: f64| inertia * (1.0 + error * random.normal());
    let dyno = stated(bench.train.dyno_inertia_kg_m2, STATED[0]);
    let engine = stated(bench.train.engine_inertia_kg_m2, STATED[1]);
    let mut text = format!(
        "[bench]\nname = \"foreign\"\nvariant = \"load-cell\"\ncylinders = {}\ndynamometer_inertia = {dyno}\n\
         engine_inertia = {engine}\n[limits]\ntorque = \"{} Nm\"\n[channels]\n",
        bench.engine.cylinders.len(),
        bench.drive.limit_nm
    );
    for (key, name) in NAMES {
        text.push_str(&format!("{key} = \"{name}\"\n"));
    }
    text.parse().unwrap()
}

/// Quantities that are judged.
const JUDGED: [Quantity; 9] = [
    Quantity::Stiffness,
    Quantity::Damping,
    Quantity::ProportionalGain,
    Quantity::IntegralGain,
    Quantity::ControllerDelay,
    Quantity::TorqueControlDelay,
    Quantity::TorqueControlBandwidth,
    Quantity::SpeedFeedForward,
    Quantity::AccelerationFeedForward,
];

/// Value, interval and truth of a quantity that a study estimates.
fn found(known: &Known, quantity: Quantity) -> Option<(f64, (f64, f64), f64)> {
    let study = &known.study;
    let estimates: [Option<&Estimate>; 4] = [
        study.shaft.estimated().map(|part| &part.estimate),
        study.speed_controller.estimated().map(|part| &part.estimate),
        study.feed_forward.estimated().map(|part| &part.estimate),
        study.torque_control.estimated().map(|part| &part.delay_and_lag),
    ];
    let parameter = estimates.into_iter().flatten().find_map(|estimate| estimate.parameter(quantity))?;
    Some((parameter.value, parameter.interval, known.truth(quantity)))
}

/// Returns for each quantity whether its interval holds the truth; prints those that do not.
fn held(seed: u64, known: &Known) -> Vec<Option<bool>> {
    let one = |quantity: &Quantity| {
        let (value, (low, high), truth) = found(known, *quantity)?;
        let holds = (low..=high).contains(&truth);
        if !holds {
            println!("bench {seed}: {} is {value:.5} ({low:.5} … {high:.5}), truth {truth:.5}", quantity.symbol());
        }
        Some(holds)
    };
    JUDGED.iter().map(one).collect()
}

/// Kinds of the warnings and errors, none of which is true of these benches; prints them.
fn alarms(seed: u64, known: &Known) -> BTreeSet<String> {
    let raised = known.study.diagnostics.iter().filter(|found| found.severity != Severity::Note);
    let kind = |found: &Diagnostic| {
        let words = format!("{:?}", found.finding);
        println!("bench {seed}: {:?} {words}", found.place);
        words.split([' ', '{', '(']).next().unwrap_or_default().to_owned()
    };
    raised.map(kind).collect()
}

#[test]
fn stat_a_study_finds_a_bench_of_the_other_simulator() {
    let known = Known::of(101);
    held(101, &known);
    for quantity in JUDGED {
        // Nine intervals of 95 % all hold on two benches of three alone.
        let (value, (low, high), truth) = found(&known, quantity).unwrap();
        assert!((value - truth).abs() < 1.5 * 0.5 * (high - low), "{quantity}: {value}, {low} … {high}, truth {truth}");
    }
    alarms(101, &known);
}

#[test]
#[ignore = "slow: 80 studies"]
fn stat_studies_hold_benches_of_the_other_simulator() {
    let seeds = drawn(80, 70_000);
    let rows = parallel::map(&seeds, |seed| {
        let known = Known::of(*seed);
        (held(*seed, &known), alarms(*seed, &known))
    });
    let mut counts: BTreeMap<&String, usize> = BTreeMap::new();
    rows.iter().flat_map(|(_, alarms)| alarms).for_each(|kind| *counts.entry(kind).or_default() += 1);
    println!("studies with an alarm of each kind, of {} clean ones: {counts:?}", rows.len());
    for (place, quantity) in JUDGED.iter().enumerate() {
        let estimated: Vec<bool> = rows.iter().filter_map(|(held, _)| held[place]).collect();
        let held = estimated.iter().filter(|held| **held).count();
        println!("{:6} estimated on {} of {}, held on {held}", quantity.symbol(), estimated.len(), rows.len());
    }
}
