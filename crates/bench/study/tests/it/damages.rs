//! Studies of damaged recordings of one virtual campaign: a study refuses them, names the cause, warns, or is right all
//! the same. It is never wrong without a word.

mod matrix;
mod table;
mod work;

use std::collections::BTreeSet;

use recording::Recording;
use rig::bench_parameters::{BenchParameters, ClockParameters, MechanicsParameters};
use rig::experiment::ExperimentPlan;
use rig::results::{Estimate, Quantity};
use rig::{BenchFile, Finding, Severity};
use study::{Campaign, Prepared, Source, Study, run};
use virtual_bench::{Truth, simulate};

use bench_testkit::benches::{bench_file, default_bench, in_parallel};
use bench_testkit::recordings::{BENCH_A, recordings};
use table::damages;

/// Files that a user brings: a bench file and recordings.
#[derive(Clone)]
pub(crate) struct Brought {
    pub(crate) bench: BenchFile,
    pub(crate) recordings: Vec<(String, Recording)>,
}

/// A way in which they may be wrong.
pub(crate) struct Damage {
    pub(crate) name: String,
    pub(crate) apply: Box<dyn Fn(&mut Brought) + Sync>,
    /// Findings that name the cause.
    pub(crate) causes: &'static [&'static str],
    /// Why the recordings cannot show it, where they cannot.
    pub(crate) hidden: Option<&'static str>,
}

fn parameters() -> BenchParameters {
    let mechanics = MechanicsParameters {
        coulomb_friction_nm: 0.8,
        viscous_friction_nm_s_per_rad: 0.01,
        ..MechanicsParameters::default()
    };
    let clocks = ClockParameters { engine_speed_skew_s: 3e-4, torque_skew_s: -2e-4, ..ClockParameters::default() };
    BenchParameters { mechanics, clocks, ..BenchParameters::default() }
}

fn brought() -> Brought {
    let plans = [
        ExperimentPlan::bs_t_nt(1230.0, 20.0),
        ExperimentPlan::white_noise_t_tn(1230.0, 20.0),
        ExperimentPlan::levels_n_nt(1230.0, 20.0),
        ExperimentPlan::ramp_n_nt(1230.0, 16.0),
        ExperimentPlan::step_t_tn(1230.0, 12.0),
        ExperimentPlan::no_shaft_n_nt(1230.0, 18.0),
    ];
    let recorded = in_parallel(plans.len(), |i| {
        (format!("{}_1230.mf4", plans[i].label), simulate(&parameters(), &plans[i], 11 + i as u64).unwrap())
    });
    Brought { bench: default_bench(), recordings: recorded }
}

fn study_of(brought: &Brought) -> Option<Study> {
    let source = |(file, recording): &(String, Recording)| Source {
        file: file.clone(),
        sha256: format!("hash of {file}"),
        recording: Ok(recording.clone()),
    };
    let recordings =
        Prepared::of(&brought.bench, brought.recordings.iter().map(source).collect(), &::work::Context::new());
    let campaign = Campaign { bench: &brought.bench, bench_file: ("bench.toml", "as written"), recordings, seed: None };
    run(campaign, &::work::Context::new()).ok()
}

fn truth(quantity: Quantity) -> Option<f64> {
    let (parameters, truth) = (parameters(), Truth::of(&parameters()));
    let BenchParameters { mechanics, clocks, drive, .. } = &parameters;
    Some(match quantity {
        Quantity::Stiffness => truth.stiffness_nm_per_rad,
        Quantity::Damping => truth.damping_nm_s_per_rad,
        Quantity::DynoInertia => mechanics.dyno_inertia_kg_m2,
        Quantity::EngineSpeedSkew => clocks.engine_speed_skew_s,
        Quantity::ProportionalGain => truth.proportional_nm_s_per_rad,
        Quantity::IntegralGain => truth.integral_nm_per_rad,
        Quantity::ControllerDelay => truth.controller_delay_s,
        Quantity::SpeedFeedForward => truth.speed_feed_forward_nm_s_per_rad,
        Quantity::AccelerationFeedForward => truth.acceleration_feed_forward_nm_s2_per_rad,
        Quantity::TorqueControlBandwidth => drive.bandwidth_rad_s,
        Quantity::TorqueControlDelay => drive.delay_s,
        Quantity::ResonanceFrequency => truth.resonance_hz,
        _ => return None,
    })
}

