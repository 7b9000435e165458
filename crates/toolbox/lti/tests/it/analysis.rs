//! Responses in time, modes, frequency grids, margins.

use faer::mat;
use lti::{Complex64, LtiError, Margins, Mode, StateSpace, StepCharacteristics, TimeGrid, TransferFunction};
use proptest::prelude::*;

const STEP: [f64; 5] = [0.0, 0.2190787457722876, 0.5516301316789028, 0.5891414388353295, 0.4674680797928442];
const IMPULSE: [f64; 5] = [0.0, 0.7432575378692935, 0.4229993488488685, -0.2089176264760317, -0.1508133407253491];

fn second_order(w: f64, zeta: f64) -> TransferFunction {
    TransferFunction::continuous(vec![w * w], vec![1.0, 2.0 * zeta * w, w * w]).unwrap()
}

#[test]
fn exact_delayed_responses_of_a_lag() {
    let late = TransferFunction::continuous(vec![2.0], vec![0.5, 1.0]).unwrap().with_delay(0.37).unwrap();
    let grid = TimeGrid { step_s: 0.1, points: 30 };
    let (step, impulse) = (late.step_response(&grid).unwrap(), late.impulse_response(&grid).unwrap());
    for (k, t) in grid.times().into_iter().enumerate() {
        let since = t - 0.37;
        let (y, h) =
            if since < 0.0 { (0.0, 0.0) } else { (2.0 - 2.0 * (-2.0 * since).exp(), 4.0 * (-2.0 * since).exp()) };
        assert!((step[k] - y).abs() < 1e-13 && (impulse[k] - h).abs() < 1e-13, "at {t}");
    }
    let short = TimeGrid { step_s: 0.1, points: 2 };
    assert_eq!(
        (late.step_response(&short).unwrap(), late.impulse_response(&short).unwrap()),
        (vec![0.0; 2], vec![0.0; 2])
    );
    let none = TimeGrid { step_s: 0.1, points: 0 };
    assert!(late.step_response(&none).unwrap().is_empty() && late.impulse_response(&none).unwrap().is_empty());
}

#[test]
fn exact_responses_of_discrete_systems() {
    let late = TransferFunction::discrete(vec![1.0], vec![1.0, -0.5], 0.1).unwrap().with_delay(0.2).unwrap();
    let grid = TimeGrid { step_s: 0.1, points: 6 };
    assert_eq!(late.impulse_response(&grid).unwrap(), [0.0, 0.0, 0.0, 1.0, 0.5, 0.25]);
    assert_eq!(late.step_response(&grid).unwrap(), [0.0, 0.0, 0.0, 1.0, 1.5, 1.75]);
    let other = TimeGrid { step_s: 0.2, points: 6 };
    assert!(matches!(late.step_response(&other), Err(LtiError::SampleTimesDiffer { .. })));
    let fraction = late.with_delay(0.25).unwrap();
    assert!(matches!(fraction.step_response(&grid), Err(LtiError::FractionalDelay { .. })));
    let two = StateSpace::continuous(mat![[-1.0]], mat![[1.0, 2.0]], mat![[1.0], [3.0]], mat![[0.0, 1.0], [0.0, 0.0]]);
    let y = two.unwrap().step_response(1, &TimeGrid { step_s: 1.0, points: 2 }).unwrap();
    let rise = 2.0 * (1.0 - (-1.0_f64).exp());
    assert!(y[(0, 0)] == 1.0 && (y[(1, 0)] - 1.0 - rise).abs() < 1e-14 && (y[(1, 1)] - 3.0 * rise).abs() < 1e-14);
}

/// SciPy 1.17 `step` and `impulse` at 0, 0.5, … 2 s.
#[test]
fn ref_responses() {
    let system = TransferFunction::continuous(vec![2.0, 3.0], vec![1.0, 1.2, 9.0, 4.0]).unwrap();
    let grid = TimeGrid { step_s: 0.5, points: 5 };
    let close = |got: Vec<f64>, expected: [f64; 5]| got.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-13);
    assert!(close(system.step_response(&grid).unwrap(), STEP));
    assert!(close(system.impulse_response(&grid).unwrap(), IMPULSE));
}

