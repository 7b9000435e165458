//! Continuous to discrete, back, and between sample times.

use faer::{Mat, mat};
use lti::{Complex64, Discretisation, LtiError, StateSpace, TransferFunction, ZeroPoleGain, expm, logm};
use proptest::prelude::*;

use crate::assert_close;

const TUSTIN: Discretisation = Discretisation::Tustin { prewarp_rad_s: None };

fn oscillator(feed_through: f64) -> StateSpace {
    let (a, b, c) = (mat![[0.0, 1.0], [-40.0, -3.0]], mat![[0.0], [2.0]], mat![[1.0, 0.5]]);
    StateSpace::continuous(a, b, c, mat![[feed_through]]).unwrap()
}

fn third_order() -> TransferFunction {
    TransferFunction::continuous(vec![2.0, 3.0], vec![1.0, 1.2, 9.0, 4.0]).unwrap()
}

fn assert_coefficients(got: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(got.len(), expected.len(), "{got:?}");
    assert!(got.iter().zip(expected).all(|(a, b)| (a - b).abs() < tolerance), "{got:?} for {expected:?}");
}

/// SciPy 1.17 `cont2discrete`: `bilinear` and `impulse` of the oscillator at 0.05 s.
#[test]
fn ref_sampled_oscillator() {
    let tustin = oscillator(0.1).to_discrete(TUSTIN, 0.05).unwrap();
    let a = mat![[0.9545454545454546, 0.04545454545454546], [-1.8181818181818183, 0.8181818181818182]];
    assert_close(tustin.a(), a.as_ref(), 1e-15);
    assert_close(tustin.b(), mat![[0.00227272727272727], [0.09090909090909093]].as_ref(), 1e-15);
    assert_close(tustin.c(), mat![[0.5227272727272727, 0.47727272727272735]].as_ref(), 1e-15);
    assert_close(tustin.d(), mat![[0.12386363636363637]].as_ref(), 1e-15);
    let impulse = oscillator(0.0).to_discrete(Discretisation::ImpulseInvariant, 0.05).unwrap();
    assert_close(impulse.b(), mat![[0.00456609779432458], [0.08158173372909161]].as_ref(), 1e-15);
    assert_close(impulse.d(), mat![[0.05]].as_ref(), 1e-15);
}

/// SciPy 1.17 `cont2discrete` of a transfer function at 0.1 s.
#[test]
fn ref_sampled_transfer_function() {
    let zoh = third_order().to_discrete(Discretisation::ZeroOrderHold, 0.1).unwrap();
    assert_coefficients(zoh.num(), &[0.01002296677443137, 0.00149374350088616, -0.00871085691837614], 1e-14);
    assert_coefficients(zoh.den(), &[1.0, -2.800836758384038, 2.6914983329104505, -0.8869204367171575], 1e-14);
    let tustin = third_order().to_discrete(TUSTIN, 0.1).unwrap();
    let monic = |p: &[f64]| p.iter().map(|c| c / tustin.den()[0]).collect::<Vec<f64>>();
    let num = [0.00496306555863346, 0.00565558633425622, -0.00357802400738638, -0.00427054478300992];
    assert_coefficients(&monic(tustin.num()), &num, 1e-14);
    let den = [1.0, -2.8033240997229907, 2.6952908587257602, -0.8882733148661119];
    assert_coefficients(&monic(tustin.den()), &den, 1e-14);
}

/// `scipy.linalg.logm`.
#[test]
fn ref_logarithm() {
    let expected = mat![
        [0.6480011838347374, 0.594469725297745, -0.06131210916479238],
        [0.1722097066728446, 0.35076632118586343, 0.19859968697377903],
        [0.08397181619569143, -0.03065605458239621, -0.35166426296206316],
    ];
    let got = logm(mat![[2.0, 1.0, 0.0], [0.3, 1.5, 0.2], [0.1, 0.0, 0.7]].as_ref()).unwrap();
    assert_close(got.as_ref(), expected.as_ref(), 1e-14);
}

