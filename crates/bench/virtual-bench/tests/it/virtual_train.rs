//! The virtual bench's train: three masses, twist, backlash, stiffening, loss factor, friction; and its step error.

use std::f64::consts::TAU;

use faer::c64;
use rig::bench_parameters::{BenchParameters, DualMassFlywheel, DynoTwist, LossFactor};
use rig::experiment::{ExperimentPlan, Waveform};
use units::RPM_RAD_S;
use virtual_bench::{HiddenTruth, Numerics, VirtualBenchError, simulate};

use bench_testkit::runs::{clean, run, smooth};

const TWIST: DynoTwist =
    DynoTwist { coupling_inertia_kg_m2: 0.1, stiffness_nm_per_rad: 4e4, damping_nm_s_per_rad: 3.0 };
const RUBBER: LossFactor = LossFactor { loss_factor: 0.12, reference_hz: 18.0, lowest_hz: 2.0, highest_hz: 100.0 };

/// A motored bench in balance, its torque demand a sine: nothing but T_d moves it.
fn sine(frequency_hz: f64, amplitude: f64) -> ExperimentPlan {
    let mut plan = ExperimentPlan::sine_t_tn(1200.0, 10.0);
    plan.is_motored = true;
    plan.settling_s = 0.0;
    let frequencies_hz = vec![frequency_hz];
    plan.dyno_torque_nm = Waveform::SineLadder { mean: -15.8, amplitude, frequencies_hz, dwell_s: 10.0 };
    plan
}

fn without_pulsation() -> BenchParameters {
    let mut parameters = smooth();
    parameters.engine.motored_pulsation = 0.0;
    parameters
}

/// A line by correlation with a Hann-weighted rotation, over the second half.
fn line(x: &[f64], sample_time_s: f64, frequency_hz: f64) -> c64 {
    let x = &x[x.len() / 2..];
    let (average, n) = (x.iter().sum::<f64>() / x.len() as f64, x.len() as f64);
    let terms = x.iter().enumerate().map(|(k, x)| {
        let window = 0.5 - 0.5 * (TAU * (k as f64 + 0.5) / n).cos();
        c64::cis(-TAU * frequency_hz * sample_time_s * k as f64) * (window * (x - average))
    });
    terms.fold(c64::new(0.0, 0.0), |sum, term| sum + term)
}

/// T_shaft/T_d of a chain by impedances: connection i has Z = (K + Bs)/s, mass i J s.
fn chain_gain(inertias: &[f64], connections: &[(f64, f64)], shaft: usize, frequency_hz: f64) -> c64 {
    let s = c64::new(0.0, TAU * frequency_hz);
    let mut beyond = vec![c64::new(0.0, 0.0); inertias.len()];
    for (i, (stiffness, damping)) in connections.iter().enumerate().rev() {
        let z = (s * *damping + *stiffness) / s;
        beyond[i] = z / (z / (s * inertias[i + 1] + beyond[i + 1]) + 1.0);
    }
    (0..=shaft).map(|i| beyond[i] / (s * inertias[i] + beyond[i])).product()
}

fn is_gain(parameters: &BenchParameters, inertias: &[f64], connections: &[(f64, f64)], shaft: usize) {
    for frequency_hz in [3.0, 8.0, 17.0, 31.0, 44.0] {
        let hidden = run(parameters, &sine(frequency_hz, 8.0), Numerics::default()).hidden;
        let of = |x: &[f64]| line(x, hidden.sample_time_s, frequency_hz);
        let gain = of(&hidden.shaft_torque_nm) / of(&hidden.air_gap_torque_nm);
        let expected = chain_gain(inertias, connections, shaft, frequency_hz);
        let error = (gain - expected).norm() / expected.norm();
        assert!(error < 2e-3, "{frequency_hz} Hz: {gain}, {expected}");
    }
}

#[test]
fn exact_flywheel_makes_three_masses() {
    let mut parameters = without_pulsation();
    parameters.mechanics.flywheel = Some(DualMassFlywheel::default());
    is_gain(&parameters, &[0.6, 0.08, 0.2], &[(2437.7, 5.8), (650.0, 2.5)], 0);
}