#[test]
fn exact_characteristics_of_a_mode_and_of_a_wrong_way() {
    let (w, zeta) = (3.0, 0.25_f64);
    let mode = second_order(w, zeta);
    let grid = mode.time_grid().unwrap();
    let seen = StepCharacteristics::new(&grid.times(), &mode.step_response(&grid).unwrap(), 1.0).unwrap();
    let root = (1.0 - zeta * zeta).sqrt();
    let overshoot = 100.0 * (-std::f64::consts::PI * zeta / root).exp();
    assert!((seen.overshoot_percent - overshoot).abs() < 0.1, "{seen:?}");
    assert!((seen.peak_time_s - std::f64::consts::PI / (w * root)).abs() < 2.0 * grid.step_s);
    assert!(seen.undershoot_percent == 0.0 && seen.settling_time_s.unwrap() < 4.0 / (zeta * w));
    // (1 − s)/(1 + s): starts at −1.
    let wrong = TransferFunction::continuous(vec![-1.0, 1.0], vec![1.0, 1.0]).unwrap();
    let grid = wrong.time_grid().unwrap();
    let seen = StepCharacteristics::new(&grid.times(), &wrong.step_response(&grid).unwrap(), 1.0).unwrap();
    assert_eq!(seen.undershoot_percent, 100.0);
    // Falling, and one that does not arrive.
    let seen = StepCharacteristics::new(&[0.0, 1.0, 2.0], &[0.0, -1.0, -1.5], -2.0).unwrap();
    assert_eq!((seen.rise_time_s, seen.settling_time_s, seen.peak), (None, None, -1.5));
    assert!(StepCharacteristics::new(&[0.0, 1.0], &[0.0, 1.0], 0.0).is_none());
    assert!(StepCharacteristics::new(&[0.0, 1.0], &[0.0, f64::NAN], 1.0).is_none());
}

#[test]
fn exact_modes_of_continuous_and_discrete_poles() {
    let mode = second_order(50.0, 0.02);
    let sampled = mode.to_discrete(lti::Discretisation::ZeroOrderHold, 1e-3).unwrap();
    for modes in [mode.modes().unwrap(), sampled.modes().unwrap(), sampled.to_zero_pole_gain().unwrap().modes()] {
        assert_eq!(modes.len(), 2);
        assert!((modes[0].natural_frequency_rad_s - 50.0).abs() < 1e-8 && (modes[0].damping - 0.02).abs() < 1e-9);
        assert!((modes[0].time_constant_s() - 1.0).abs() < 1e-7);
    }
    let integrator = Mode::new(Complex64::ZERO, None);
    assert_eq!((integrator.natural_frequency_rad_s, integrator.time_constant_s()), (0.0, f64::INFINITY));
    assert_eq!(Mode::new(Complex64::ZERO, Some(0.1)).time_constant_s(), 0.0);
    assert_eq!(Mode::new(Complex64::new(2.0, 0.0), None).damping, -1.0);
}

#[test]
fn exact_grids_of_systems_with_little_to_go_by() {
    let of = |num: Vec<f64>, den: Vec<f64>, sample_time_s| TransferFunction::new(num, den, sample_time_s).unwrap();
    let hard = [
        of(vec![1.0], vec![1.0], None),
        of(vec![1.0], vec![1.0, 0.0, 0.0], None),
        of(vec![1.0], vec![1.0, 0.0, 0.0], Some(0.1)),
        of(vec![1.0], vec![1.0, -2.0, 1.0], Some(0.1)),
        of(vec![0.0], vec![1.0, 0.5], Some(0.1)),
        of(vec![1.0], vec![1.0, 0.0, 4.0], None),
        of(vec![1.0], vec![1.0, -3.0], None),
        of(vec![1.0], vec![1.0, 1.0 + 1e-9, 1e-9], None),
    ];
    for system in hard {
        let grid = system.frequency_grid(50).unwrap();
        assert!(grid.len() >= 50 && grid.windows(2).all(|p| p[0] < p[1]) && grid[0] > 0.0, "{system:?}: {grid:?}");
        let times = system.time_grid().unwrap();
        assert!(times.step_s > 0.0 && (2..=5001).contains(&times.points), "{times:?}");
        if system.sample_time_s().is_some() {
            assert_eq!(grid[grid.len() - 1], std::f64::consts::PI / 0.1);
        }
    }
}

#[test]
fn exact_light_modes_are_not_missed() {
    // Half widths of 1e-5 rad/s at 1 rad/s, between points a tenth of a decade apart.
    let mode = second_order(1.0, 1e-5);
    let grid = mode.frequency_grid(20).unwrap();
    let peak = mode.frequency_response(&grid).unwrap().peak(0.0, 10.0).unwrap();
    assert!((peak.magnitude / 5e4 - 1.0).abs() < 1e-3, "{peak:?}");
}

