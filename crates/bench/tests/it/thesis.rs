//! What the thesis found at its bench, found at the virtual one (Glans & Kärnell, Chalmers EX112/2018), from recordings
//! alone wherever the thesis had no more.

use std::f64::consts::TAU;

use bench::study::Source;
use bench::units::RPM_RAD_S;
use bench::virtual_bench::{
    BenchParameters, Effects, ExperimentPlan, Numerics, ShownTrace, Spectrum, Waveform, simulate,
};
use faer::c64;
use recording::Recording;
use signal::filter::Sos;

use crate::study::{bench_file, studied};
use crate::support::BENCH_A;
use crate::virtual_bench::{amplitude, clean, mean, run, samples};

/// The truth of the shaft's zero, rad/s.
const ZERO: f64 = -2437.7 / 5.8;

/// A line by correlation with a Hann-weighted rotation, of a channel whose first sample is at `start_s`.
fn line(x: &[f64], start_s: f64, sample_time_s: f64, frequency_hz: f64) -> c64 {
    let (average, n) = (mean(x), x.len() as f64);
    let terms = x.iter().enumerate().map(|(k, x)| {
        let window = 1.0 - (TAU * (k as f64 + 0.5) / n).cos();
        c64::cis(-TAU * frequency_hz * (start_s + sample_time_s * k as f64)) * (2.0 * window / n * (x - average))
    });
    terms.fold(c64::new(0.0, 0.0), |sum, term| sum + term)
}

/// The gain from T_d to T_shaft at each sine of a ladder of 1, 2, … Hz, 6 s each, T_shaft = J_d dω_d/dt + T_d.
fn ladder_gains(recording: &Recording) -> Vec<f64> {
    let (speed, torque) = (samples(recording, "DynoSpeed"), samples(recording, "DynoTorqueCalc"));
    let gain = |rung: usize| {
        let frequency_hz = (rung + 1) as f64;
        // The first second of each sine is left to the transient.
        let (from, to) = (6000 * rung + 1000, 6000 * (rung + 1));
        let speed = line(&speed[from..to], from as f64 * 1e-3 - 5e-4, 1e-3, frequency_hz) * RPM_RAD_S;
        let torque = line(&torque[from / 4..to / 4], from as f64 * 1e-3, 4e-3, frequency_hz);
        let shaft = speed * c64::new(0.0, 0.6 * TAU * frequency_hz) + torque;
        shaft.norm() / torque.norm()
    };
    (0..speed.len() / 6000).map(gain).collect()
}