#[test]
fn exact_twist_of_the_dynamometer_makes_one_mass_more() {
    let mut parameters = without_pulsation();
    parameters.mechanics.dyno_twist = Some(TWIST);
    is_gain(&parameters, &[0.5, 0.1, 0.28], &[(4e4, 3.0), (2437.7, 5.8)], 1);
    parameters.mechanics.flywheel = Some(DualMassFlywheel::default());
    is_gain(&parameters, &[0.5, 0.1, 0.08, 0.2], &[(4e4, 3.0), (2437.7, 5.8), (650.0, 2.5)], 1);
}

#[test]
fn exact_resonance_of_the_truth_is_where_the_gain_is_largest() {
    let two_masses = virtual_bench::Truth::of(&BenchParameters::default()).resonance_hz;
    // ω² = 2Kμ/(1 + √(1 + 2B²μ/K)), μ = 1/J_d + 1/J_e.
    let mobility = 1.0 / 0.6 + 1.0 / 0.28;
    let squared = 2.0 * 2437.7 * mobility / (1.0 + (1.0 + 2.0 * 5.8 * 5.8 * mobility / 2437.7_f64).sqrt());
    assert!((two_masses - squared.sqrt() / TAU).abs() < 1e-6, "{two_masses}");
    let mut parameters = without_pulsation();
    parameters.mechanics.dyno_twist = Some(TWIST);
    parameters.mechanics.flywheel = Some(DualMassFlywheel::default());
    let inertias = [0.5, 0.1, 0.08, 0.2];
    let gain = |hz| chain_gain(&inertias, &[(4e4, 3.0), (2437.7, 5.8), (650.0, 2.5)], 1, hz).norm();
    let found = virtual_bench::Truth::of(&parameters).resonance_hz;
    println!("four masses resonate at {found} Hz");
    assert!((10..2000).map(|k| 0.1 * f64::from(k)).all(|hz| gain(hz) <= gain(found) * (1.0 + 1e-9)));
}

/// Complex stiffness of the shaft at one frequency: T_shaft over the twist, which is Δω/(iω).
fn complex_stiffness(parameters: &BenchParameters, frequency_hz: f64) -> c64 {
    let hidden = run(parameters, &sine(frequency_hz, 8.0), Numerics::default()).hidden;
    let slip: Vec<f64> = hidden.engine_speed_rad_s.iter().zip(&hidden.dyno_speed_rad_s).map(|(e, d)| e - d).collect();
    let of = |x: &[f64]| line(x, hidden.sample_time_s, frequency_hz);
    of(&hidden.shaft_torque_nm) * c64::new(0.0, TAU * frequency_hz) / of(&slip)
}

#[test]
fn exact_loss_factor_holds_over_its_band() {
    let mut parameters = without_pulsation();
    parameters.mechanics.shaft_damping_nm_s_per_rad = 0.0;
    parameters.mechanics.shaft_loss = Some(RUBBER);
    for frequency_hz in [3.0, 6.0, 11.0, 18.0, 30.0, 45.0] {
        let stiffness = complex_stiffness(&parameters, frequency_hz);
        let loss = stiffness.im / stiffness.re;
        println!("{frequency_hz} Hz: {stiffness}, loss factor {loss}");
        assert!((loss / 0.12 - 1.0).abs() < 0.04, "{frequency_hz} Hz: {loss}");
        assert!((stiffness.re / 2437.7 - 1.0).abs() < 0.15, "{frequency_hz} Hz: {}", stiffness.re);
        if frequency_hz == 18.0 {
            assert!((loss / 0.12 - 1.0).abs() < 1e-3 && (stiffness.re / 2437.7 - 1.0).abs() < 1e-3, "{stiffness}");
        }
    }
}

#[test]
fn exact_stiffening_follows_its_cubic() {
    let mut parameters = without_pulsation();
    parameters.mechanics.shaft_stiffening_nm_per_rad3 = 4e6;
    let fine = Numerics { steps_per_update: 20, steps_per_hidden_sample: Some(1) };
    let hidden = run(&parameters, &sine(17.0, 30.0), fine).hidden;
    // From rest at −15.8 Nm on, the twist is the integral of the slip.
    let mut twist_rad = {
        let mut twist: f64 = -15.8 / 2437.7;
        (0..60).for_each(|_| twist -= (2437.7 * twist + 4e6 * twist.powi(3) + 15.8) / (2437.7 + 12e6 * twist * twist));
        twist
    };
    let slip = |k: usize| hidden.engine_speed_rad_s[k] - hidden.dyno_speed_rad_s[k];
    let mut largest: f64 = 0.0;
    for k in 0..20_000 {
        let expected_nm = (2437.7 + 4e6 * twist_rad * twist_rad) * twist_rad + 5.8 * slip(k);
        largest = largest.max((hidden.shaft_torque_nm[k] - expected_nm).abs());
        twist_rad += 0.5 * (slip(k) + slip(k + 1)) * hidden.sample_time_s;
    }
    assert!(largest < 1e-3, "{largest} Nm");
}