#[test]
fn exact_margins() {
    // 2/(s (s + 1)) behind 0.1 s: |L| = 1 at √((√17 − 1)/2).
    let delayed = TransferFunction::continuous(vec![2.0], vec![1.0, 1.0, 0.0]).unwrap().with_delay(0.1).unwrap();
    let margins = delayed.margins().unwrap();
    let w = (0.5 * (17_f64.sqrt() - 1.0)).sqrt();
    let phase = 90.0 - w.atan().to_degrees() - (0.1 * w).to_degrees();
    let seen = margins.phase[0];
    assert!((seen.omega_rad_s - w).abs() < 1e-9 && (seen.phase_deg - phase).abs() < 1e-8);
    assert!((seen.delay_s - phase.to_radians() / w).abs() < 1e-10);
    // With that delay more, the loop passes through −1.
    let limit = delayed.clone().with_delay(0.1 + seen.delay_s).unwrap();
    assert!((limit.evaluate(Complex64::new(0.0, w)) + 1.0).norm() < 1e-9);
    // 1/(z − 0.5) is −2/3 at the Nyquist frequency: the gain may grow by 1.5.
    let sampled = TransferFunction::discrete(vec![1.0], vec![1.0, -0.5], 0.1).unwrap().margins().unwrap();
    assert_eq!(sampled.gain.len(), 1);
    assert!((sampled.gain[0].gain_db - 20.0 * 1.5_f64.log10()).abs() < 1e-12);
    // An undamped pole turns the phase at once, which is no margin.
    let jump = TransferFunction::continuous(vec![-1.0, 1.0], vec![1.0, 0.0, 1.0]).unwrap().margins().unwrap();
    assert!(jump.gain.iter().all(|m| m.gain_db.is_finite()), "{jump:?}");
    // The gain of 1/(s (s + 5)) is one far below its roots, and 1/s² is real everywhere, which is no crossing.
    let low = TransferFunction::continuous(vec![1.0], vec![1.0, 5.0, 0.0]).unwrap();
    let w = (0.5 * (629_f64.sqrt() - 25.0)).sqrt();
    let found = Margins::new(&[1.0, 3.0, 9.0, 27.0], None, |w| low.evaluate(Complex64::new(0.0, w)));
    assert!((found.phase[0].omega_rad_s - w).abs() < 1e-9, "{found:?}");
    let double = TransferFunction::continuous(vec![1.0], vec![1.0, 0.0, 0.0]).unwrap().margins().unwrap();
    assert!(double.gain.is_empty() && double.phase.len() == 1, "{double:?}");
    let empty = Margins::new(&[], None, |_| Complex64::ONE);
    assert!(empty.gain.is_empty() && empty.phase.is_empty());
}

proptest! {
    #[test]
    fn prop_margins_put_the_loop_on_its_limit(gain in 0.5_f64..20.0, lag in 0.05_f64..2.0, delay in 0.01_f64..0.5) {
        let open = TransferFunction::continuous(vec![gain], vec![lag, 1.0, 0.0]).unwrap().with_delay(delay).unwrap();
        let margins = open.margins().unwrap();
        for margin in &margins.gain {
            let scaled = open.evaluate(Complex64::new(0.0, margin.omega_rad_s)) * 10_f64.powf(margin.gain_db / 20.0);
            prop_assert!((scaled + 1.0).norm() < 1e-5);
        }
        for margin in &margins.phase {
            let s = Complex64::new(0.0, margin.omega_rad_s);
            prop_assert!((open.evaluate(s) * (-s * margin.delay_s).exp() + 1.0).norm() < 1e-8);
        }
        prop_assert_eq!(margins.phase.len(), 1);
    }

    #[test]
    fn prop_step_response_settles_at_the_gain_at_rest(w in 0.01_f64..1e4, zeta in 0.1_f64..3.0) {
        let mode = second_order(w, zeta);
        let grid = mode.time_grid().unwrap();
        let y = mode.step_response(&grid).unwrap();
        prop_assert!((y[y.len() - 1] - 1.0).abs() < 0.01);
        let seen = StepCharacteristics::new(&grid.times(), &y, mode.dc_gain()).unwrap();
        prop_assert!(seen.rise_time_s.is_some() && seen.settling_time_s.is_some());
    }
}

#[test]
fn exact_a_common_grid_spans_every_system_and_its_nyquist_frequency() {
    let slow = TransferFunction::continuous(vec![1.0], vec![100.0, 1.0]).unwrap().to_state_space().unwrap();
    let fast = TransferFunction::discrete(vec![0.1], vec![1.0, -0.9], 0.1).unwrap().to_state_space().unwrap();
    let grid = lti::common_frequency_grid(&[slow, fast.clone()], 100).unwrap();
    let nyquist = std::f64::consts::PI / 0.1;
    assert!(grid.windows(2).all(|pair| pair[0] < pair[1]));
    assert!((grid[0] - 0.001).abs() < 1e-12 && grid.contains(&nyquist), "{} {}", grid[0], grid[grid.len() - 1]);
    assert_eq!(
        lti::common_frequency_grid(std::slice::from_ref(&fast), 100).unwrap(),
        fast.frequency_grid(100).unwrap()
    );
    assert!(lti::common_frequency_grid(&[], 100).unwrap().is_empty());
}

#[test]
fn exact_growing_modes_are_separated_from_integrators() {
    let system = |den: Vec<f64>| TransferFunction::continuous(vec![1.0], den).unwrap().to_state_space().unwrap();
    // s², s(s + 1), (s − 0.01)(s + 1), and a pair.
    assert_eq!(system(vec![1.0, 0.0, 0.0]).growing_mode().unwrap(), None);
    assert_eq!(system(vec![1.0, 1.0, 0.0]).growing_mode().unwrap(), None);
    let slow = system(vec![1.0, 0.99, -0.01]).growing_mode().unwrap().unwrap();
    assert!((slow.time_constant_s() + 100.0).abs() < 1e-9);
    let pair = system(vec![1.0, -0.2, 4.01]).growing_mode().unwrap().unwrap();
    assert!((pair.pole.re - 0.1).abs() < 1e-12);
}
