//! Lines of simulated recordings, whose causes are known, and what they are named.

use std::f64::consts::TAU;

use bench::experiment::{ExperimentPlan, Waveform};
use bench::look::{Cause, Line, Look, LookedPart, LookedSignal, look};
use bench::model::Engine;
use bench::virtual_bench::{BenchParameters, simulate};
use bench::{Experiment, Role, prepare};
use faer::c64;
use signal::Signal;
use signal::excitation::Random;

use crate::study::default_bench;

/// One recording and those without one of its causes each.
struct Labelled {
    parameters: BenchParameters,
    demanded_hz: Option<f64>,
    look: Look,
    whole: Experiment,
    /// Without what turns with the engine, without ripple, without the demand's hold.
    without: [Experiment; 3],
}

/// What made a line, by what is missing where it is off.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Source {
    Turning,
    Ripple,
    Hold,
}
/// How far lines are spread, a share of their frequency.
const SPREAD: f64 = 0.005;
const SOURCES: [Source; 3] = [Source::Turning, Source::Ripple, Source::Hold];

impl Labelled {
    fn draw(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut within = |low: f64, high: f64| low + (high - low) * random.uniform();
        let mut parameters = BenchParameters::default();
        let cylinders = [3, 4, 6][within(0.0, 3.0) as usize];
        parameters.engine.cylinder_factors = (0..cylinders).map(|_| within(0.9, 1.1)).collect();
        parameters.engine.cycle_variation = within(0.0, 0.03);
        parameters.inverter.additive_ripple_nm = within(0.0, 2.0);
        parameters.inverter.multiplicative_ripple = within(0.0, 0.06);
        parameters.sensors.cell_resonance_hz = within(60.0, 90.0);
        parameters.clocks.torque_decimation = [1, 2, 4][within(0.0, 3.0) as usize];
        let speed_rpm = 10.0 * within(80.0, 420.0).round();
        let duration_s = within(12.0, 20.0);
        let frequency_hz = within(2.0, 30.0);
        let amplitude = within(3.0, 10.0);
        let sine = |mean: f64, amplitude: f64| Waveform::SineLadder {
            mean,
            amplitude,
            frequencies_hz: vec![frequency_hz],
            dwell_s: duration_s,
        };
        let (plan, demanded_hz) = match within(0.0, 4.0) as usize {
            0 => (ExperimentPlan::bs_t_nt(speed_rpm, duration_s), None),
            1 => (ExperimentPlan::white_noise_t_tn(speed_rpm, duration_s), None),
            2 => {
                let mut plan = ExperimentPlan::bs_t_nt(speed_rpm, duration_s);
                plan.engine_torque_nm = Waveform::Constant { value: within(20.0, 60.0) };
                (plan, None)
            }
            _ => {
                let mut plan = ExperimentPlan::sine_t_tn(speed_rpm, duration_s);
                plan.dyno_torque_nm = sine(within(20.0, 60.0), amplitude);
                (plan, Some(frequency_hz))
            }
        };
        let recorded = |parameters: &BenchParameters| {
            let mut file = default_bench();
            file.cylinders = cylinders as u32;
            let recording = simulate(parameters, &plan, seed).unwrap();
            prepare("run.mf4", &recording, &file, plan.label.clone()).unwrap().0
        };
        let whole = recorded(&parameters);
        let mut still = parameters.clone();
        still.engine.firing_harmonics.clear();
        still.engine.cylinder_factors.fill(1.0);
        still.engine.cycle_variation = 0.0;
        still.sensors.dyno_eccentricity = 0.0;
        still.sensors.engine_eccentricity = 0.0;
        let mut smooth = parameters.clone();
        (smooth.inverter.additive_ripple_nm, smooth.inverter.multiplicative_ripple) = (0.0, 0.0);
        let mut quick = parameters.clone();
        quick.controller.demand_hold_s = 1e-3;
        let without = [recorded(&still), recorded(&smooth), recorded(&quick)];
        let look = look(&whole, Engine { cylinders: cylinders as u32, strokes: 4 });
        Labelled { parameters, demanded_hz, look, whole, without }
    }

    /// What part of the amplitude at a frequency is missed without each source.
    fn missed(&self, part: &LookedPart, role: Role, hz: f64) -> Vec<(Source, f64)> {
        let of = |experiment: &Experiment| {
            let signal = experiment.signal(role).unwrap().slice(part.start_s, part.end_s);
            // Lines that follow the speed are spread.
            let bins = (SPREAD * hz * signal.duration_s()).ceil().max(2.0) as i32;
            (-bins..=bins).map(|k| amplitude(&signal, hz + f64::from(k) / signal.duration_s())).collect::<Vec<_>>()
        };
        let whole = of(&self.whole);
        let power = |x: &[c64]| x.iter().map(|x| x.norm_sqr()).sum::<f64>();
        let missed = self.without.iter().map(|without| {
            let apart: Vec<c64> = of(without).iter().zip(&whole).map(|(a, b)| a - b).collect();
            (power(&apart) / power(&whole)).sqrt()
        });
        // Noise that is held differs with how long it is held.
        let is_told = |(source, _): &(Source, f64)| *source != Source::Hold || self.demanded_hz.is_some();
        SOURCES.into_iter().zip(missed).filter(is_told).collect()
    }