#[test]
fn exact_logarithm_of_defective_badly_scaled_and_impossible_matrices() {
    let jordan = mat![[1.0, 0.1, 0.0], [0.0, 1.0, 0.1], [0.0, 0.0, 1.0]];
    let expected = mat![[0.0, 0.1, -0.005], [0.0, 0.0, 0.1], [0.0, 0.0, 0.0]];
    assert_close(logm(jordan.as_ref()).unwrap().as_ref(), expected.as_ref(), 1e-15);
    let rotation = expm(mat![[0.0, 3e6], [-3e-6, 0.0]].as_ref()).unwrap();
    assert!((logm(rotation.as_ref()).unwrap()[(0, 1)] / 3e6 - 1.0).abs() < 1e-13);
    for impossible in [mat![[-1.0]], mat![[0.0]], mat![[1.0, 2.0], [2.0, 4.0]], mat![[0.0, 1.0], [0.0, 0.0]]] {
        assert!(matches!(logm(impossible.as_ref()), Err(LtiError::NoLogarithm { .. })), "{impossible:?}");
    }
    assert!(matches!(logm(mat![[f64::NAN]].as_ref()), Err(LtiError::NonFinite { .. })));
    assert!(matches!(logm(Mat::<f64>::zeros(1, 2).as_ref()), Err(LtiError::Shape { .. })));
}

#[test]
fn exact_prewarped_tustin_is_right_at_its_frequency() {
    let (omega, sample_time_s) = (6.0, 0.3);
    let method = Discretisation::Tustin { prewarp_rad_s: Some(omega) };
    let truth = third_order().frequency_response(&[omega]).unwrap().response[0];
    let ratio = third_order().to_discrete(method, sample_time_s).unwrap();
    assert!((ratio.frequency_response(&[omega]).unwrap().response[0] - truth).norm() < 1e-13);
    let system = third_order().to_state_space().unwrap().to_discrete(method, sample_time_s).unwrap();
    assert!((system.frequency_response(0, 0, &[omega]).unwrap().response[0] - truth).norm() < 1e-13);
    let beyond = Discretisation::Tustin { prewarp_rad_s: Some(11.0) };
    assert!(matches!(third_order().to_discrete(beyond, sample_time_s), Err(LtiError::Frequency { .. })));
}

#[test]
fn exact_matched_poles_and_gain_at_rest() {
    // An integrator and a lag: 2 / (s (s + 3)).
    let system = TransferFunction::continuous(vec![2.0], vec![1.0, 3.0, 0.0]).unwrap();
    let sampled = system.to_zero_pole_gain().unwrap().to_discrete(Discretisation::Matched, 0.1).unwrap();
    assert_eq!(sampled.zeros(), [Complex64::new(-1.0, 0.0)]);
    // (z − 1)/T · H(z) at rest is 2/3.
    let pole = (-0.3_f64).exp();
    assert!((sampled.gain() * 2.0 / (1.0 - pole) / 0.1 - 2.0 / 3.0).abs() < 1e-14);
    let lag = TransferFunction::continuous(vec![5.0], vec![1.0, 4.0]).unwrap();
    let z = lag.to_discrete(Discretisation::Matched, 0.1).unwrap();
    assert!((z.dc_gain() - 1.25).abs() < 1e-14 && z.num().len() == 1);
}

#[test]
fn exact_fractional_delay_under_hold_and_impulse() {
    // 1/(s + 1) behind 0.3 s, sampled at 0.2 s: half a sample beyond a whole one.
    let late = TransferFunction::continuous(vec![1.0], vec![1.0, 1.0]).unwrap().with_delay(0.3).unwrap();
    let held = late.to_discrete(Discretisation::ZeroOrderHold, 0.2).unwrap();
    let impulse = late.to_discrete(Discretisation::ImpulseInvariant, 0.2).unwrap();
    let (half, e) = ((-0.1_f64).exp(), (-0.2_f64).exp());
    assert_eq!(held.delay_s(), 0.2);
    // (1 − h) u(k−1) + h (1 − h) u(k−2), one sample late.
    let w = 3.0;
    let z = Complex64::cis(w * 0.2);
    let expected = ((1.0 - half) * z + half * (1.0 - half)) / (z * (z - e)) / z;
    assert!((held.frequency_response(&[w]).unwrap().response[0] - expected).norm() < 1e-14);
    // Samples at 0.4, 0.6 … of e^{−(t − 0.3)}.
    let expected = 0.2 * half * z / (z - e) / (z * z);
    assert!((impulse.frequency_response(&[w]).unwrap().response[0] - expected).norm() < 1e-14);
    for method in [Discretisation::FirstOrderHold, TUSTIN, Discretisation::Matched] {
        assert!(matches!(late.to_discrete(method, 0.2), Err(LtiError::FractionalDelay { .. })));
        assert!((late.to_discrete(method, 0.1).unwrap().delay_s() - 0.3).abs() < 1e-15);
    }
}