/// A value is clearly wrong beyond so many half widths of its interval, ...
const WRONG_HALF_WIDTHS: f64 = 1.6;
/// ... and beyond so large a part of itself, ...
const WRONG_PART: f64 = 0.01;
/// ... or, of a time, beyond so many s.
const WRONG_S: f64 = 6e-5;

/// Values of a study that miss the truth.
fn misses(study: &Study) -> Vec<String> {
    let shaft = study.shaft.estimated().map(|part| &part.estimate);
    let controller = study.speed_controller.estimated().map(|part| &part.estimate);
    let feed_forward = study.feed_forward.estimated().map(|part| &part.estimate);
    let torque_control = study.torque_control.estimated().map(|part| &part.delay_and_lag);
    let estimates: [Option<&Estimate>; 4] = [shaft, controller, feed_forward, torque_control];
    let resonance = study.whole.estimated().map(|whole| &whole.resonance_hz);
    let all = estimates.into_iter().flatten().flat_map(|estimate| &estimate.parameters).chain(resonance);
    let wrong = all.filter_map(|found| {
        let truth = truth(found.quantity)?;
        let error = (found.value - truth).abs();
        let half_width = 0.5 * (found.interval.1 - found.interval.0);
        let least = if found.quantity.notation().unit == "s" { WRONG_S } else { WRONG_PART * truth.abs() };
        let words = format!("{} {:.4e} ± {half_width:.1e} for {truth:.4e}", found.quantity.symbol(), found.value);
        (error > WRONG_HALF_WIDTHS * half_width && error > least).then_some(words)
    });
    wrong.collect()
}

/// The name of a kind of finding.
fn kind(finding: &Finding) -> String {
    let words = format!("{finding:?}");
    words.split([' ', '{', '(']).next().unwrap_or_default().to_owned()
}

/// A finding without its numbers: kind, file and channel.
fn place(found: &rig::Diagnostic) -> String {
    let or_none = |part: &Option<String>| part.clone().unwrap_or_default();
    format!("{} {} {}", kind(&found.finding), or_none(&found.place.file), or_none(&found.place.channel))
}

