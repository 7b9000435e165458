//! Findings of the thesis (Glans & Kärnell, Chalmers EX112/2018), repeated at the virtual bench, from recordings alone
//! wherever the thesis had no more.

use std::f64::consts::TAU;
use std::sync::OnceLock;

use demo::effects::{Effects, ShaftZeros, ShownTrace, Spectrum};
use faer::c64;
use rig::bench_parameters::BenchParameters;
use rig::experiment::{ExperimentPlan, Waveform};
use virtual_bench::{Numerics, simulate};

use bench_testkit::benches::default_bench;
use bench_testkit::runs::{amplitude, clean, mean, run, samples};

/// The truth of the shaft's zero, rad/s.
const ZERO: f64 = -2437.7 / 5.8;

/// The figures of the default bench.
fn effects() -> &'static Effects {
    static EFFECTS: OnceLock<Effects> = OnceLock::new();
    EFFECTS.get_or_init(|| Effects::of(&BenchParameters::default(), 11).unwrap())
}

/// A line by correlation with a Hann-weighted rotation, of a channel whose first sample is at `start_s`.
fn line(x: &[f64], start_s: f64, sample_time_s: f64, frequency_hz: f64) -> c64 {
    let (average, n) = (mean(x), x.len() as f64);
    let terms = x.iter().enumerate().map(|(k, x)| {
        let window = 1.0 - (TAU * (k as f64 + 0.5) / n).cos();
        c64::cis(-TAU * frequency_hz * (start_s + sample_time_s * k as f64)) * (2.0 * window / n * (x - average))
    });
    terms.fold(c64::new(0.0, 0.0), |sum, term| sum + term)
}

#[test]
fn stat_sines_resonate_at_18_hz_and_gain_less_than_one_below() {
    let gains = &effects().gains;
    println!("{:.3?}", gains.gain);
    let at = |hz: f64| gains.gain[gains.frequency_hz.iter().position(|f| *f == hz).unwrap()];
    let peak = gains.frequency_hz.iter().copied().max_by(|a, b| at(*a).total_cmp(&at(*b)));
    assert_eq!(peak, Some(18.0));
    assert!((3..=8).all(|hz| at(f64::from(hz)) < 0.5), "{gains:?}");
    // Between the engine's speed control and the resonance, J_e/(J_d + J_e) over 1 − (f/f_0)².
    let expected = 0.28 / 0.88 / (1.0 - (5.0 / 17.98_f64).powi(2));
    assert!((at(5.0) / expected - 1.0).abs() < 0.1 && (gains.at_rest - 0.28 / 0.88).abs() < 1e-12, "{gains:?}");
    // The amplitude that trips a bench at 18 Hz does not below it.
    assert!(at(18.0) > 2.0 * at(10.0), "{gains:?}");
}

#[test]
fn stat_firing_lines_follow_the_speed() {
    for (speed_rpm, firing_hz) in [(1200.0, 40.0), (3000.0, 100.0), (4500.0, 150.0)] {
        let mut plan = ExperimentPlan::bs_t_nt(speed_rpm, 20.0);
        plan.engine_torque_nm = Waveform::Constant { value: 45.0 };
        let recording = simulate(&BenchParameters::default(), &plan, 11).unwrap();
        let speed = samples(&recording, "EngineSpeed");
        let line = |hz| amplitude(speed, 2e-3, hz);
        let strongest = (1..250).map(f64::from).max_by(|a, b| line(*a).total_cmp(&line(*b)));
        assert_eq!(strongest, Some(firing_hz), "{speed_rpm} rpm");
        // Unequal cylinders: half and a quarter of it stand out too.
        for part in [2.0, 4.0] {
            let beside = line(firing_hz / part + 3.3);
            assert!(line(firing_hz / part) > 3.0 * beside, "{speed_rpm} rpm, 1/{part}");
        }
    }
}

