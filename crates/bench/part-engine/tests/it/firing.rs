//! The firings of the engine in a speed.

use std::collections::BTreeMap;

use part_engine::firing::Firing;
use part_engine::orders::Seen;
use rig::{Experiment, ExperimentLabel, Role};
use signal::Signal;
use signal::excitation::Random;

/// The speed of an engine that fires so often a turn, whose cylinders differ a little, with multiples nearly as
/// strong.
fn recorded(firing: f64, sample_time_s: f64) -> Experiment {
    let mut random = Random::new(7);
    let omega = 130.0;
    let value = |k: usize| {
        let angle = omega * k as f64 * sample_time_s;
        let order = |order: f64, amplitude: f64| amplitude / order * (order * angle).sin();
        let of_firing = order(firing, 1.0) + order(2.0 * firing, 0.8) + order(3.0 * firing, 0.5);
        let orders = of_firing + order(0.5, 0.05) + order(1.0, 0.3);
        omega + orders + 0.01 * random.normal()
    };
    let speed = Signal::new(0.0, sample_time_s, (0..8000).map(value).collect()).unwrap();
    let signals = BTreeMap::from([(Role::EngineSpeed, speed)]);
    Experiment { file: "x".to_owned(), label: ExperimentLabel::BS_T_NT, signals }
}

/// Over an angle with the pulses in it, a tenth of the first order came to the second.
#[test]
fn regress_strong_pulses_leave_nothing_at_their_multiples() {
    let (omega, sample_time_s) = (110.0, 1e-3);
    let value = |k: usize| omega + 6.0 * (1.5 * omega * k as f64 * sample_time_s).sin();
    let speed = Signal::new(0.0, sample_time_s, (0..20_000).map(value).collect()).unwrap();
    let seen = Seen::over_angle_of(&speed, &speed, omega);
    let part = (seen.power(3.0) / seen.power(1.5)).sqrt();
    assert!(part < 5e-3, "{part}");
    let with_pulses = Seen::of(&speed, omega);
    let part = (with_pulses.power(3.0) / with_pulses.power(1.5)).sqrt();
    assert!(part > 0.05, "{part}");
}

#[test]
fn exact_another_engine_is_named_and_the_right_one_is_not_doubted() {
    for found in [1.0, 1.5, 2.0, 2.5, 3.0, 4.0] {
        let experiment = recorded(found, 2e-3);
        for stated in [0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0] {
            let expected = (stated != found).then_some(found);
            // Cylinders that fire half as often leave every second multiple to the same orders; two show their
            // turns.
            let is_open = stated == 2.0 * found || found == 1.0 || stated == 1.0;
            let answer = Firing::of(&experiment, stated).contradiction.unwrap();
            assert!(answer == expected || is_open && answer.is_none(), "{found}, stated {stated}: {answer:?}");
        }
    }
}

#[test]
fn exact_pulses_date_the_speed() {
    for gain in [0.7, 0.9, 0.99, 1.0, 1.001, 1.01, 1.05, 1.3] {
        let mut experiment = recorded(2.0, 2e-3);
        let speed = experiment.signals.get_mut(&Role::EngineSpeed).unwrap();
        speed.samples.iter_mut().for_each(|x| *x *= gain);
        let found = Firing::of(&experiment, 2.0).pulses_over_speed.unwrap();
        assert!((found * gain - 1.0).abs() < 1.5e-3, "{found} at {gain}");
    }
    assert_eq!(Firing::of(&recorded(3.0, 1e-2), 3.0).pulses_over_speed, None);
}

#[test]
fn exact_an_order_above_the_sampling_is_not_judged() {
    assert_eq!(Firing::of(&recorded(3.0, 1e-2), 3.0).contradiction, None);
}