    fn is_right(&self, part: &LookedPart, signal: &LookedSignal, line: &Line) -> bool {
        let missed = self.missed(part, signal.role, line.frequency_hz);
        let part_of = |source: Source| missed.iter().find(|(other, _)| *other == source).map_or(0.0, |(_, part)| *part);
        let (source, part) = missed.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        let is_of = |cause: &Cause| match cause {
            Cause::Order { .. } | Cause::FoldedOrder { .. } | Cause::OrderSideband { .. } => source == Source::Turning,
            Cause::Demanded => self.demanded_hz.is_some_and(|hz| {
                // Rounding, which goes with the hold, gives a sine more lines.
                (hz - line.frequency_hz).abs() < 0.1
                    || (signal.role == Role::DynoTorqueDemand || part_of(Source::Turning) < 0.3)
            }),
            // Of an order the engine is missed as much.
            Cause::HoldImage { of_hz, .. } if self.demanded_hz.is_some_and(|hz| (hz - of_hz).abs() > 0.1) => {
                source == Source::Turning && part_of(Source::Ripple) < 0.3
            }
            Cause::HoldImage { .. } => source == Source::Hold,
            Cause::RippleSideband { .. } => part_of(Source::Ripple) > 0.5,
            Cause::Mains { .. } => source == Source::Ripple,
            _ => false,
        };
        match &line.cause {
            Cause::StructuralResonance => (line.frequency_hz / self.parameters.truth().resonance_hz - 1.0).abs() < 0.2,
            Cause::SensorResonance => (line.frequency_hz / self.parameters.sensors.cell_resonance_hz - 1.0).abs() < 0.1,
            Cause::Undecided { between, .. } => between.iter().any(is_of),
            cause => is_of(cause) && (part > 0.3 || *cause == Cause::Demanded),
        }
    }
}

fn amplitude(signal: &Signal, hz: f64) -> c64 {
    let (mean, n) = (signal.mean().unwrap(), signal.len() as f64);
    let term = |(k, x): (usize, &f64)| {
        let window = 1.0 - (TAU * (k as f64 + 0.5) / n).cos();
        c64::cis(-TAU * hz * signal.time_s(k)) * (2.0 * window / n * (x - mean))
    };
    signal.samples.iter().enumerate().map(term).sum()
}

/// Recordings, half of them a thread, and the share of their lines that has to be named rightly.
const RECORDINGS: u64 = 40;
const RIGHT: f64 = 0.95;

/// How many lines of some recordings are named rightly, how many are undecided, and how many there are.
fn counts(seeds: impl Iterator<Item = u64>) -> [usize; 3] {
    let [mut right, mut undecided, mut all] = [0; 3];
    for seed in seeds {
        let labelled = Labelled::draw(seed);
        for (part, signal) in labelled.look.parts.iter().flat_map(|part| part.signals.iter().map(move |s| (part, s))) {
            for line in &signal.lines {
                let is_right = labelled.is_right(part, signal, line);
                (all, right) = (all + 1, right + usize::from(is_right));
                undecided += usize::from(matches!(line.cause, Cause::Undecided { .. }));
                if !is_right {
                    println!("{seed} {} {:?}: {line:.3?}", labelled.look.label, signal.role);
                }
            }
        }
    }
    [right, undecided, all]
}

#[test]
#[ignore = "slow"]
fn stat_lines_are_named_by_what_made_them() {
    let halves = std::thread::scope(|scope| {
        let work = [0, 1].map(|first| scope.spawn(move || counts((first..RECORDINGS).step_by(2))));
        work.map(|half| half.join().unwrap())
    });
    let [right, undecided, all] = [0, 1, 2].map(|k| halves[0][k] + halves[1][k]);
    println!("{right} of {all} right, {undecided} undecided");
    assert!(right as f64 >= RIGHT * all as f64 && undecided < all / 5, "{right} of {all}, {undecided} undecided");
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
        look(&experiment, Engine { cylinders: 4, strokes: 4 })
    };
    let at = |look: &Look, role: Role, hz: f64| {
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
        let look = look(&experiment, Engine { cylinders: 4, strokes: 4 });
        let signal = look.parts[0].signals.iter().find(|s| s.role == Role::AirGapTorque).unwrap().clone();
        signal.lines.into_iter().filter(|l| (l.frequency_hz - 100.0).abs() < 0.2).map(|l| l.cause).collect::<Vec<_>>()
    };
    let Some(Cause::Undecided { between, repeat_at_rpm: Some(rpm) }) = causes(3000.0).into_iter().next() else {
        panic!("{:?}", causes(3000.0));
    };
    assert!(between.contains(&Cause::Mains { multiple: 2, mains_hz: 50.0 }), "{between:?}");
    assert_eq!(causes(rpm), [Cause::Mains { multiple: 2, mains_hz: 50.0 }]);
}