#[test]
fn exact_discrete_systems_without_a_continuous_one_are_refused() {
    let with_pole = |p: f64| TransferFunction::discrete(vec![1.0], vec![1.0, -p], 0.1).unwrap();
    let methods = [
        Discretisation::ZeroOrderHold,
        Discretisation::FirstOrderHold,
        Discretisation::ImpulseInvariant,
        Discretisation::Matched,
    ];
    for method in methods {
        for pole in [0.0, -0.5] {
            let refused = with_pole(pole).to_continuous(method);
            assert!(matches!(refused, Err(LtiError::NoLogarithm { .. })), "{method:?} {pole}: {refused:?}");
        }
    }
    assert!(matches!(with_pole(-1.0).to_continuous(TUSTIN), Err(LtiError::Singular { .. })));
    let alternating = with_pole(-1.0).to_state_space().unwrap();
    assert!(matches!(alternating.to_continuous(TUSTIN), Err(LtiError::Singular { .. })));
    assert!(with_pole(-0.5).to_continuous(TUSTIN).is_ok());
    let through = oscillator(0.1).to_discrete(Discretisation::ImpulseInvariant, 0.1);
    assert!(matches!(through, Err(LtiError::Improper { .. })));
    assert!(matches!(third_order().to_continuous(TUSTIN), Err(LtiError::NotDiscrete)));
    assert!(matches!(with_pole(0.5).to_discrete(TUSTIN, 0.1), Err(LtiError::NotContinuous)));
}

#[test]
fn exact_every_second_sample_of_a_system_with_any_pole() {
    // Poles at zero and at −0.5 have no logarithm, but their squares are no trouble.
    let system = TransferFunction::discrete(vec![1.0, 0.2], vec![1.0, 0.5, 0.0], 0.1).unwrap();
    let slow = system.to_state_space().unwrap().resampled(Discretisation::ZeroOrderHold, 0.2).unwrap();
    let u = [1.0, -2.0, 0.5, 0.0, 3.0];
    let rest = [0.0, 0.0];
    let held = Mat::from_fn(10, 1, |k, _| u[k / 2]);
    let fast = system.to_state_space().unwrap().simulate(held.as_ref(), &rest).unwrap();
    let y = slow.simulate(Mat::from_fn(5, 1, |k, _| u[k]).as_ref(), &rest).unwrap();
    assert!((0..5).all(|k| (y[(k, 0)] - fast[(2 * k, 0)]).abs() < 1e-14));
}

#[test]
fn exact_slow_poles_sampled_fast_come_back() {
    // A drive of 20 rad/s and an integrator at 100 kHz: poles at 1 and 1 − 2e-4.
    let system = TransferFunction::continuous(vec![7.0], vec![1.0, 20.0, 0.0]).unwrap().to_state_space().unwrap();
    for method in [Discretisation::ZeroOrderHold, Discretisation::FirstOrderHold, TUSTIN] {
        let back = system.to_discrete(method, 1e-5).unwrap().to_continuous(method).unwrap();
        let w = [0.1, 20.0, 5000.0];
        let (a, b) = (system.frequency_response(0, 0, &w).unwrap(), back.frequency_response(0, 0, &w).unwrap());
        let worst = a.response.iter().zip(&b.response).map(|(a, b)| (a - b).norm() / a.norm()).fold(0.0, f64::max);
        assert!(worst < 1e-8, "{method:?}: {worst:e}");
    }
}

