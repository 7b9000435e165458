//! The map, compared with benches that run its sines.

use std::f64::consts::TAU;

use bench_model::simulate::{
    DynoInput, EngineSpeedControl, InitialState, Inputs, Response, simulate, simulate_governed,
};
use capability::LimitOf;
use capability::map::{MapInputs, SineOf, map};
use design::safety::{BenchSpread, Prior};
use rig::bench_file::Limits;
use units::RPM_RAD_S;

use crate::support::{Bench, bench};

const SPEED: f64 = 1500.0 * RPM_RAD_S;
const TORQUE_NM: f64 = 50.0;

fn inputs(bench: &Bench) -> MapInputs<'_> {
    MapInputs {
        model: &bench.model,
        engine: &bench.engine,
        limits: bench.limits,
        spread: BenchSpread::Prior(Prior::default()),
        torque_nm: TORQUE_NM,
        samples: 20,
        seed: 1,
    }
}

/// A bench whose engine does not fire, since its pulses are an upper bound.
fn smooth() -> Bench {
    let mut bench = bench();
    bench.engine.firing_harmonics.clear();
    bench.limits = Limits {
        torque_nm: Some(250.0),
        shaft_torque_nm: Some(180.0),
        speed_rad_s: Some(2500.0 * RPM_RAD_S),
        ..Limits::default()
    };
    bench
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
