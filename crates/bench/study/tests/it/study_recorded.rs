//! The study of two simulated benches, recorded by a simulator that shares no code with the project, where their
//! recordings are present beside it.

use bench_model::replay::Replay;
use recording::Recording;
use rig::results::{Estimate, Quantity, WrittenParameter};
use study::{Source, Study};

use crate::study::studied;
use bench_testkit::benches::bench_file;
use bench_testkit::recordings::recordings;

fn sources(bench: &str) -> Vec<Source> {
    let source =
        |(file, recording): (String, Recording)| Source { sha256: file.clone(), file, recording: Ok(recording) };
    recordings(bench).into_iter().map(source).collect()
}

/// In the unit people read.
fn parameter(estimate: &Estimate, quantity: Quantity) -> WrittenParameter {
    let found = estimate.parameter(quantity).unwrap_or_else(|| panic!("{quantity} is missing")).written();
    println!("{quantity} = {} ± {} {:?}", found.value, found.standard_error, found.interval);
    found
}

/// A parameter within `tolerance` of the truth.
fn near(estimate: &Estimate, quantity: Quantity, truth: f64, tolerance: f64) {
    let found = parameter(estimate, quantity);
    assert!((found.value - truth).abs() < tolerance, "{found:?}");
}

/// A parameter within `tolerance` of the truth, which lies in its interval.
fn covered(estimate: &Estimate, quantity: Quantity, truth: f64, tolerance: f64) {
    near(estimate, quantity, truth, tolerance);
    let (low, high) = parameter(estimate, quantity).interval;
    assert!(low <= truth && truth <= high, "{quantity}: {truth} is not in {low} … {high}");
}

fn fit_percent(replay: &Replay, quantity: &str) -> f64 {
    replay.signals.iter().find(|v| v.quantity == quantity).unwrap().fit_percent
}

fn print_replays(study: &Study) {
    for replay in &study.replays {
        let fits: Vec<String> =
            replay.signals.iter().map(|v| format!("{} {:.1} %", v.quantity, v.fit_percent)).collect();
        println!("{} (seen: {}): {}", replay.stretch.file, replay.seen_in_estimation, fits.join(", "));
    }
}

#[test]
fn ref_bench_a_is_written_as_it_was_simulated() {
    let sources = sources("bench-a");
    if sources.is_empty() {
        return;
    }
    let study = studied(&bench_file("0.6", "0.28", "400 Nm", bench_testkit::recordings::BENCH_A), sources);
    print_replays(&study);
    let shaft = &study.shaft.estimated().unwrap().estimate;
    // That simulator integrates in steps of h = 50 µs, semi-implicitly: the torque of a step rests on the twist before
    // it, which is worth half a step of skew and B + K h/2 of damping, more than the intervals of 28 s are wide.
    near(shaft, Quantity::Stiffness, 2437.7, 2e-3 * 2437.7);
    covered(shaft, Quantity::Damping, 5.8 + 2437.7 * 25e-6, 0.01 * 5.8);
    near(shaft, Quantity::EngineSpeedSkew, 0.0, 50e-6);
    covered(shaft, Quantity::AirGapTorqueSkew, 0.0, 1e-4);
    let controller = &study.speed_controller.estimated().unwrap().estimate;
    near(controller, Quantity::ProportionalGain, 0.9385, 1e-3);
    near(controller, Quantity::IntegralGain, 1.865, 1e-2);
    near(controller, Quantity::ControllerDelay, 1e-3, 5e-5);
    let feed_forward = &study.feed_forward.estimated().unwrap().estimate;
    near(feed_forward, Quantity::SpeedFeedForward, 0.012, 0.02 * 0.012);
    near(feed_forward, Quantity::AccelerationFeedForward, -0.085, 0.02 * 0.085);
    let torque_control = &study.torque_control.estimated().unwrap().delay_and_lag;
    near(torque_control, Quantity::TorqueControlTotalDelay, 3.018e-3, 3e-4);
}

#[test]
fn ref_bench_a_replays_what_it_has_not_seen() {
    let sources = sources("bench-a");
    if sources.is_empty() {
        return;
    }
    let study = studied(&bench_file("0.6", "0.28", "400 Nm", bench_testkit::recordings::BENCH_A), sources);
    print_replays(&study);
    let files: Vec<&str> = study.replays.iter().map(|r| r.stretch.file.as_str()).collect();
    assert_eq!(&files[..2], ["BS_T_NT_3000.mf4", "Ramp_N_NT_1200.mf4"]);
    assert!(fit_percent(&study.replays[0], "T_d") > 95.0);
}

#[test]
fn ref_bench_b_agrees_with_itself() {
    let sources = sources("bench-b");
    if sources.is_empty() {
        return;
    }
    let names = ["nBremse", "nMotor", "nBremse_Soll", "MdBremse_Soll", "MdLuftspalt", "MdKraftdose", "MdWelle"];
    let study = studied(&bench_file("0.41", "0.19", "260 Nm", names), sources);
    print_replays(&study);
    near(&study.speed_controller.estimated().unwrap().estimate, Quantity::ProportionalGain, 1.22, 0.0122);
    let shaft = study.shaft.estimated().unwrap();
    let own = parameter(&shaft.estimate, Quantity::Stiffness);
    for (file, other) in &shaft.cross_checks {
        println!("{file}");
        let other = parameter(other, Quantity::Stiffness);
        let spread = own.standard_error.hypot(other.standard_error);
        assert!((own.value - other.value).abs() < 4.0 * spread, "{file}: {other:?} against {own:?}");
    }
    assert!(!shaft.cross_checks.is_empty());
}