#[test]
fn stat_firing_at_4500_rpm_folds_from_150_to_100_hz() {
    let mut parameters = BenchParameters::default();
    // Without the drive's own 100 Hz, which is at the same place.
    parameters.drive.additive_ripple_nm = 0.0;
    parameters.drive.multiplicative_ripple = 0.0;
    let mut plan = ExperimentPlan::bs_t_nt(4500.0, 20.0);
    plan.engine_torque_nm = Waveform::Constant { value: 45.0 };
    let recording = simulate(&parameters, &plan, 11).unwrap();
    let folded = amplitude(samples(&recording, "ShaftTorqueCalc"), 4e-3, 100.0);
    parameters.clocks.torque_decimation = 1;
    let recording = simulate(&parameters, &plan, 11).unwrap();
    let fast = |hz| amplitude(samples(&recording, "ShaftTorqueCalc"), 1e-3, hz);
    println!("at 250 Hz: {folded} Nm at 100 Hz; at 1 kHz: {} Nm at 150 Hz, {} Nm at 100 Hz", fast(150.0), fast(100.0));
    assert!((folded / fast(150.0) - 1.0).abs() < 0.1 && folded > 20.0 * fast(100.0), "{folded}");
    // Once a turn, 75 Hz, is below the Nyquist frequency and stays.
    assert!(fast(75.0) > 3.0 * fast(83.0), "{} {}", fast(75.0), fast(83.0));
}

/// Lines of T_d* and T_d,calc, both at 1 kHz, at 92 and 108 Hz, with a demand of 60 Nm and 8 Nm at 8 Hz.
fn side_lines(hold_s: f64, multiplicative_ripple: f64, additive_ripple_nm: f64) -> [[f64; 2]; 2] {
    let mut parameters = clean();
    parameters.controller.demand_hold_s = hold_s;
    parameters.drive.multiplicative_ripple = multiplicative_ripple;
    parameters.drive.additive_ripple_nm = additive_ripple_nm;
    parameters.clocks.torque_decimation = 1;
    let mut plan = ExperimentPlan::sine_t_tn(1200.0, 10.0);
    plan.dyno_torque_nm = Waveform::SineLadder { mean: 60.0, amplitude: 8.0, frequencies_hz: vec![8.0], dwell_s: 10.0 };
    let recording = simulate(&parameters, &plan, 11).unwrap();
    ["DynoTorqueDemand", "DynoTorqueCalc"]
        .map(|name| [92.0, 108.0].map(|hz| amplitude(samples(&recording, name), 1e-3, hz)))
}

#[test]
fn exact_lines_at_100_hz_plus_and_minus_f_have_two_causes_that_t_d_star_tells_apart() {
    // A demand held for 10 ms has its images in T_d* itself, of size |sinc|.
    let [demand, torque] = side_lines(0.01, 0.0, 0.0);
    let image = |hz: f64| 8.0 * (std::f64::consts::PI * hz / 100.0).sin().abs() / (std::f64::consts::PI * hz / 100.0);
    let lag = |hz: f64| 1.0 / 1f64.hypot(hz / 90.0);
    for (i, hz) in [92.0, 108.0].into_iter().enumerate() {
        println!("held demand, {hz} Hz: T_d* {} Nm, T_d {} Nm", demand[i], torque[i]);
        assert!((demand[i] / image(hz) - 1.0).abs() < 0.02, "{hz} Hz: {}, {}", demand[i], image(hz));
        assert!((torque[i] / image(hz) / lag(hz) - 1.0).abs() < 0.02, "{hz} Hz: {}", torque[i]);
    }
    // A multiplicative ripple puts r_m A/2 in T_d and nothing in T_d*.
    let [demand, torque] = side_lines(0.001, 0.03, 0.0);
    println!("ripple: T_d* {demand:?} Nm, T_d {torque:?} Nm");
    assert!(demand.iter().all(|line| *line < 0.01), "{demand:?}");
    assert!(torque.iter().all(|line| (line / 0.12 - 1.0).abs() < 0.05), "{torque:?}");
    // An additive one alone makes no such lines.
    let [demand, torque] = side_lines(0.001, 0.0, 1.2);
    assert!(demand.iter().chain(&torque).all(|line| *line < 0.01), "{demand:?} {torque:?}");
}

#[test]
fn exact_load_cell_is_late_and_computed_torque_within_a_sample() {
    let recording = simulate(&BenchParameters::default(), &ExperimentPlan::step_t_tn(1200.0, 4.0), 11).unwrap();
    let rises_s = |name: &str, sample_time_s: f64| {
        samples(&recording, name).iter().position(|t| *t > 72.5).unwrap() as f64 * sample_time_s
    };
    let demand_s = rises_s("DynoTorqueDemand", 1e-3);
    let calc_s = rises_s("DynoTorqueCalc", 4e-3) - demand_s;
    let cell_s = rises_s("DynoTorqueMeas", 4e-3) - demand_s;
    println!("T_d,calc {calc_s} s, T_d,meas {cell_s} s after T_d*");
    assert!((0.0..=0.004 + 1e-9).contains(&calc_s), "{calc_s} s");
    assert!((0.008..0.020).contains(&cell_s), "{cell_s} s");
    // The load cell rings near 75 Hz; T_d,calc does not.
    let ring = |name| {
        let step = &samples(&recording, name)[502..540];
        step.iter().copied().fold(0.0, f64::max) - 85.0
    };
    assert!(ring("DynoTorqueMeas") > 5.0 && ring("DynoTorqueCalc") < 5.0);
}