/// Zeros, poles and gain of stable continuous systems below 30 rad/s, with as many poles as zeros or more.
fn systems() -> impl Strategy<Value = ZeroPoleGain> {
    let pairs = prop::collection::vec((1.0_f64..30.0, 0.05_f64..0.95), 1..3);
    let real = prop::collection::vec(0.5_f64..25.0, 0..3);
    let zeros = prop::collection::vec(-20.0_f64..20.0, 0..3);
    (pairs, real, zeros, 0.1_f64..10.0).prop_map(|(pairs, real, zeros, size)| {
        let pair = |(w, zeta): &(f64, f64)| {
            let p = Complex64::new(-w * zeta, w * (1.0 - zeta * zeta).sqrt());
            [p, p.conj()]
        };
        let poles: Vec<Complex64> =
            pairs.iter().flat_map(pair).chain(real.iter().map(|p| Complex64::from(-p))).collect();
        let zeros: Vec<Complex64> = zeros.iter().map(|z| Complex64::from(*z)).collect();
        let unscaled = ZeroPoleGain::continuous(zeros.clone(), poles.clone(), 1.0).unwrap();
        let gain = size / unscaled.evaluate(Complex64::new(0.0, 3.0)).norm();
        ZeroPoleGain::continuous(zeros, poles, gain).unwrap()
    })
}

const GRID: [f64; 4] = [0.3, 3.0, 10.0, 30.0];

/// Largest difference of two responses over the larger of them.
fn distance(a: &[Complex64], b: &[Complex64]) -> f64 {
    let largest = a.iter().map(|h| h.norm()).fold(0.0, f64::max);
    a.iter().zip(b).map(|(a, b)| (a - b).norm() / largest).fold(0.0, f64::max)
}

/// All methods, that of the impulse response where the system has one.
fn methods(system: &ZeroPoleGain) -> Vec<Discretisation> {
    let prewarped = Discretisation::Tustin { prewarp_rad_s: Some(7.0) };
    let mut all =
        vec![Discretisation::ZeroOrderHold, Discretisation::FirstOrderHold, TUSTIN, prewarped, Discretisation::Matched];
    if system.zeros().len() < system.poles().len() {
        all.push(Discretisation::ImpulseInvariant);
    }
    all
}

/// Changes of the frequency response by sampling and back, as matrices and as zeros and poles.
fn round_trips(system: &ZeroPoleGain, method: Discretisation, sample_time_s: f64) -> [f64; 2] {
    let truth = system.frequency_response(&GRID).unwrap().response;
    let matrices = system.to_state_space().unwrap().to_discrete(method, sample_time_s).unwrap();
    let matrices = matrices.to_continuous(method).unwrap().frequency_response(0, 0, &GRID).unwrap().response;
    let roots = system.to_discrete(method, sample_time_s).unwrap().to_continuous(method).unwrap();
    [distance(&truth, &matrices), distance(&truth, &roots.frequency_response(&GRID).unwrap().response)]
}

