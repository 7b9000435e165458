//! Which part of a long recording estimates use.

use std::borrow::Cow;
use std::collections::BTreeMap;

use rig::estimation::liveliest_part;
use rig::{Experiment, Role};
use signal::Signal;

/// N_e every 10 ms for so long, from 2.5 s on, which swings between these instants and rests otherwise.
fn recorded(duration_s: u32, swings: std::ops::Range<f64>) -> Experiment {
    let value = |time_s: f64| 100.0 + if swings.contains(&time_s) { (40.0 * time_s).sin() } else { 0.0 };
    let samples = (0..100 * duration_s).map(|k| value(2.5 + 0.01 * f64::from(k))).collect();
    let signals = BTreeMap::from([
        (Role::EngineSpeed, Signal::new(2.5, 0.01, samples).unwrap()),
        (Role::DynoSpeed, Signal::new(2.5, 0.02, vec![100.0; 50 * duration_s as usize]).unwrap()),
    ]);
    Experiment { file: "a.mf4".to_owned(), label: "BS_T_NT".parse().unwrap(), signals }
}

#[test]
fn exact_of_a_long_recording_the_part_is_used_that_moves() {
    let long = recorded(700, 300.0..540.0);
    let part = liveliest_part(&long, Role::EngineSpeed);
    for role in [Role::EngineSpeed, Role::DynoSpeed] {
        let signal = part.signal(role).unwrap();
        let (start_s, end_s) = (signal.start_s, signal.end_s());
        assert!((start_s - 300.0).abs() <= 1.0 && (end_s - start_s - 240.0).abs() < 0.03, "{start_s} {end_s}");
    }
}

#[test]
fn exact_a_short_recording_and_one_without_the_signal_are_used_whole() {
    let short = recorded(240, 10.0..20.0);
    assert!(matches!(liveliest_part(&short, Role::EngineSpeed), Cow::Borrowed(whole) if *whole == short));
    let long = recorded(700, 300.0..540.0);
    assert!(matches!(liveliest_part(&long, Role::AirGapTorque), Cow::Borrowed(_)));
}
