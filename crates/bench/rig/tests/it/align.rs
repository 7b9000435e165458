use std::collections::BTreeMap;

use rig::align::{common_window, cut, split_window};
use rig::{Experiment, Role};
use signal::Signal;

fn experiment() -> Experiment {
    let signal = |start_s, sample_time_s, count: u32| {
        Signal::new(start_s, sample_time_s, (0..count).map(f64::from).collect()).unwrap()
    };
    let signals = BTreeMap::from([
        (Role::DynoSpeed, signal(2.5, 0.001, 1001)),
        (Role::EngineSpeed, signal(2.5003, 0.002, 600)),
        (Role::AirGapTorque, signal(2.4, 0.004, 200)),
    ]);
    Experiment { file: "a".to_owned(), label: "BS_T_NT".parse().unwrap(), signals }
}

#[test]
fn exact_common_window() {
    let window = common_window(&experiment(), &[Role::DynoSpeed, Role::EngineSpeed, Role::AirGapTorque]).unwrap();
    assert!((window.0 - 2.5003).abs() < 1e-12 && (window.1 - (2.4 + 0.796)).abs() < 1e-12, "{window:?}");
    assert_eq!(common_window(&experiment(), &[Role::DynoSpeed, Role::Throttle]), None);
    assert_eq!(common_window(&experiment(), &[]), None);
}

#[test]
fn exact_cut_includes_both_edges() {
    let experiment = experiment();
    let speed = experiment.signal(Role::DynoSpeed).unwrap();
    let part = cut(speed, 2.6, 2.7);
    assert_eq!((part.samples.len(), part.samples[0], part.samples[100]), (101, 100.0, 200.0));
    assert!(cut(speed, 9.0, 10.0).samples.is_empty());
}

#[test]
fn exact_split_and_within() {
    let (first, second) = split_window((2.0, 4.0), 0.75);
    assert_eq!((first, second), ((2.0, 3.5), (3.5, 4.0)));
    let part = experiment().within((3.0, 3.3));
    assert_eq!(part.signals.len(), 3);
    assert!(part.signals.values().all(|signal| signal.start_s >= 3.0 - 1e-9 && signal.end_s() <= 3.3 + 1e-9));
    assert!(experiment().within((3.8, 3.9)).signals.is_empty());
}