/// Impulse responses that start at zero, as ratios, matrices in any coordinates, and zeros and poles.
#[test]
fn regress_impulse_responses_that_start_at_zero_come_back() {
    let method = Discretisation::ImpulseInvariant;
    let ratio = TransferFunction::continuous(vec![3.0], vec![1.0, 2.0, 5.0]).unwrap();
    let sampled = ratio.to_discrete(method, 0.1).unwrap();
    assert_eq!(sampled.num().len(), 2, "{sampled:?}");
    for back in [sampled.to_continuous(method), sampled.resampled(method, 0.03).unwrap().to_continuous(method)] {
        let back = back.unwrap();
        assert_coefficients(back.num(), &[3.0], 1e-12);
        assert_coefficients(back.den(), &[1.0, 2.0, 5.0], 1e-12);
    }
    let turned = |angle: f64| {
        let (c, s) = (angle.cos(), angle.sin());
        let (t, back) = (mat![[c, -s], [s, c]], mat![[c, s], [-s, c]]);
        let system = ratio.to_state_space().unwrap();
        StateSpace::continuous(&t * system.a() * &back, t * system.b(), system.c() * back, mat![[0.0]]).unwrap()
    };
    for angle in [0.3, 1.0, 2.0] {
        let sampled = turned(angle).to_discrete(method, 0.1).unwrap();
        assert_eq!(sampled.to_transfer_function().unwrap().num().len(), 2, "{angle}");
        assert_eq!(sampled.to_continuous(method).unwrap().to_transfer_function().unwrap().num().len(), 1, "{angle}");
    }
    // Of three poles more than zeros: as many zeros near the samples' band as there are.
    let cubed = TransferFunction::continuous(vec![8.0], vec![1.0, 6.0, 12.0, 8.0]).unwrap();
    let back = cubed.to_discrete(method, 0.1).unwrap().to_continuous(method).unwrap();
    assert!((back.dc_gain() - 1.0).abs() < 1e-8, "{back:?}");
    // Held, the response that starts at zero is another; it is no impulse response.
    let held = ratio.to_discrete(Discretisation::ZeroOrderHold, 0.1).unwrap();
    assert!(matches!(held.to_continuous(method), Err(LtiError::Improper { .. })));
}

/// Six poles within a tenth of one after sampling, where eigenvalues of the whole state matrix are poor.
#[test]
fn regress_slow_poles_close_together_come_back() {
    let pair = |re: f64, im: f64| [Complex64::new(re, im), Complex64::new(re, -im)];
    let real = |r: &[f64]| r.iter().map(|r| Complex64::from(*r)).collect::<Vec<Complex64>>();
    let pairs = [pair(-1.4832931920270729, 8.551663068961853), pair(-1.4919681906987485, 3.521764002522631)];
    let poles = [real(&[-1.1132080639650581, -0.5875794458415997]), pairs.concat()].concat();
    let zeros = real(&[9.006709168118515, 18.25512487416686]);
    let one = ZeroPoleGain::continuous(zeros, poles, 236.17386148894852).unwrap();
    let pairs = [pair(-0.17, 0.985), pair(-0.19, 3.82)];
    let poles = [real(&[-0.5, -0.5]), pairs.concat()].concat();
    let two = ZeroPoleGain::continuous(vec![], poles, 42.9).unwrap();
    for (system, sample_time_s) in [(one, 0.01146021095513652), (two, 0.01)] {
        for method in methods(&system) {
            let errors = round_trips(&system, method, sample_time_s);
            assert!(errors.iter().all(|e| *e < 1e-7), "{method:?}: {errors:?}");
        }
    }
}

/// Zeros at infinity, at `2/T`, close to −1 and on it keep the response under the bilinear map.
#[test]
fn exact_tustin_of_zeros_and_poles_equals_that_of_matrices() {
    let (fast, slow) = (Complex64::from(20.0), Complex64::from(-3.0));
    let poles = vec![Complex64::from(-1.0), Complex64::new(-2.0, 5.0), Complex64::new(-2.0, -5.0)];
    for zeros in [vec![], vec![fast], vec![slow, fast], vec![slow; 3]] {
        let system = ZeroPoleGain::continuous(zeros, poles.clone(), 3.0).unwrap();
        let roots = system.to_discrete(TUSTIN, 0.1).unwrap();
        let matrices = system.to_state_space().unwrap().to_discrete(TUSTIN, 0.1).unwrap();
        let other = matrices.frequency_response(0, 0, &GRID).unwrap().response;
        assert!(distance(&roots.frequency_response(&GRID).unwrap().response, &other) < 1e-13);
        let back = roots.to_continuous(TUSTIN).unwrap();
        assert_eq!(back.zeros().len(), system.zeros().len());
        assert!((back.gain() / 3.0 - 1.0).abs() < 1e-12, "{}", back.gain());
    }
    let at_rate = ZeroPoleGain::continuous(vec![], vec![fast], 1.0).unwrap();
    assert!(matches!(at_rate.to_discrete(TUSTIN, 0.1), Err(LtiError::Singular { .. })));
    let improper = ZeroPoleGain::continuous(vec![slow], vec![], 1.0).unwrap();
    assert!(matches!(improper.to_discrete(TUSTIN, 0.1), Err(LtiError::Improper { .. })));
}