#[test]
fn stat_sines_resonate_at_18_hz_and_gain_less_than_one_below() {
    // At 3000 rpm the engine's orders, 0.5 the lowest, lie above the ladder.
    let mut plan = ExperimentPlan::sine_t_tn(3000.0, 132.0);
    plan.dyno_torque_nm = Waveform::SineLadder {
        mean: 60.0,
        amplitude: 8.0,
        frequencies_hz: (1..=22).map(f64::from).collect(),
        dwell_s: 6.0,
    };
    let recording = simulate(&BenchParameters::default(), &plan, 11).unwrap();
    let gains = ladder_gains(&recording);
    println!("{gains:.3?}");
    let peak = (0..gains.len()).max_by(|a, b| gains[*a].total_cmp(&gains[*b])).map(|rung| rung + 1);
    assert_eq!(peak, Some(18));
    assert!(gains[2..8].iter().all(|gain| *gain < 0.5), "{gains:?}");
    // Between the engine's speed control and the resonance, J_e/(J_d + J_e) over 1 − (f/f_0)².
    let expected = 0.28 / 0.88 / (1.0 - (5.0 / 17.98_f64).powi(2));
    assert!((gains[4] / expected - 1.0).abs() < 0.1, "{}, {expected}", gains[4]);
    // The amplitude that trips a bench at 18 Hz does not below it.
    assert!(gains[17] > 2.0 * gains[9], "{} {}", gains[17], gains[9]);
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
    parameters.inverter.additive_ripple_nm = 0.0;
    parameters.inverter.multiplicative_ripple = 0.0;
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
    parameters.inverter.multiplicative_ripple = multiplicative_ripple;
    parameters.inverter.additive_ripple_nm = additive_ripple_nm;
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
    let inverter = |hz: f64| 1.0 / 1f64.hypot(hz / 90.0);
    for (i, hz) in [92.0, 108.0].into_iter().enumerate() {
        println!("held demand, {hz} Hz: T_d* {} Nm, T_d {} Nm", demand[i], torque[i]);
        assert!((demand[i] / image(hz) - 1.0).abs() < 0.02, "{hz} Hz: {}, {}", demand[i], image(hz));
        assert!((torque[i] / image(hz) / inverter(hz) - 1.0).abs() < 0.02, "{hz} Hz: {}", torque[i]);
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

/// A channel on the clock of N_d, straight between samples, at the times its stamps say.
fn on_the_fast_clock(recording: &Recording, name: &str, count: usize) -> Vec<f64> {
    let channel = recording.channel(name).unwrap();
    let (x, time_s) = (&channel.samples, recording.time_s(channel).unwrap());
    let at = |k: usize| {
        let place = ((k as f64 * 1e-3 - time_s[0]) / (time_s[1] - time_s[0])).clamp(0.0, (x.len() - 2) as f64);
        let below = place.floor();
        x[below as usize] + (place - below) * (x[below as usize + 1] - x[below as usize])
    };
    (0..count).map(at).collect()
}

/// The zero −K/B of T_shaft/Δω = (K + Bs)/s as thesis §6.3.5.2 has it: T_shaft from differences of N_d and T_d,calc,
/// everything on one clock by interpolation, filtered, least squares.
fn naive_zero(recording: &Recording, filter: Option<&Sos>) -> f64 {
    let speed: Vec<f64> = samples(recording, "DynoSpeed").iter().map(|n| n * RPM_RAD_S).collect();
    let engine = on_the_fast_clock(recording, "EngineSpeed", speed.len());
    let torque = on_the_fast_clock(recording, "DynoTorqueCalc", speed.len());
    let slip: Vec<f64> = engine.iter().zip(&speed).map(|(n, d)| n * RPM_RAD_S - d).collect();
    let mut twist = vec![0.0; slip.len()];
    for k in 1..slip.len() {
        twist[k] = twist[k - 1] + 0.5e-3 * (slip[k] + slip[k - 1]);
    }
    let slope = |k: usize| (speed[(k + 1).min(speed.len() - 1)] - speed[k.saturating_sub(1)]) / 2e-3;
    let shaft: Vec<f64> = (0..speed.len()).map(|k| 0.6 * slope(k) + torque[k]).collect();
    let filtered = |x: Vec<f64>| {
        let average = mean(&x);
        let x: Vec<f64> = x.iter().map(|x| x - average).collect();
        filter.map_or_else(|| x.clone(), |filter| filter.filtfilt(&x).unwrap())
    };
    let (y, a, b) = (filtered(shaft), filtered(twist), filtered(slip));
    let inner = 500..y.len() - 500;
    let dot = |x: &[f64], y: &[f64]| inner.clone().map(|k| x[k] * y[k]).sum::<f64>();
    let (aa, ab, bb, ay, by) = (dot(&a, &a), dot(&a, &b), dot(&b, &b), dot(&a, &y), dot(&b, &y));
    let determinant = aa * bb - ab * ab;
    let (stiffness, damping) = ((bb * ay - ab * by) / determinant, (aa * by - ab * ay) / determinant);
    -stiffness / damping
}

/// Recordings of a bench whose engine speed is stamped late by a skew that nobody knows of.
fn skewed(engine_speed_skew_s: f64) -> Vec<(&'static str, Recording)> {
    let mut parameters = BenchParameters::default();
    parameters.clocks.engine_speed_skew_s = engine_speed_skew_s;
    let plans = [
        ("BS_T_NT_1200.mf4", ExperimentPlan::bs_t_nt(1200.0, 20.0)),
        ("WhiteNoise_T_TN_1200.mf4", ExperimentPlan::white_noise_t_tn(1200.0, 20.0)),
    ];
    plans.into_iter().map(|(file, plan)| (file, simulate(&parameters, &plan, 11).unwrap())).collect()
}

#[test]
fn stat_the_naive_zero_of_the_shaft_scatters_and_the_projects_does_not() {
    let low = Sos::butterworth_lowpass(4, 30.0, 1e-3).unwrap();
    let high = Sos::butterworth_highpass(4, 30.0, 1e-3).unwrap();
    let mut zeros = Vec::new();
    for skew_s in [-0.0005, 0.0005] {
        let recordings = skewed(skew_s);
        zeros.extend([Some(&low), None, Some(&high)].map(|filter| naive_zero(&recordings[0].1, filter)));
        let source = |(file, recording): (&str, Recording)| Source {
            file: file.to_owned(),
            sha256: "of the virtual bench".to_owned(),
            recording: Ok(recording),
        };
        let bench = bench_file("0.6", "0.28", "400 Nm", BENCH_A);
        let study = studied(&bench, recordings.into_iter().map(source).collect());
        let shaft = &study.shaft.estimated().unwrap().estimate;
        let (stiffness, damping) = (shaft.parameter("K").unwrap().value, shaft.parameter("B").unwrap().value);
        println!("skew {skew_s} s: estimate {} from K = {stiffness}, B = {damping}", -stiffness / damping);
        assert!((-stiffness / damping / ZERO - 1.0).abs() < 0.05, "{stiffness} {damping}");
        assert!((stiffness / 2437.7 - 1.0).abs() < 0.05 && (damping / 5.8 - 1.0).abs() < 0.05, "{stiffness} {damping}");
    }
    println!("naive zeros: {zeros:.0?}, truth {ZERO:.0}");
    let lowest = zeros.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = zeros.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert!(lowest < -520.0 && highest > -340.0, "{zeros:?}");
}

#[test]
fn stat_the_figures_of_the_effects_show_them() {
    let effects = Effects::of(&BenchParameters::default(), 11).unwrap();
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