/// A fired engine whose torque reverses again and again.
fn reversing() -> ExperimentPlan {
    let mut plan = ExperimentPlan::bs_t_nt(1200.0, 1.0);
    plan.engine_torque_nm = Waveform::Square { first: 8.0, second: -12.0, dwell_s: 0.13 };
    plan.settling_s = 0.0;
    plan
}

#[test]
fn exact_no_torque_crosses_the_play() {
    let mut parameters = clean();
    parameters.mechanics.shaft_backlash_rad = 0.01;
    let fine = Numerics { steps_per_update: 20, steps_per_hidden_sample: Some(1) };
    let hidden = run(&parameters, &reversing(), fine).hidden;
    let free = hidden.shaft_torque_nm.iter().filter(|t| t.abs() < 1e-9).count() as f64;
    let share = free / hidden.shaft_torque_nm.len() as f64;
    assert!((0.05..0.9).contains(&share), "free for {share} of the time");
    let mut twist_rad: f64 = 0.005 + 8.0 / 2437.7;
    let (mut lowest, mut highest) = (0.0_f64, 0.0_f64);
    for k in 0..hidden.shaft_torque_nm.len() - 1 {
        if twist_rad.abs() < 0.0049 {
            assert!(hidden.shaft_torque_nm[k].abs() < 1e-9, "{} Nm at {twist_rad} rad", hidden.shaft_torque_nm[k]);
            (lowest, highest) = (lowest.min(twist_rad), highest.max(twist_rad));
        }
        let slip = |k: usize| hidden.engine_speed_rad_s[k] - hidden.dyno_speed_rad_s[k];
        twist_rad += 0.5 * (slip(k) + slip(k + 1)) * hidden.sample_time_s;
    }
    assert!(lowest < -0.0045 && highest > 0.0045, "{lowest} to {highest} rad");
}

#[test]
fn exact_everything_rests_where_it_starts() {
    let mut parameters = without_pulsation();
    parameters.mechanics.shaft_backlash_rad = 0.01;
    parameters.mechanics.shaft_stiffening_nm_per_rad3 = 2e6;
    parameters.mechanics.dyno_twist = Some(TWIST);
    parameters.mechanics.flywheel = Some(DualMassFlywheel::default());
    parameters.mechanics.coulomb_friction_nm = 1.5;
    parameters.mechanics.viscous_friction_nm_s_per_rad = 0.01;
    let mut plan = reversing();
    plan.engine_torque_nm = Waveform::Constant { value: 8.0 };
    plan.settling_s = 0.5;
    let hidden = run(&parameters, &plan, Numerics::default()).hidden;
    let off = |x: &[f64], rest: f64| x.iter().map(|x| (x - rest).abs()).fold(0.0, f64::max);
    assert!(off(&hidden.shaft_torque_nm, 8.0) < 1e-6, "{}", off(&hidden.shaft_torque_nm, 8.0));
    assert!(off(&hidden.dyno_speed_rad_s, 1200.0 * RPM_RAD_S) < 1e-8);
}

/// Largest differences of ω_e and T_shaft from one step size to its half.
fn difference(parameters: &BenchParameters, plan: &ExperimentPlan, steps: usize) -> (f64, f64) {
    let hidden = |n| run(parameters, plan, Numerics { steps_per_update: n, steps_per_hidden_sample: Some(n) }).hidden;
    let (coarse, fine): (HiddenTruth, HiddenTruth) = (hidden(steps), hidden(2 * steps));
    let largest = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
    let torque_nm = largest(&coarse.shaft_torque_nm, &fine.shaft_torque_nm);
    (largest(&coarse.engine_speed_rad_s, &fine.engine_speed_rad_s), torque_nm)
}

