//! The map, compared with benches that run its sines.

use std::f64::consts::TAU;

use bench_model::simulate::{
    DynoInput, EngineSpeedControl, InitialState, Inputs, Response, simulate, simulate_governed,
};
use capability::gradient::gradients;
use capability::map::{MapInputs, SineOf, map};
use capability::wanted::{self, Wanted};
use capability::{CanInputs, Demand, LimitOf, can};
use design::safety::{BenchSpread, FrictionSpread, Prior};
use rig::bench_file::Limits;
use rig::engine_pulses::KnownPulses;
use rig::experiment::{Demands, ExperimentPlan, Waveform};
use units::RPM_RAD_S;

use crate::pulses::bench_with_compression;
use crate::support::{Bench, bench};

const SPEED: f64 = 1500.0 * RPM_RAD_S;
const TORQUE_NM: f64 = 50.0;

pub(crate) fn inputs(bench: &Bench) -> MapInputs<'_> {
    MapInputs {
        model: &bench.model,
        engine: &bench.engine,
        pulses: &KnownPulses::Stated,
        limits: bench.limits,
        spread: BenchSpread::Prior(Prior::default()),
        friction: FrictionSpread::NONE,
        torque_nm: TORQUE_NM,
        samples: 20,
        seed: 1,
    }
}

/// A bench whose engine does not fire, since its pulses are an upper bound.
fn smooth() -> Bench {
    let mut bench = bench();
    bench.engine.firing_harmonics.clear();
    bench.engine.cycle_variation = 0.0;
    bench.limits = Limits {
        torque_nm: Some(250.0),
        shaft_torque_nm: Some(180.0),
        speed_rad_s: Some(2500.0 * RPM_RAD_S),
        ..Limits::default()
    };
    bench
}

/// A slow sine swings the engine's torque far: what pulses add at the other frequencies must not follow from that.
#[test]
fn regress_the_amplitude_at_a_frequency_does_not_depend_on_the_others() {
    let mut bench = bench_with_compression();
    bench.limits = Limits { shaft_torque_nm: Some(180.0), ..Limits::default() };
    let at_20_hz = |frequencies: &[f64]| {
        let found = map(&inputs(&bench), SineOf::Torque, frequencies, &[SPEED]).unwrap();
        found.places[0].last().unwrap().amplitude
    };
    let (alone, beside) = (at_20_hz(&[20.0]), at_20_hz(&[0.1, 1.0, 20.0]));
    for (alone, beside) in alone.into_iter().zip(beside) {
        assert!((beside / alone - 1.0).abs() < 0.02, "{beside} for {alone}");
    }
}

/// The sine with this amplitude, after it has settled.
fn run(bench: &Bench, of: SineOf, frequency_hz: f64, amplitude: f64) -> Response {
    let samples = 20_000;
    let sine: Vec<f64> = (0..samples).map(|k| amplitude * (TAU * frequency_hz * k as f64 * 1e-3).sin()).collect();
    let model = bench_model::model::BenchModel { torque_limit_nm: None, ..bench.model.clone() };
    let start = InitialState::steady(&model, SPEED, TORQUE_NM);
    let engine = vec![if of == SineOf::Speed { TORQUE_NM } else { 0.0 }; samples];
    let speed: Vec<f64> = sine.iter().map(|value| SPEED + value).collect();
    let torque: Vec<f64> = sine.iter().map(|value| TORQUE_NM + value).collect();
    match of {
        SineOf::Speed => {
            let dyno = DynoInput::SpeedDemand(&speed);
            simulate(&model, &Inputs { sample_time_s: 1e-3, engine_torque_nm: &engine, dyno }, &start).unwrap()
        }
        SineOf::Torque => {
            let held = vec![SPEED; samples];
            let control = EngineSpeedControl {
                demand_rad_s: &held,
                proportional_nm_s_per_rad: bench.engine.speed_control_proportional_nm_s_per_rad,
                integral_nm_per_rad: bench.engine.speed_control_integral_nm_per_rad,
                start_nm: TORQUE_NM,
                air: None,
            };
            let dyno = DynoInput::TorqueDemand(&torque);
            let inputs = Inputs { sample_time_s: 1e-3, engine_torque_nm: &engine, dyno };
            simulate_governed(&model, &inputs, &control, &start).unwrap()
        }
    }
}

