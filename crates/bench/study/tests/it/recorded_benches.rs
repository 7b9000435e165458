//! Recorded benches whose truth is known: whether intervals hold the truth, which alarms are raised where nothing is
//! wrong, and which where a torque or a clock is. The simulator of the recordings shares no code with the project.

use std::collections::BTreeMap;

use part_torque::torque_control;
use recording::Recording;
use rig::Severity;
use rig::results::Quantity;
use study::{Source, Study, experiment_of};

use crate::recorded_bench::{RecordedBench, found, kinds_of_alarms};
use crate::study::{source, studied};
use bench_testkit::benches::in_parallel;

const JUDGED: [Quantity; 9] = [
    Quantity::Stiffness,
    Quantity::Damping,
    Quantity::ProportionalGain,
    Quantity::IntegralGain,
    Quantity::ControllerDelay,
    Quantity::SpeedFeedForward,
    Quantity::AccelerationFeedForward,
    Quantity::TorqueControlDelay,
    Quantity::TorqueControlBandwidth,
];
/// Benches of one kind of structure, drawn at random.
const DRAWN: [u32; 2] = [200, 215];

/// The benches whose names are given, else these.
fn benches(usual: &[String]) -> Vec<RecordedBench> {
    let named = std::env::var("DYNOID_BENCHES").map(|names| names.split(',').map(str::to_owned).collect());
    let names: Vec<String> = named.unwrap_or_else(|_| usual.to_vec());
    names.iter().filter_map(|name| RecordedBench::of(name)).collect()
}

fn drawn() -> Vec<RecordedBench> {
    let names: Vec<String> = (DRAWN[0]..=DRAWN[1]).map(|number| format!("drawn/bench-{number}")).collect();
    benches(&names)
}

fn study_of(bench: &RecordedBench) -> Study {
    let sources = bench.recordings.iter().map(|(file, recording)| source(file, Ok(recording.clone()))).collect();
    studied(&bench.file, sources)
}

#[test]
#[ignore = "slow: studies of sixteen benches"]
fn stat_intervals_hold_the_truth_of_recorded_benches_without_an_alarm() {
    let benches = drawn();
    let studies = in_parallel(benches.len(), |i| study_of(&benches[i]));
    let mut raised: BTreeMap<String, usize> = BTreeMap::new();
    for (bench, study) in benches.iter().zip(&studies) {
        for one in study.diagnostics.iter().filter(|one| one.severity != Severity::Note) {
            println!("{}: {one:?}", bench.name);
        }
        kinds_of_alarms(&study.diagnostics).into_iter().for_each(|kind| *raised.entry(kind).or_default() += 1);
    }
    let mut short = Vec::new();
    for quantity in JUDGED {
        let widths = |(bench, study): (&RecordedBench, &Study)| {
            let widths = bench.half_widths_off(found(study, quantity)?);
            if widths.abs() > 1.0 {
                println!("{}: {} is off by {widths:+.2} half widths", bench.name, quantity.symbol());
            }
            Some(widths)
        };
        let widths: Vec<f64> = benches.iter().zip(&studies).filter_map(widths).collect();
        let held = widths.iter().filter(|widths| widths.abs() <= 1.0).count();
        let square = widths.iter().map(|widths| widths * widths).sum::<f64>() / widths.len().max(1) as f64;
        let of = widths.len();
        println!("{:6} held on {held} of {of}, off by {:.2} half widths (rms)", quantity.symbol(), square.sqrt());
        // Of 16 intervals of 95 % four miss once in a hundred cases. B of bench 214 is off by 2.0 half widths, for
        // which no cause is known.
        if held + 3 < of || widths.iter().any(|widths| widths.abs() > 2.5) {
            short.push(quantity.symbol());
        }
    }
    println!("benches with an alarm of each kind, of {}: {raised:?}", benches.len());
    assert!(short.is_empty(), "{short:?}");
    assert!(raised.values().all(|count| 50 * count <= benches.len()), "{raised:?}");
}

/// Findings about samples, clocks and torques that no structure of a bench excuses.
const OF_DAMAGE: [&str; 8] = [
    "SamplesRepeated",
    "SamplesFiltered",
    "Spikes",
    "ClockDrift",
    "ClockRate",
    "PulsesOffSpeed",
    "FiringOrderDisagrees",
    "TorquesDisagree",
];