/// The error of 50 µs steps, and that from so many steps a millisecond on it falls with the square of the step.
fn is_of_second_order(name: &str, parameters: &BenchParameters, plan: &ExperimentPlan, (steps, most_nm): (usize, f64)) {
    let (_, error_nm) = difference(parameters, plan, 20);
    println!("{name}: {error_nm:e} Nm from 50 to 25 µs");
    assert!(error_nm < most_nm, "{name}: {error_nm} Nm");
    let (speed, torque_nm) = difference(parameters, plan, steps);
    let (speed_halved, torque_halved_nm) = difference(parameters, plan, 2 * steps);
    println!("{name}: {speed:e} rad/s, {torque_nm:e} Nm; halved {speed_halved:e} rad/s, {torque_halved_nm:e} Nm");
    assert!((2.8..6.0).contains(&(speed / speed_halved)), "{name}: {speed}, halved {speed_halved} rad/s");
    assert!((2.8..6.0).contains(&(torque_nm / torque_halved_nm)), "{name}: {torque_nm}, halved {torque_halved_nm} Nm");
}

/// Switches an option on.
type Set = fn(&mut BenchParameters);

#[test]
fn exact_every_option_of_the_shaft_converges_with_the_square_of_the_step() {
    let options: [(&str, usize, Set); 5] = [
        ("stiffening", 20, |p| p.mechanics.shaft_stiffening_nm_per_rad3 = 4e6),
        ("backlash", 80, |p| p.mechanics.shaft_backlash_rad = 0.01),
        ("loss factor", 20, |p| p.mechanics.shaft_loss = Some(RUBBER)),
        ("flywheel", 20, |p| p.mechanics.flywheel = Some(DualMassFlywheel::default())),
        ("twist", 20, |p| p.mechanics.dyno_twist = Some(TWIST)),
    ];
    for (name, steps, set) in options {
        let mut parameters = clean();
        set(&mut parameters);
        is_of_second_order(name, &parameters, &reversing(), (steps, 0.02));
    }
}

#[test]
fn exact_coulomb_friction_converges_with_the_square_of_the_step() {
    let mut parameters = clean();
    parameters.mechanics.coulomb_friction_nm = 1.5;
    let mut plan = ExperimentPlan::no_shaft_n_nt(0.0, 2.0);
    plan.settling_s = 0.0;
    plan.speed_rad_s = Waveform::Square { first: -0.3, second: 0.3, dwell_s: 0.4 };
    let reverses = run(&parameters, &plan, Numerics::default()).hidden;
    assert!(reverses.friction_torque_nm.contains(&1.5) && reverses.friction_torque_nm.contains(&-1.5));
    let difference = |steps| {
        let hidden =
            |n| run(&parameters, &plan, Numerics { steps_per_update: n, steps_per_hidden_sample: Some(n) }).hidden;
        let (coarse, fine) = (hidden(steps), hidden(2 * steps));
        let pairs = coarse.dyno_speed_rad_s.iter().zip(&fine.dyno_speed_rad_s);
        pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    };
    let (error, halved) = (difference(20), difference(40));
    println!("Coulomb friction: {error:e} rad/s, halved {halved:e} rad/s");
    assert!((2.5..7.0).contains(&(error / halved)), "{error}, halved {halved}");
}

#[test]
fn regress_impossible_trains_are_refused() {
    let refused = |set: fn(&mut BenchParameters)| {
        let mut parameters = BenchParameters::default();
        set(&mut parameters);
        let result = simulate(&parameters, &ExperimentPlan::bs_t_nt(1200.0, 1.0), 1);
        assert!(matches!(result, Err(VirtualBenchError::Parameter(_))), "{parameters:?}");
    };
    refused(|p| p.mechanics.shaft_backlash_rad = -0.01);
    refused(|p| p.mechanics.shaft_stiffening_nm_per_rad3 = f64::NAN);
    refused(|p| p.mechanics.dyno_twist = Some(DynoTwist { coupling_inertia_kg_m2: 0.6, ..TWIST }));
    refused(|p| {
        p.mechanics.flywheel = Some(DualMassFlywheel { secondary_inertia_kg_m2: 0.3, ..DualMassFlywheel::default() });
    });
    refused(|p| p.mechanics.shaft_loss = Some(LossFactor { loss_factor: 0.9, ..RUBBER }));
    refused(|p| {
        p.mechanics.shaft_loss = Some(RUBBER);
        p.mechanics.shaft_backlash_rad = 0.01;
    });
}