/// Largest part of a limit that the settled sine uses.
fn used(bench: &Bench, response: &Response) -> f64 {
    let largest = |values: &[f64]| values[10_000..].iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let uses = [
        largest(&response.shaft_torque_nm) / bench.limits.shaft_torque_nm.unwrap(),
        largest(&response.torque_demand_nm) / bench.limits.torque_nm.unwrap(),
        largest(&response.dyno_speed_rad_s).max(largest(&response.engine_speed_rad_s))
            / bench.limits.speed_rad_s.unwrap(),
    ];
    uses.into_iter().fold(0.0, f64::max)
}

#[test]
fn ref_amplitudes_of_the_map_use_the_limits_to_three_per_cent() {
    let bench = smooth();
    let frequencies = [0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 18.0, 22.0, 30.0, 50.0];
    for of in [SineOf::Speed, SineOf::Torque] {
        // The nominal bench alone.
        let spread = Prior { resonance: 0.0, damping: 0.0, engine_inertia: 0.0 };
        let exact = MapInputs { spread: BenchSpread::Prior(spread), samples: 1, ..inputs(&bench) };
        let found = map(&exact, of, &frequencies, &[SPEED]).unwrap();
        for (frequency, place) in frequencies.iter().zip(&found.places[0]) {
            let amplitude = place.amplitude[1];
            let used = used(&bench, &run(&bench, of, *frequency, amplitude));
            assert!((used - 1.0).abs() < 0.03, "{of:?} at {frequency} Hz, {amplitude}: {used} of {:?}", place.binds);
        }
    }
}

/// Largest part of a limit that a sine uses on a bench whose engine fires; it rises slowly from nothing.
fn used_fired(bench: &Bench, of: SineOf, speed: f64, frequency_hz: f64, amplitude: f64) -> f64 {
    let duration_s = (8.0 / frequency_hz).max(8.0);
    let sine = |mean: f64, amplitude: f64| Waveform::Sampled {
        sample_time_s: 1e-3,
        values: (0..(duration_s * 1e3) as usize)
            .map(|k| k as f64 * 1e-3)
            .map(|time_s| {
                let risen = (2.0 * time_s / duration_s).min(1.0);
                mean + risen * amplitude * (TAU * frequency_hz * time_s).sin()
            })
            .collect(),
    };
    let base = match of {
        SineOf::Speed => ExperimentPlan::levels_n_nt(speed / RPM_RAD_S, duration_s),
        SineOf::Torque => ExperimentPlan::step_t_tn(speed / RPM_RAD_S, duration_s),
    };
    let (of_speed, of_torque) = if of == SineOf::Speed { (amplitude, 0.0) } else { (0.0, amplitude) };
    let plan = ExperimentPlan {
        speed_rad_s: sine(speed, of_speed),
        dyno_torque_nm: sine(TORQUE_NM, of_torque),
        engine_torque_nm: Waveform::Constant { value: TORQUE_NM },
        ..base
    };
    let demands = Demands::of(&plan, 1, 1e-3);
    let nominal = BenchSpread::Prior(Prior { resonance: 0.0, damping: 0.0, engine_inertia: 0.0 });
    let inputs = CanInputs { spread: nominal, samples: 1, ..bench.inputs(Demand::Plan(&plan, &demands)) };
    let verdict = can(&inputs, &work::Context::new()).unwrap();
    let use_of = |one: &capability::LimitVerdict| Some(one.values.quantile(0.5) / one.limit?);
    verdict.limits.iter().filter_map(use_of).fold(0.0, f64::max)
}