proptest! {
    #[test]
    fn prop_the_three_forms_have_one_response(system in systems()) {
        let truth = system.frequency_response(&GRID).unwrap().response;
        let ratio = system.to_transfer_function().unwrap();
        let matrices = system.to_state_space().unwrap();
        prop_assert!(distance(&truth, &ratio.frequency_response(&GRID).unwrap().response) < 1e-9);
        prop_assert!(distance(&truth, &matrices.frequency_response(0, 0, &GRID).unwrap().response) < 1e-11);
        let back = matrices.to_zero_pole_gain(0, 0).unwrap();
        prop_assert!(distance(&truth, &back.frequency_response(&GRID).unwrap().response) < 1e-8);
        let back = ratio.to_zero_pole_gain().unwrap();
        prop_assert!(distance(&truth, &back.frequency_response(&GRID).unwrap().response) < 1e-8);
    }

    #[test]
    fn prop_sampling_is_undone(system in systems(), sample_time_s in 0.01_f64..0.1) {
        for method in methods(&system) {
            let errors = round_trips(&system, method, sample_time_s);
            prop_assert!(errors.iter().all(|e| *e < 1e-7), "{method:?}: {errors:?}");
        }
    }

    /// Polynomials of four poles near one lose what these sample times leave.
    #[test]
    fn prop_sampling_of_a_ratio_is_undone(system in systems(), sample_time_s in 0.05_f64..0.1) {
        prop_assume!(system.poles().len() <= 4);
        let truth = system.frequency_response(&GRID).unwrap().response;
        let ratio = system.to_transfer_function().unwrap();
        for method in methods(&system) {
            let back = ratio.to_discrete(method, sample_time_s).and_then(|s| s.to_continuous(method)).unwrap();
            let error = distance(&truth, &back.frequency_response(&GRID).unwrap().response);
            prop_assert!(error < 1e-5, "{method:?}: {error:e}");
        }
    }

    #[test]
    fn prop_the_forms_are_sampled_alike(system in systems(), sample_time_s in 0.01_f64..0.1) {
        for method in methods(&system) {
            let zpk = system.to_discrete(method, sample_time_s).unwrap().frequency_response(&GRID).unwrap().response;
            let ss = system.to_state_space().unwrap().to_discrete(method, sample_time_s).unwrap();
            prop_assert!(distance(&zpk, &ss.frequency_response(0, 0, &GRID).unwrap().response) < 1e-7);
            let tf = system.to_transfer_function().unwrap().to_discrete(method, sample_time_s).unwrap();
            prop_assert!(distance(&zpk, &tf.frequency_response(&GRID).unwrap().response) < 1e-4, "{method:?}");
        }
    }

    #[test]
    fn prop_resampling_equals_sampling(system in systems(), first in 0.01_f64..0.1, second in 0.01_f64..0.1) {
        let matrices = system.to_state_space().unwrap();
        for method in methods(&system) {
            let direct = matrices.to_discrete(method, second).unwrap();
            let indirect = matrices.to_discrete(method, first).unwrap().resampled(method, second).unwrap();
            let response = |s: &StateSpace| s.frequency_response(0, 0, &GRID).unwrap().response;
            prop_assert!(distance(&response(&direct), &response(&indirect)) < 1e-6, "{method:?}");
        }
    }

    #[test]
    fn prop_logarithm_of_exponential(n in 1_usize..7, values in prop::collection::vec(-1.0_f64..1.0, 36)) {
        let a = Mat::from_fn(n, n, |i, j| values[6 * i + j]) * faer::Scale(2.0 / n as f64);
        let back = logm(expm(a.as_ref()).unwrap().as_ref()).unwrap();
        prop_assert!((back - &a).norm_max() < 1e-12);
    }
}
