//! FIR filters and change of rate against SciPy 1.17.

use std::f64::consts::TAU;

use proptest::prelude::*;
use signal::filter::kaiser_design;
use signal::resample::resample_rational;
use signal::window::Window;
use signal::{Fir, Signal, SignalError};

use crate::{assert_close, record};

const T: f64 = 1e-3;

/// `firwin(11, …, fs=1000)` (10 taps for the second): the first half; the taps are symmetric.
#[test]
fn ref_window_designs() {
    let check = |filter: Result<Fir, SignalError>, half: &[f64]| {
        let filter = filter.unwrap();
        assert_close(&filter.taps()[..half.len()], half, 1e-14);
        let reversed: Vec<f64> = filter.taps().iter().rev().copied().collect();
        assert_close(filter.taps(), &reversed, 1e-15);
    };
    let low = [
        0.004059059965798471,
        0.016387751788843455,
        0.057125427346512554,
        0.12429293720894577,
        0.18966057293847272,
        0.21694850150285394,
    ];
    check(Fir::lowpass(11, 80.0, Window::Hamming, T), &low);
    let even = [0.0, 0.01617782848983527, 0.07745468731679774, 0.16866296772378642, 0.23770451646958057];
    check(Fir::lowpass(10, 80.0, Window::Hann, T), &even);
    let high = [
        0.0,
        -0.00040100434707580874,
        -0.016411029324728495,
        -0.0809615642289273,
        -0.18501478407659555,
        0.7598735103493582,
    ];
    check(Fir::highpass(11, 120.0, Window::Blackman, T), &high);
    let pass = [
        -0.0033051581815345572,
        -0.041325362996268336,
        -0.09770887089023687,
        -0.015805715600349456,
        0.2521366300251176,
        0.4163598963293249,
    ];
    check(Fir::bandpass(11, 60.0, 200.0, Window::Kaiser { beta: 5.0 }, T), &pass);
    let stop = [
        0.008205758228844316,
        0.044105200253487006,
        0.1067431258468423,
        0.017796929760186996,
        -0.2867315625757079,
        1.2197610969726949,
    ];
    check(Fir::bandstop(11, 60.0, 200.0, Window::Hamming, T), &stop);
}

/// `filtfilt` and `lfilter` with the low-pass above, at the samples 0, 1, 10, 30, 58, 59 of the common record.
#[test]
fn ref_filtering() {
    let low = Fir::lowpass(11, 80.0, Window::Hamming, T).unwrap();
    let at = [0, 1, 10, 30, 58, 59];
    let both = low.filtfilt(&record()).unwrap();
    let zero_phase = [0.5, 0.5801674572494857, 0.3063104657120137, 0.9104858513851247, 0.624615499247259];
    assert_close(&at.map(|i| both[i])[..5], &zero_phase, 1e-13);
    let forward = low.filter(&record(), &mut low.state_at_rest());
    let causal = [
        0.0020295299828992355,
        0.009213097569376974,
        0.9674356136737539,
        1.3139094311459392,
        0.8958036733217892,
        0.6720552466066132,
    ];
    assert_close(&at.map(|i| forward[i]), &causal, 1e-14);
    let centred = low.filter_centred(&record()).unwrap();
    assert_close(&centred[5..55], &forward[10..], 1e-14);
}

#[test]
fn exact_filtering_in_blocks_equals_filtering_at_once() {
    let low = Fir::lowpass(11, 80.0, Window::Hamming, T).unwrap();
    let x = record();
    let whole = low.filter(&x, &mut low.state_at_level(1.0));
    let mut state = low.state_at_level(1.0);
    let parts = [&x[..3], &x[3..20], &[], &x[20..]].map(|part| low.filter(part, &mut state)).concat();
    assert_eq!(whole, parts);
}