/// The findings of a study.
fn places(study: &Study) -> BTreeSet<String> {
    study.diagnostics.iter().map(place).collect()
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Outcome {
    Refused,
    Named,
    Warned,
    Harmless,
    Hidden,
    Wrong,
}

/// Outcome of a study of a damage, with the findings that are new and the values that miss the truth.
fn outcome(damage: &Damage, clean: &BTreeSet<String>, study: Option<&Study>) -> (Outcome, Vec<String>, Vec<String>) {
    let Some(study) = study else { return (Outcome::Refused, Vec::new(), Vec::new()) };
    let misses = misses(study);
    let new = study.diagnostics.iter().filter(|found| !clean.contains(&place(found)));
    let new: Vec<&rig::Diagnostic> = new.collect();
    let mut kinds: Vec<String> = new.iter().map(|found| kind(&found.finding)).collect();
    kinds.sort();
    kinds.dedup();
    let named = new.iter().filter(|found| damage.causes.contains(&kind(&found.finding).as_str()));
    let outcome = match named.map(|found| found.severity).max() {
        Some(Severity::Error) => Outcome::Refused,
        Some(_) => Outcome::Named,
        None if new.iter().any(|found| found.severity != Severity::Note) => Outcome::Warned,
        None if misses.is_empty() => Outcome::Harmless,
        None if damage.hidden.is_some() => Outcome::Hidden,
        None => Outcome::Wrong,
    };
    (outcome, kinds, misses)
}

#[test]
#[ignore = "slow: a study for each damage"]
fn stat_no_damage_leads_to_a_wrong_number_without_a_word() {
    let clean = brought();
    let of_clean = study_of(&clean).unwrap();
    assert_eq!(misses(&of_clean), Vec::<String>::new());
    let usual = places(&of_clean);
    println!("without damage: {usual:?}");
    let wanted = std::env::var("DYNOID_DAMAGES").unwrap_or_default();
    let mut damages = damages();
    damages.retain(|damage| wanted.split(',').any(|part| damage.name.contains(part)));
    let outcomes = in_parallel(damages.len(), |i| {
        let mut damaged = clean.clone();
        (damages[i].apply)(&mut damaged);
        let study = study_of(&damaged);
        if !wanted.is_empty() {
            study.iter().flat_map(|study| &study.diagnostics).for_each(|found| println!("    {found:?}"));
        }
        let (outcome, kinds, misses) = outcome(&damages[i], &usual, study.as_ref());
        println!("{outcome:?} | {} | {} | {}", damages[i].name, kinds.join(" "), misses.join("; "));
        outcome
    });
    let mut wrong = Vec::new();
    for (damage, outcome) in damages.iter().zip(&outcomes) {
        if *outcome == Outcome::Wrong {
            wrong.push(damage.name.as_str());
        }
        if *outcome == Outcome::Hidden {
            println!("{}: {}", damage.name, damage.hidden.unwrap_or_default());
        }
    }
    let count = |wanted: Outcome| outcomes.iter().filter(|outcome| **outcome == wanted).count();
    use Outcome::{Harmless, Hidden, Named, Refused, Warned};
    println!("of {}: {:?}", outcomes.len(), [Refused, Named, Warned, Harmless, Hidden].map(|o| (o, count(o))));
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Kinds of findings that name a damage.
const OF_DAMAGE: [&str; 12] = [
    "SamplesRaised",
    "SamplesRepeated",
    "SamplesStraightened",
    "Spikes",
    "SamplesFiltered",
    "TorquesDisagree",
    "LabelContradicted",
    "FiringOrderDisagrees",
    "PulsesOffSpeed",
    "ClockRate",
    "LateSignal",
    "SlowRaster",
];

/// Benches of a simulator that shares no code with the project: J_d, J_e, cylinders, channels.
const SIMULATED_ELSEWHERE: [(&str, &str, &str, u32, [&str; 7]); 10] = [
    ("bench-a", "0.6", "0.28", 4, BENCH_A),
    ("bench-b", "0.41", "0.19", 4, BENCH_B),
    ("drawn/bench-200", "0.5163", "0.2388", 4, BENCH_A),
    ("drawn/bench-201", "0.3036", "0.4420", 3, BENCH_A),
    ("drawn/bench-202", "1.1714", "0.3637", 6, BENCH_A),
    ("drawn/bench-203", "0.8509", "0.3090", 4, BENCH_A),
    ("drawn/bench-204", "0.2889", "0.4217", 4, BENCH_A),
    ("drawn/bench-205", "1.0298", "0.2256", 3, BENCH_A),
    ("drawn/bench-206", "0.8262", "0.2758", 6, BENCH_A),
    ("drawn/bench-207", "0.4258", "0.1864", 4, BENCH_A),
];
const BENCH_B: [&str; 7] =
    ["nBremse", "nMotor", "nBremse_Soll", "MdBremse_Soll", "MdLuftspalt", "MdKraftdose", "MdWelle"];

#[test]
#[ignore = "slow: studies of ten benches"]
fn stat_no_damage_is_named_where_there_is_none() {
    for (bench, dyno, engine, cylinders, names) in SIMULATED_ELSEWHERE {
        let recordings = recordings(bench);
        if recordings.is_empty() {
            continue;
        }
        let file = BenchFile { cylinders, ..bench_file(dyno, engine, "400 Nm", names) };
        let study = study_of(&Brought { bench: file, recordings }).unwrap();
        let of_damage = |found: &&rig::Diagnostic| OF_DAMAGE.contains(&kind(&found.finding).as_str());
        let alarms: Vec<_> = study.diagnostics.iter().filter(of_damage).collect();
        println!("{bench}: {:?}", places(&study));
        assert!(alarms.is_empty(), "{bench}: {alarms:#?}");
    }
}