#[test]
fn exact_shaft_torque_of_the_system_is_late_by_7_5_ms() {
    let mut parameters = clean();
    parameters.engine.firing_harmonics.clear();
    parameters.engine.cylinder_factors.fill(1.0);
    parameters.engine.cycle_variation = 0.0;
    let mut plan = ExperimentPlan::sine_t_tn(1200.0, 20.0);
    plan.dyno_torque_nm = Waveform::SineLadder { mean: 60.0, amplitude: 8.0, frequencies_hz: vec![3.0], dwell_s: 20.0 };
    let run = run(&parameters, &plan, Numerics::default());
    let (shaft, calc) = (samples(&run.recording, "ShaftTorqueCalc"), samples(&run.recording, "DynoTorqueCalc"));
    let inertia_part: Vec<f64> = shaft.iter().zip(calc).map(|(shaft, calc)| shaft - calc).collect();
    let hidden = &run.hidden;
    let truth: Vec<f64> = hidden.shaft_torque_nm.iter().zip(&hidden.air_gap_torque_nm).map(|(s, d)| s - d).collect();
    let (found, truth) = (line(&inertia_part[2500..], 0.0, 4e-3, 3.0), line(&truth[10_000..], 0.0, 1e-3, 3.0));
    let late_s = -(found / truth).arg() / (TAU * 3.0);
    // 7.5 ms of the average, half a gate of 1 ms, half an update of the difference quotient.
    assert!((late_s - 0.0085).abs() < 1e-4, "late by {late_s} s");
}

#[test]
fn stat_the_naive_zero_of_the_shaft_scatters_and_the_projects_does_not() {
    let zeros = ShaftZeros::of(&BenchParameters::default(), &default_bench(), 11).unwrap();
    println!("{zeros:.0?}");
    assert!((zeros.truth - ZERO).abs() < 1e-9);
    for (estimate, low, high) in &zeros.estimated {
        assert!((estimate / ZERO - 1.0).abs() < 0.05 && low < estimate && estimate < high, "{zeros:?}");
    }
    // The thesis found −550 to −300.
    let naive = || zeros.naive.iter().flat_map(|band| band.zero.iter().copied());
    let (lowest, highest) = (naive().fold(f64::INFINITY, f64::min), naive().fold(f64::NEG_INFINITY, f64::max));
    assert!(lowest < -520.0 && highest > -340.0, "{zeros:?}");
}

#[test]
fn stat_the_figures_of_the_effects_show_them() {
    let effects = effects();
    let at = |spectrum: &Spectrum, hz: f64| {
        let near = |k: &usize| (spectrum.frequency_hz[*k] - hz).abs() < 0.15;
        (0..spectrum.amplitude.len()).filter(near).map(|k| spectrum.amplitude[k]).fold(0.0, f64::max)
    };
    for (spectrum, hz) in effects.firing.iter().zip([40.0, 100.0, 150.0]) {
        assert!(at(spectrum, hz) >= spectrum.amplitude.iter().copied().fold(0.0, f64::max), "{}", spectrum.name);
    }
    let [fast, slow] = [&effects.folding[0], &effects.folding[1]];
    assert!(at(slow, 100.0) > 10.0 * at(fast, 100.0) && (at(slow, 100.0) / at(fast, 150.0) - 1.0).abs() < 0.1);
    // Held: the lines are in T_d* too. Ripple: they are in T_d alone.
    let lines: Vec<f64> = effects.side_lines.iter().map(|spectrum| at(spectrum, 92.0)).collect();
    assert!(lines[0] > 0.5 && lines[1] > 0.3 && lines[2] < 0.02 && lines[3] > 0.1, "{lines:?}");
    let rises_s = |trace: &ShownTrace| {
        let half = 0.5 * (trace.values[0] + trace.values[trace.values.len() - 1]);
        let index = trace.values.iter().position(|t| *t > half).unwrap();
        trace.start_s + index as f64 * trace.sample_time_s
    };
    let rises: Vec<f64> = effects.step.iter().map(rises_s).collect();
    assert!(rises[0].abs() < 1e-9 && rises[1] < 0.0041 && rises[2] > 0.008, "{rises:?}");
    assert_eq!(effects.shaft_torque.len(), 2);
}