#[test]
fn exact_impossible_filters_are_refused() {
    let hann = Window::Hann;
    assert!(matches!(Fir::lowpass(11, 500.0, hann, T), Err(SignalError::Cutoff { .. })));
    assert!(matches!(Fir::bandpass(11, 50.0, 40.0, hann, T), Err(SignalError::Cutoff { .. })));
    assert!(matches!(Fir::lowpass(0, 50.0, hann, T), Err(SignalError::Parameter { .. })));
    assert!(matches!(Fir::lowpass(9, 50.0, hann, f64::NAN), Err(SignalError::SampleTime { .. })));
    assert!(matches!(Fir::lowpass(9, 50.0, Window::Kaiser { beta: -1.0 }, T), Err(SignalError::Parameter { .. })));
    assert_eq!(Fir::highpass(10, 50.0, hann, T), Err(SignalError::EvenTaps { taps: 10 }));
    assert_eq!(Fir::new(vec![], T), Err(SignalError::TooShort { needed: 1, got: 0 }));
    let low = Fir::lowpass(10, 50.0, hann, T).unwrap();
    assert_eq!(low.filter_centred(&[0.0; 30]), Err(SignalError::EvenTaps { taps: 10 }));
    assert!(matches!(low.filtfilt(&[0.0; 30]), Err(SignalError::TooShort { .. })));
    assert!(matches!(kaiser_design(60.0, 0.0, T), Err(SignalError::Parameter { .. })));
    assert!(matches!(kaiser_design(60.0, f64::NAN, T), Err(SignalError::Parameter { .. })));
}

/// `resample_poly(x, up, down, window=h, padtype='antireflect')` with the same Kaiser filter `h`, on 300 samples.
#[test]
fn ref_rational_resampling() {
    let at = |t: usize| {
        let t = t as f64;
        (0.3 * t).sin() + 0.5 * (1.7 * t).cos() + 0.02 * t
    };
    let x = Signal::new(2.0, T, (0..300).map(at).collect()).unwrap();
    let check = |up: usize, down: usize, length: usize, values: [f64; 5]| {
        let y = resample_rational(&x, up, down).unwrap();
        assert_eq!((y.len(), y.start_s), (length, 2.0));
        assert_close(&[0, 1, 40, 77, length - 1].map(|i| y.samples[i]), &values, 1e-12);
    };
    check(3, 2, 450, [0.5, 0.3733335147008114, 1.6316733965737438, 1.7128668104391904, 7.648440854323718]);
    check(4, 10, 120, [0.5, 0.5787140079433181, 1.011964821083692, 4.782511955911967, 6.864088432342901]);
    check(7, 4, 525, [0.5, 0.40153987135764024, 1.2006177183759805, 1.8852357557276362, 7.726514470170317]);
}

#[test]
fn exact_resampled_tones_and_dropped_aliases() {
    let tone = |freq: f64, n: usize| (0..n).map(|t| (TAU * freq * t as f64).sin()).collect::<Vec<f64>>();
    let x = Signal::new(0.0, 1.0, tone(0.11, 4000)).unwrap();
    let y = resample_rational(&x, 3, 7).unwrap();
    let truth = tone(0.11 * 7.0 / 3.0, y.len());
    assert_close(&y.samples[100..1600], &truth[100..1600], 2e-4);
    let high = resample_rational(&Signal::new(0.0, 1.0, tone(0.23, 4000)).unwrap(), 3, 7).unwrap();
    assert!(high.samples[100..1600].iter().all(|v| v.abs() < 2e-4));
}

#[test]
fn exact_impossible_rates_are_refused() {
    let x = Signal::new(0.0, 1.0, vec![1.0; 10]).unwrap();
    for (up, down) in [(0, 1), (1, 0), (0, 0), (1, 20_000)] {
        assert!(matches!(resample_rational(&x, up, down), Err(SignalError::Parameter { .. })));
    }
    let empty = Signal::new(0.0, 1.0, vec![]).unwrap();
    assert!(matches!(resample_rational(&empty, 2, 3), Err(SignalError::TooShort { .. })));
}

proptest! {
    #[test]
    fn prop_resampling_keeps_constants_and_length(n in 1_usize..50, up in 1_usize..9, down in 1_usize..9, level in -5.0_f64..5.0) {
        let y = resample_rational(&Signal::new(0.0, 1.0, vec![level; n]).unwrap(), up, down).unwrap();
        prop_assert_eq!(y.len(), (n * up).div_ceil(down));
        prop_assert!(y.samples.iter().all(|v| (v - level).abs() < 1e-12));
    }

    #[test]
    fn prop_kaiser_design_keeps_its_promise(attenuation in 45.0_f64..110.0, transition in 0.01_f64..0.1) {
        let (taps, window) = kaiser_design(attenuation, transition, 1.0).unwrap();
        let low = Fir::lowpass(taps, 0.25, window, 1.0).unwrap();
        // The rule is empirical and may miss by two decibels and more.
        let ripple = 10_f64.powf(-(attenuation - 3.0) / 20.0);
        for i in 0..50 {
            let f = f64::from(i) / 50.0 * (0.25 - 0.5 * transition);
            prop_assert!((low.response(f).norm() - 1.0).abs() < ripple && low.response(0.5 - f).norm() < ripple);
        }
    }
}
