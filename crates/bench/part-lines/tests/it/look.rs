//! Lines of simulated recordings, whose causes are known, and what they are named.

mod labelled;
mod recorded;

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use part_lines::lines::{Cause, OverSpeed, RecordingLines, TURNS, find_lines, over_speed};
use rig::bench_parameters::BenchParameters;
use rig::experiment::{ExperimentPlan, Waveform};
use rig::{Role, prepare};
use units::RPM_RAD_S;
use virtual_bench::{HiddenTruth, Numerics, simulate, simulate_hidden};

use faer::c64;

use bench_testkit::benches::default_bench;
use labelled::{Drawn, KINDS, Labelled};

/// Recordings, and the first seed; `LOOK_RECORDINGS` and `LOOK_FIRST_SEED` draw others.
const RECORDINGS: u64 = 12;
const FIRST_SEED: u64 = 0;
/// The share of their lines that has to be named rightly.
const RIGHT: f64 = 0.95;
/// The share of them that may stay undecided.
const UNDECIDED: f64 = 0.2;
/// Undecided lines of a recording whose advice is followed.
const REPEATED: usize = 2;

/// Tally of the lines of some recordings.
#[derive(Default)]
struct Tally {
    /// Lines by true kind, named kind, and whether that is right.
    lines: BTreeMap<(&'static str, &'static str, bool), usize>,
    /// Undecided lines of which a repetition at the speed that is advised was simulated, and those that it decided.
    repeated: usize,
    decided: usize,
}

impl Tally {
    fn of(seed: u64) -> Self {
        let mut tally = Tally::default();
        let drawn = Drawn::new(seed);
        let labelled = Labelled::new(drawn.clone());
        let mut advised = Vec::new();
        for (part, signal, line) in labelled.lines() {
            let judged = labelled.judge(part, signal, line);
            *tally.lines.entry((judged.truth, judged.named, judged.is_right)).or_default() += 1;
            if !judged.is_right {
                let label = &labelled.look.label;
                let speed_rpm = part.speed_rad_s / RPM_RAD_S;
                let (role, rate_hz) = (signal.role, 1.0 / signal.sample_time_s);
                println!("{seed} {label} {speed_rpm:.0} rpm {role:?} at {rate_hz:.0} Hz, {}: {line:.3?}", judged.truth);
                println!("     {:.3?}, {:.3?} demanded", judged.causes, part.demanded_hz);
            }
            if let Cause::Undecided { between, repeat_at_rpm: Some(rpm) } = &line.cause
                && judged.is_right
            {
                advised.push((signal.role, between.clone(), *rpm));
            }
        }
        for (role, between, rpm) in advised.into_iter().take(REPEATED).filter(|_| drawn.has_one_speed()) {
            let is_decided = is_decided(&drawn.at_rpm(rpm).look(), role, &between);
            (tally.repeated, tally.decided) = (tally.repeated + 1, tally.decided + usize::from(is_decided));
            if !is_decided {
                println!("{seed} {} {role:?} at {rpm} rpm does not decide {between:?}", labelled.look.label);
            }
        }
        tally
    }

    fn add(mut self, other: Tally) -> Self {
        other.lines.into_iter().for_each(|(key, count)| *self.lines.entry(key).or_default() += count);
        (self.repeated, self.decided) = (self.repeated + other.repeated, self.decided + other.decided);
        self
    }

    fn count(&self, is_meant: impl Fn(&str, &str, bool) -> bool) -> usize {
        self.lines.iter().filter(|((truth, named, right), _)| is_meant(truth, named, *right)).map(|(_, n)| n).sum()
    }

    /// Prints the names that each true kind got: a row a kind; undecided lines apart by whether that is right.
    fn print(&self) {
        println!("{:>16} {}", "", KINDS.map(|k| format!("{k:>16}")).join(""));
        for truth in KINDS {
            let cell = |named: &str| match (self.count(|t, n, r| t == truth && n == named && r), named) {
                (right, "undecided") => {
                    format!("{right} + {} wrong", self.count(|t, n, r| t == truth && n == named && !r))
                }
                (right, _) => {
                    let wrong = self.count(|t, n, r| t == truth && n == named && !r);
                    if truth == named { format!("{right} ({wrong})") } else { format!("{}", right + wrong) }
                }
            };
            println!("{truth:>16} {}", KINDS.map(|named| format!("{:>16}", cell(named))).join(""));
        }
    }
}