/// Benches that differ in one thing of their structure.
#[test]
#[ignore = "slow: studies of eleven benches"]
fn stat_benches_of_another_structure_are_not_called_damaged() {
    let folder = testdata::shared("recordings/kinds");
    let entries = folder.into_iter().flat_map(|folder| std::fs::read_dir(folder).unwrap().flatten());
    let mut names: Vec<String> =
        entries.map(|entry| format!("kinds/{}", entry.file_name().to_string_lossy())).collect();
    names.sort();
    let benches = benches(&names);
    let studies = in_parallel(benches.len(), |i| study_of(&benches[i]));
    for (bench, study) in benches.iter().zip(&studies) {
        let off = JUDGED.iter().filter_map(|quantity| {
            let widths = bench.half_widths_off(found(study, *quantity)?);
            (widths.abs() > 1.0).then(|| format!("{} {widths:+.1}", quantity.symbol()))
        });
        println!("{}: off by half widths: {:?}", bench.name, off.collect::<Vec<_>>());
        for one in study.diagnostics.iter().filter(|one| one.severity != Severity::Note) {
            println!("{}: {one:?}", bench.name);
        }
        let untrue: Vec<String> =
            kinds_of_alarms(&study.diagnostics).into_iter().filter(|kind| OF_DAMAGE.contains(&kind.as_str())).collect();
        assert!(untrue.is_empty(), "{}: {untrue:?}", bench.name);
    }
}

/// A damage of one size.
struct Damage {
    name: String,
    apply: Box<dyn Fn(&mut Recording) + Sync>,
    /// Kinds of findings that name it.
    causes: &'static [&'static str],
    /// True where it has to be named.
    is_large: bool,
}

fn scale(channel: &'static str, percent: f64) -> Damage {
    let apply = move |recording: &mut Recording| {
        let of = recording.channels.iter_mut().filter(|one| one.name == channel);
        of.flat_map(|one| &mut one.samples).for_each(|x| *x *= 1.0 + 0.01 * percent);
    };
    Damage {
        name: format!("{channel} +{percent} %"),
        apply: Box::new(apply),
        causes: &["TorquesDisagree", "RoutesDisagree"],
        is_large: percent >= 10.0,
    }
}

fn drift(channel: &'static str, ppm: f64) -> Damage {
    let apply = move |recording: &mut Recording| {
        let raster = recording.channels.iter().find(|one| one.name == channel).map(|one| one.raster).unwrap();
        recording.rasters[raster].time_s.iter_mut().for_each(|t| *t *= 1.0 + 1e-6 * ppm);
    };
    let name = format!("clock of {channel} {ppm} ppm");
    Damage { name, apply: Box::new(apply), causes: &["ClockDrift"], is_large: ppm >= 500.0 }
}

/// The kinds of alarms that a campaign raises before its shaft is estimated: on opening the recordings, and in the
/// torque control.
fn early_alarms(bench: &RecordedBench, damage: &Damage) -> Vec<String> {
    let of = |(file, recording): &(String, Recording)| {
        let mut damaged = recording.clone();
        (damage.apply)(&mut damaged);
        let source = Source { file: file.clone(), sha256: file.clone(), recording: Ok(damaged) };
        let (experiment, mut raised) = experiment_of(&bench.file, &source).unwrap();
        if file.starts_with("White") {
            let fit = torque_control::estimate_unseparated(&experiment, bench.file.limits.torque_nm);
            raised.extend(fit.into_iter().flat_map(|(fit, _)| fit.diagnostics));
        }
        raised
    };
    kinds_of_alarms(&bench.recordings.iter().flat_map(of).collect::<Vec<_>>())
}

/// How often errors in the scale of a torque and in a clock are named, and how often where there are none.
#[test]
#[ignore = "slow: sixteen benches with sixteen damages each"]
fn stat_errors_of_torques_and_clocks_are_named() {
    let benches = drawn();
    let mut damages = vec![Damage { name: "none".to_owned(), apply: Box::new(|_| {}), causes: &[], is_large: false }];
    for channel in ["DynoTorqueCalc", "DynoTorqueMeas"] {
        damages.extend([2.0, 5.0, 10.0].map(|percent| scale(channel, percent)));
    }
    for channel in ["EngineSpeed", "DynoTorqueCalc"] {
        // Where one raster has both, its clock is that of N_d.
        damages.extend([20.0, 100.0, 500.0].map(|ppm| drift(channel, ppm)));
    }
    for damage in &damages {
        let raised = in_parallel(benches.len(), |i| early_alarms(&benches[i], damage));
        let is_named = |kinds: &&Vec<String>| kinds.iter().any(|kind| damage.causes.contains(&kind.as_str()));
        let named = raised.iter().filter(is_named).count();
        let mut counts: BTreeMap<&String, usize> = BTreeMap::new();
        raised.iter().flatten().for_each(|kind| *counts.entry(kind).or_default() += 1);
        println!("{}: named on {named} of {}; {counts:?}", damage.name, benches.len());
        assert!(damage.name != "none" || counts.is_empty(), "{counts:?}");
        // At 100 Hz the drive's ripple folds to rest, and looks like a gain.
        assert!(!damage.is_large || 4 * named >= 3 * benches.len(), "{}: {named}", damage.name);
    }
}
