//! Knowledge of an engine's firing pulses.

use numerics::random::Stream;
use rig::bench_parameters::EngineParameters;
use rig::engine_pulses::EnginePulses;
use rig::facts::Engine;

const ENGINE: Engine = Engine { cylinders: 4, strokes: 4 };
const INERTIA: f64 = 0.25;

/// Amplitudes of a harmonic of the cycle over the mean torque, sorted, of engines drawn.
fn drawn(pulses: &EnginePulses, m: usize, torque_nm: f64, inertia: f64) -> Vec<f64> {
    let mut random = Stream::new(3, 1);
    let engine = EngineParameters::default();
    let mut draw = || pulses.draw(&engine, inertia, &mut random).waves(torque_nm, 150.0)[m - 1].norm() / torque_nm;
    let mut all: Vec<f64> = (0..2000).map(|_| draw()).collect();
    all.sort_by(f64::total_cmp);
    all
}

#[test]
fn stat_engines_of_the_class_have_the_amplitudes_of_the_class() {
    let loaded = drawn(&EnginePulses::prior(ENGINE, INERTIA), 4, 1000.0, INERTIA);
    let at = |share: f64| loaded[(share * loaded.len() as f64) as usize];
    assert!((0.3..0.5).contains(&at(0.05)) && (2.6..3.3).contains(&at(0.95)), "{} … {}", at(0.05), at(0.95));
    // Cylinders differ, but by far less than a firing from none.
    let half_order = drawn(&EnginePulses::prior(ENGINE, INERTIA), 1, 1000.0, INERTIA);
    assert!(half_order[1900] > 0.1 && half_order[1900] < 0.4, "{}", half_order[1900]);
}

#[test]
fn stat_draws_have_the_covariance_and_scale_with_the_inertia() {
    let mut pulses = EnginePulses::prior(ENGINE, INERTIA);
    let firing = &mut pulses.harmonics[3];
    firing.value.of_torque = [2.0, 0.0];
    // α and β are known together alone: at 100 Nm the amplitude is.
    firing.covariance = [[100.0, -1.0, 0.0], [-1.0, 0.01, 0.0], [0.0, 0.0, 0.0]];
    let known = drawn(&pulses, 4, 100.0, INERTIA);
    assert!((known[0] - 2.0).abs() < 1e-6 && (known[1999] - 2.0).abs() < 1e-6);
    let unknown = drawn(&pulses, 4, 200.0, INERTIA);
    let deviation = (unknown.iter().map(|one| (one - 2.0).powi(2)).sum::<f64>() / 2000.0).sqrt();
    assert!((deviation / 0.05 - 1.0).abs() < 0.1, "{deviation}");
    let heavier = drawn(&pulses, 4, 100.0, 1.1 * INERTIA);
    assert!((heavier[0] - 2.2).abs() < 1e-6);
}

/// The Fourier series of unequal cylinders has the torque of their pulses.
#[test]
fn exact_waves_are_the_torque_of_all_cylinders() {
    let engine = EngineParameters::default();
    let waves = engine.waves(50.0, 100.0);
    let mean = 50.0 * engine.cylinder_factors.iter().sum::<f64>() / 4.0;
    // The firing order has the mean of the cylinders, and what jumps of the level add.
    assert!((waves[3].norm() / (2.0 * mean) - 1.0).abs() < 0.02, "{}", waves[3].norm());
    let equal = EngineParameters { cylinder_factors: vec![1.0; 4], ..engine };
    let waves = equal.waves(50.0, 100.0);
    for (m, wave) in (1..).zip(&waves) {
        let expected = if m % 4 == 0 { 50.0 * equal.firing_harmonics[m / 4 - 1].relative_amplitude } else { 0.0 };
        assert!((wave.norm() - expected).abs() < 1e-9, "{m}: {}", wave.norm());
    }
}

#[test]
fn exact_the_cylinder_of_an_angle() {
    let engine = EngineParameters::default();
    let quarter = 0.25 * engine.cycle_rad();
    for (quarters, cylinder) in [(0.5, 0), (1.5, 1), (3.9, 3), (4.1, 0), (-0.1, 3)] {
        assert_eq!(engine.cylinder_at(quarters * quarter), cylinder);
    }
}