/// Tells whether no two of these are undecided between each other in a signal.
fn is_decided(look: &RecordingLines, role: Role, between: &[Cause]) -> bool {
    let signals = look.parts.iter().flat_map(|part| &part.signals).filter(|signal| signal.role == role);
    signals.flat_map(|signal| &signal.lines).all(|line| match &line.cause {
        Cause::Undecided { between: still, .. } => {
            between.iter().filter(|cause| still.iter().any(|s| is_same(s, cause))).count() < 2
        }
        _ => true,
    })
}

/// Tells whether two causes are one, at whichever speed.
fn is_same(a: &Cause, b: &Cause) -> bool {
    let order = |cause: &Cause| match cause {
        Cause::Order { order, .. } | Cause::FoldedOrder { order, .. } => Some(*order),
        _ => None,
    };
    match (order(a), order(b)) {
        (Some(a), Some(b)) => a == b,
        _ => std::mem::discriminant(a) == std::mem::discriminant(b),
    }
}

#[test]
#[ignore = "slow: simulated recordings"]
fn stat_lines_are_named_by_what_made_them() {
    let number = |name: &str, usual: u64| std::env::var(name).map_or(usual, |n| n.parse().unwrap());
    let first = number("LOOK_FIRST_SEED", FIRST_SEED);
    let last = first + number("LOOK_RECORDINGS", RECORDINGS);
    let half = |start: u64| (start..last).step_by(2).map(Tally::of).fold(Tally::default(), Tally::add);
    let tally = std::thread::scope(|scope| {
        let work = [first, first + 1].map(|start| scope.spawn(move || half(start)));
        work.into_iter().map(|half| half.join().unwrap()).fold(Tally::default(), Tally::add)
    });
    tally.print();
    let (right, all) = (tally.count(|_, _, right| right), tally.count(|_, _, _| true));
    let undecided = tally.count(|_, named, _| named == "undecided");
    println!(
        "{right} of {all} right, {undecided} undecided; {} of {} repetitions decide",
        tally.decided, tally.repeated
    );
    assert!(right as f64 >= RIGHT * all as f64, "{right} of {all}");
    assert!((undecided as f64) < UNDECIDED * all as f64, "{undecided} of {all} undecided");
}

#[test]
fn exact_what_a_demanded_sine_leaves_is_named() {
    let mut parameters = BenchParameters::default();
    parameters.clocks.torque_decimation = 1;
    let mut plan = ExperimentPlan::sine_t_tn(1230.0, 12.0);
    plan.dyno_torque_nm = Waveform::SineLadder { mean: 60.0, amplitude: 8.0, frequencies_hz: vec![8.0], dwell_s: 12.0 };
    let seen = |parameters: &BenchParameters| {
        let recording = simulate(parameters, &plan, 1).unwrap();
        let (experiment, _) = prepare("run.mf4", &recording, &default_bench(), plan.label.clone()).unwrap();
        find_lines(&experiment, &default_bench())
    };
    let at = |look: &RecordingLines, role: Role, hz: f64| {
        let signal = look.parts[0].signals.iter().find(|s| s.role == role).unwrap();
        signal.lines.iter().find(|l| (l.frequency_hz - hz).abs() < 0.1).map(|l| l.cause.clone())
    };
    let held = seen(&parameters);
    assert_eq!(at(&held, Role::DynoTorqueDemand, 8.0), Some(Cause::Demanded));
    for hz in [92.0, 108.0] {
        let image = Cause::HoldImage { of_hz: 8.0, held_hz: 100.0 };
        let (demand, torque) = (at(&held, Role::DynoTorqueDemand, hz), at(&held, Role::AirGapTorque, hz));
        for cause in [demand, torque] {
            assert!(
                matches!(cause, Some(Cause::HoldImage { of_hz, .. }) if (of_hz - 8.0).abs() < 0.01),
                "{hz}: {cause:?}, not {image:?}"
            );
        }
    }
    assert_eq!(at(&held, Role::AirGapTorque, 100.0), Some(Cause::Mains { multiple: 2, mains_hz: 50.0 }));
    assert_eq!(at(&held, Role::EngineSpeed, 41.0), Some(Cause::Order { order: 2.0, is_firing: true }));
    // A demand that follows at once has no images: what is left at 100 ± 8 Hz is the ripple's.
    parameters.controller.demand_hold_s = 1e-3;
    let quick = seen(&parameters);
    assert_eq!(at(&quick, Role::DynoTorqueDemand, 92.0), None);
    let cause = at(&quick, Role::AirGapTorque, 92.0);
    assert!(matches!(cause, Some(Cause::RippleSideband { .. })), "{cause:?}");
}