/// Sines that move the engine's torque, or its speed through the resonance with its firing at 540 rpm.
#[test]
fn ref_sines_that_meet_the_resonance_with_the_firing_use_no_more_than_the_limits() {
    let mut bench = bench();
    bench.limits = Limits {
        torque_nm: Some(400.0),
        shaft_torque_nm: Some(330.0),
        shaft_torque_slew_nm_per_s: Some(30_000.0),
        speed_rad_s: Some(2500.0 * RPM_RAD_S),
        speed_gradient_rad_s2: Some(4000.0 * RPM_RAD_S),
        ..Limits::default()
    };
    let nominal = BenchSpread::Prior(Prior { resonance: 0.0, damping: 0.0, engine_inertia: 0.0 });
    let inputs = MapInputs { spread: nominal, samples: 1, ..inputs(&bench) };
    for (of, rpm, frequencies) in [
        (SineOf::Torque, 700.0, [1.0, 5.0]),
        (SineOf::Torque, 1500.0, [1.0, 5.0]),
        (SineOf::Speed, 800.0, [0.5, 2.0]),
        (SineOf::Speed, 1200.0, [0.5, 2.0]),
    ] {
        let speed = rpm * RPM_RAD_S;
        let found = map(&inputs, of, &frequencies, &[speed]).unwrap();
        for (frequency, place) in frequencies.iter().zip(&found.places[0]) {
            let used = used_fired(&bench, of, speed, *frequency, place.amplitude[1]);
            println!("{of:?} {rpm} rpm {frequency} Hz: {:.2}, uses {used:.3} of {:?}", place.amplitude[1], place.binds);
            assert!(used < 1.03, "{of:?} {rpm} rpm {frequency} Hz, {place:?}: {used}");
        }
    }
}

#[test]
fn exact_the_resonance_binds_the_shaft_torque() {
    let bench = smooth();
    let resonance = bench.model.mechanics.resonance().frequency_hz;
    let found = map(&inputs(&bench), SineOf::Torque, &[1.0, resonance, 60.0], &[SPEED]).unwrap();
    let [slow, at, fast] = [0, 1, 2].map(|k| found.places[0][k]);
    assert_eq!(at.binds, Some(LimitOf::ShaftTorque));
    assert!(at.amplitude[1] < slow.amplitude[1] && at.amplitude[1] < fast.amplitude[1], "{slow:?} {at:?} {fast:?}");
    assert!(at.amplitude[0] <= at.amplitude[1] && at.amplitude[1] <= at.amplitude[2]);
}

#[test]
fn exact_firing_pulses_take_room_from_the_sine() {
    let (smooth, mut firing) = (smooth(), smooth());
    firing.engine = bench().engine;
    firing.limits.shaft_torque_nm = Some(600.0);
    let with = map(&inputs(&firing), SineOf::Torque, &[5.0], &[800.0 * RPM_RAD_S, 4000.0 * RPM_RAD_S]).unwrap();
    let mut same = smooth;
    same.limits.shaft_torque_nm = Some(600.0);
    same.limits.torque_nm = None;
    firing.limits.torque_nm = None;
    let without = map(&inputs(&same), SineOf::Torque, &[5.0], &[800.0 * RPM_RAD_S, 4000.0 * RPM_RAD_S]).unwrap();
    assert!(with.places[0][0].amplitude[1] < without.places[0][0].amplitude[1]);
    // Far above the resonance the shaft hardly sees them.
    let lost = |k: usize| without.places[k][0].amplitude[1] - with.places[k][0].amplitude[1];
    assert!(lost(0) > lost(1), "{} {}", lost(0), lost(1));
}

#[test]
fn ref_hand_check_of_a_speed_sine() {
    // 100 rpm at 2 Hz on 0.83 kg m² need 109 Nm.
    let mut bench = smooth();
    bench.model.mechanics.dyno_inertia_kg_m2 = 0.55;
    bench.model.mechanics.engine_inertia_kg_m2 = 0.28;
    let needed = 100.0 * RPM_RAD_S * TAU * 2.0 * 0.83;
    assert_eq!(needed.round(), 109.0);
    bench.limits = Limits { torque_nm: Some(TORQUE_NM + needed), ..Limits::default() };
    let found = map(&inputs(&bench), SineOf::Speed, &[2.0], &[SPEED]).unwrap();
    let followed = found.places[0][0].amplitude[1] / (100.0 * RPM_RAD_S);
    // The speed follows its demand to some per cent, and the shaft gives way a little.
    assert!((followed - 1.0).abs() < 0.1, "{followed}");
}