#[test]
fn exact_what_folds_onto_the_ripple_is_undecided_and_parted_at_another_speed() {
    let causes = |speed_rpm: f64| {
        let mut plan = ExperimentPlan::bs_t_nt(speed_rpm, 12.0);
        plan.engine_torque_nm = Waveform::Constant { value: 45.0 };
        let recording = simulate(&BenchParameters::default(), &plan, 1).unwrap();
        let (experiment, _) = prepare("run.mf4", &recording, &default_bench(), plan.label.clone()).unwrap();
        let look = find_lines(&experiment, &default_bench());
        let signal = look.parts[0].signals.iter().find(|s| s.role == Role::AirGapTorque).unwrap().clone();
        signal.lines.into_iter().filter(|l| (l.frequency_hz - 100.0).abs() < 0.2).map(|l| l.cause).collect::<Vec<_>>()
    };
    let Some(Cause::Undecided { between, repeat_at_rpm: Some(rpm) }) = causes(3000.0).into_iter().next() else {
        panic!("{:?}", causes(3000.0));
    };
    assert!(between.contains(&Cause::Mains { multiple: 2, mains_hz: 50.0 }), "{between:?}");
    assert_eq!(causes(rpm), [Cause::Mains { multiple: 2, mains_hz: 50.0 }]);
}

/// Amplitude of an order of T_shaft about an instant as it really is: its Fourier coefficient over the true crank
/// angle, as computed order tracking has it after resampling, through the same window.
fn true_amplitude(hidden: &HiddenTruth, angle: &[f64], order: f64, time_s: f64) -> f64 {
    let middle = angle[(time_s / hidden.sample_time_s) as usize];
    let place = |k: usize| (angle[k] - middle) / (TAU * TURNS);
    let inside: Vec<usize> = (1..angle.len()).filter(|k| place(*k).abs() < 0.5).collect();
    let weight = |k: usize| (std::f64::consts::PI * place(k)).cos().powi(2) * (angle[k] - angle[k - 1]);
    let whole: f64 = inside.iter().map(|k| weight(*k)).sum();
    let mean = inside.iter().map(|k| weight(*k) * hidden.shaft_torque_nm[*k]).sum::<f64>() / whole;
    let term = |k: &usize| c64::cis(-order * angle[*k]) * (weight(*k) * (hidden.shaft_torque_nm[*k] - mean));
    2.0 * inside.iter().map(term).sum::<c64>().norm() / whole
}

#[test]
fn stat_orders_of_a_run_up_are_those_of_the_shaft_as_it_is() {
    let rpm = |rpm: f64| rpm * RPM_RAD_S;
    let mut plan = ExperimentPlan::ramp_n_nt(1000.0, 20.0);
    let (low, high) = (rpm(1000.0), rpm(3000.0));
    plan.speed_rad_s = Waveform::Ramps { low, high, first_s: 1.0, ramp_s: 18.0, dwell_s: 5.0 };
    let drawn = Drawn { parameters: BenchParameters::torque_flange(), plan, seed: 3 };
    let hidden = simulate_hidden(&drawn.parameters, &drawn.plan, 3, Numerics::default()).unwrap().hidden;
    let mut at = 0.0;
    let turned = hidden.engine_speed_rad_s.iter().map(|w| {
        at += w * hidden.sample_time_s;
        at
    });
    let angle: Vec<f64> = turned.collect();
    let look = drawn.look();
    let torque = look.parts[0].signals.iter().find(|s| s.role == Role::FlangeTorque).unwrap();
    // Recorded at 250 Hz, order 4 folds above 1875 rpm.
    for order in [2.0, 4.0] {
        let track = torque.tracks.iter().find(|track| track.order == order).unwrap();
        let fits = |point: &&part_lines::lines::TrackPoint| {
            let truth = true_amplitude(&hidden, &angle, order, point.time_s);
            // The flange's own filter takes 2 % at 200 Hz.
            (point.amplitude - truth).abs() < 3.0 * point.standard_error + 0.03 * truth
        };
        let right = track.points.iter().filter(fits).count();
        println!("order {order}: {right} of {} points", track.points.len());
        assert!(track.points.len() > 50 && right as f64 > 0.95 * track.points.len() as f64, "{right}");
    }
    let signals = over_speed(&[look]);
    let torque: &OverSpeed = signals.iter().find(|signal| signal.role == Role::FlangeTorque).unwrap();
    let firing = torque.orders.iter().find(|curve| curve.order == 2.0).unwrap();
    assert!(firing.is_firing && firing.points.iter().any(|point| point.phase_rad.is_some()));
    assert!(torque.map.iter().filter(|column| column.is_empty()).count() < torque.map.len() / 10);
}