#[test]
fn exact_a_wish_is_held_against_the_map() {
    let bench = smooth();
    let inputs = inputs(&bench);
    let found = map(&inputs, SineOf::Torque, &[5.0], &[SPEED]).unwrap();
    let [least, ..] = found.places[0][0].amplitude;
    let of = |amplitude: f64| {
        let wish = Wanted::Sine { of: SineOf::Torque, amplitude, frequency_hz: 5.0 };
        wanted::answer(&inputs, wish, &[SPEED]).unwrap()
    };
    assert!(of(0.9 * least).is_yes() && !of(2.0 * least).is_yes());
    assert_eq!(of(0.9 * least).places[0].largest, found.places[0][0].amplitude);
    let steep = gradients(&inputs, &[SPEED], &[TORQUE_NM]).unwrap()[0];
    let wish = Wanted::Gradient { rad_s2: 1.01 * steep.up_rad_s2[2].min(steep.down_rad_s2[2]) };
    let answer = wanted::answer(&inputs, wish, &[SPEED]).unwrap();
    assert_eq!((answer.is_yes(), answer.places[0].kept.count), (false, 0));
    // Downwards the engine pushes against the dynamometer.
    assert!(steep.down_rad_s2[1] < steep.up_rad_s2[1], "{steep:?}");
}

#[test]
fn exact_gradients_leave_the_limits_to_inertia_and_pulses() {
    let mut bench = smooth();
    bench.model.mechanics.dyno_inertia_kg_m2 = 0.55;
    bench.model.mechanics.engine_inertia_kg_m2 = 0.28;
    bench.limits = Limits { torque_nm: Some(400.0), ..Limits::default() };
    let nominal = BenchSpread::Prior(Prior { resonance: 0.0, damping: 0.0, engine_inertia: 0.0 });
    let steepest = |bench: &Bench, torque: f64| {
        let inputs = MapInputs { spread: nominal, samples: 1, ..inputs(bench) };
        gradients(&inputs, &[SPEED], &[torque]).unwrap()[0].up_rad_s2[1] / RPM_RAD_S
    };
    // 400 Nm on 0.83 kg m².
    assert_eq!(steepest(&bench, 0.0).round(), 4602.0);
    let smooth = steepest(&bench, 80.0);
    bench.engine = crate::support::bench().engine;
    let with_pulses = steepest(&bench, 80.0);
    assert!(with_pulses < smooth && with_pulses > 0.5 * smooth, "{with_pulses} {smooth}");
}

#[test]
fn exact_texts_of_wishes() {
    let sine = |of, amplitude, frequency_hz| Wanted::Sine { of, amplitude, frequency_hz };
    assert_eq!("20 Nm at 8 Hz".parse(), Ok(sine(SineOf::Torque, 20.0, 8.0)));
    assert_eq!("100 rpm at 0.5 Hz".parse(), Ok(sine(SineOf::Speed, 100.0 * RPM_RAD_S, 0.5)));
    let Ok(Wanted::Gradient { rad_s2 }) = "4000 rpm/s".parse() else { panic!("no gradient") };
    assert!((rad_s2 - 4000.0 * RPM_RAD_S).abs() < 1e-9);
    for wrong in ["20 Nm", "20 Nm at 8", "-20 Nm at 8 Hz", "20 m at 8 Hz", "fast", "20 Nm at 0 Hz"] {
        let error = wrong.parse::<Wanted>().unwrap_err().to_string();
        assert!(error.contains(wrong) && error.contains("4000 rpm/s"), "{error}");
    }
}

#[test]
fn exact_bandwidths_are_those_of_the_torque_control() {
    let bench = smooth();
    let found = map(&inputs(&bench), SineOf::Torque, &[5.0], &[SPEED]).unwrap().bandwidths;
    let control = bench.model.torque_control.unwrap();
    let corner_hz = control.bandwidth_rad_s.unwrap() / TAU;
    // A lag of first order is 3 dB down at its corner, and 10 % down at 0.484 of it.
    let expected = |part: f64| (part * corner_hz).min(f64::INFINITY);
    for (found, expected) in [(found.three_db_hz[1], expected(1.0)), (found.ten_per_cent_hz[1], expected(0.484))] {
        assert!((found / expected - 1.0).abs() < 0.03 || expected > 300.0 && found.is_infinite(), "{found} {expected}");
    }
    let delay_s = control.delay_s + 1.0 / (TAU * corner_hz);
    assert!((found.delay_s[1] / delay_s - 1.0).abs() < 0.01, "{} {delay_s}", found.delay_s[1]);
    assert_eq!(found.one_ms_hz[1], if delay_s > 1e-3 { 0.1 } else { found.one_ms_hz[1] });
}
