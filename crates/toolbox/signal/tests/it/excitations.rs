//! Excitation signals: sequences of maximal length, bands, sweeps, crest factors.

use std::f64::consts::TAU;

use proptest::prelude::*;
use signal::SignalError;
use signal::excitation::{
    Multisine, Phases, Prbs, Random, Sweep, Timing, band_limited_noise, chirp, crest_factor, held_noise,
};
use signal::spectrum::fft_real;

use crate::assert_close;

fn timing(length: usize) -> Timing {
    Timing { sample_time_s: 1e-3, length }
}

#[test]
fn exact_autocorrelation_of_a_prbs_has_two_values() {
    for order in 2..=11 {
        let prbs = Prbs { order, hold: 1, levels: [-3.0, 3.0], seed: 5 };
        let period = prbs.period();
        assert_eq!(period, (1 << order) - 1);
        let x = prbs.generate(timing(2 * period)).unwrap().samples;
        assert_eq!(x[..period], x[period..]);
        for lag in 1..period {
            let sum: f64 = (0..period).map(|t| x[t] * x[t + lag]).sum();
            assert_eq!(sum, -9.0, "order {order}, lag {lag}");
        }
    }
}

#[test]
fn exact_prbs_is_held_and_starts_where_its_seed_says() {
    let prbs = Prbs { order: 31, hold: 3, levels: [0.0, 1.0], seed: 77 };
    let x = prbs.generate(timing(3000)).unwrap().samples;
    assert!(x.chunks(3).all(|c| c.iter().all(|v| *v == c[0])));
    let other = Prbs { seed: 78, ..prbs }.generate(timing(3000)).unwrap().samples;
    assert_ne!(x, other);
    for bad in [Prbs { order: 1, ..prbs }, Prbs { order: 32, ..prbs }, Prbs { hold: 0, ..prbs }] {
        assert!(matches!(bad.generate(timing(10)), Err(SignalError::Parameter { .. })));
    }
    assert!(Prbs { levels: [0.0, f64::NAN], ..prbs }.generate(timing(10)).is_err());
}

#[test]
fn exact_optimised_multisines_have_low_crest_factors() {
    let sets: [(usize, Vec<usize>, f64); 4] = [
        (1000, (1..=30).collect(), 1.5),
        (4096, (1..=200).step_by(2).collect(), 1.5),
        (4096, (20..=400).collect(), 1.5),
        (2000, (1..=12).map(|k| k * k).collect(), 2.4),
    ];
    for (period, harmonics, most) in sets {
        let multisine = Multisine::flat(period, harmonics, 2.0, Phases::LowCrest { iterations: 400 });
        let x = multisine.generate(timing(period)).unwrap().samples;
        let schroeder = Multisine { phases: Phases::Schroeder, ..multisine.clone() };
        let before = crest_factor(&schroeder.generate(timing(period)).unwrap().samples).unwrap();
        let crest = crest_factor(&x).unwrap();
        assert!(crest < most && crest <= before, "{crest}, was {before}");
        let lines = fft_real(&x).unwrap();
        let amplitude = 2.0 * (2.0 / multisine.harmonics.len() as f64).sqrt();
        for (k, line) in lines.iter().enumerate() {
            let expected = if multisine.harmonics.contains(&k) { amplitude } else { 0.0 };
            assert!((2.0 * line.norm() / period as f64 - expected).abs() < 1e-10);
        }
    }
}

#[test]
fn exact_multisines_of_given_and_impossible_amplitudes() {
    let good = Multisine {
        period: 100,
        harmonics: vec![7, 3],
        amplitudes: vec![3.0, 1.0],
        rms: 5.0,
        phases: Phases::Random { seed: 4 },
    };
    let x = good.generate(timing(250)).unwrap().samples;
    assert_eq!(x[..50], x[200..]);
    let lines = fft_real(&x[..100]).unwrap();
    assert!((lines[7].norm() / lines[3].norm() - 3.0).abs() < 1e-12);
    assert!((x[..100].iter().map(|v| v * v).sum::<f64>() - 2500.0).abs() < 1e-9);
    let refused = |multisine: Multisine| multisine.generate(timing(10)).unwrap_err();
    assert!(matches!(refused(Multisine { harmonics: vec![], ..good.clone() }), SignalError::TooShort { .. }));
    assert!(matches!(refused(Multisine { harmonics: vec![3, 3], ..good.clone() }), SignalError::Parameter { .. }));
    assert!(matches!(refused(Multisine { harmonics: vec![0, 3], ..good.clone() }), SignalError::Parameter { .. }));
    assert!(matches!(refused(Multisine { harmonics: vec![3, 50], ..good.clone() }), SignalError::Parameter { .. }));
    assert!(matches!(refused(Multisine { period: 0, ..good.clone() }), SignalError::Parameter { .. }));
    assert!(matches!(refused(Multisine { amplitudes: vec![1.0], ..good.clone() }), SignalError::LengthMismatch { .. }));
    assert!(matches!(refused(Multisine { amplitudes: vec![0.0; 2], ..good.clone() }), SignalError::Constant));
    assert!(matches!(refused(Multisine { rms: f64::NAN, ..good }), SignalError::Parameter { .. }));
}

/// SciPy 1.17: `chirp(t, f0, t1, f1, method, phi=-90)` at the samples 0, 100, 500, 999.
#[test]
fn ref_sweeps() {
    let at = |sweep| {
        let x = chirp(timing(1000), 0.0, 1.0, [5.0, 80.0], sweep).unwrap().samples;
        [0, 100, 500, 999].map(|i| x[i])
    };
    assert_close(
        &at(Sweep::Linear),
        &[6.123233995736766e-17, -0.7071067811865477, -0.7071067811865439, 0.4815471858338723],
        1e-11,
    );
    assert_close(
        &at(Sweep::Logarithmic),
        &[6.123233995736766e-17, -0.46064312974391364, 0.5352621982669961, -0.18341239448139227],
        1e-11,
    );
    let steady = chirp(timing(100), 1.0, 2.0, [40.0, 40.0], Sweep::Logarithmic).unwrap().samples;
    assert!((steady[7] - 1.0 - 2.0 * (TAU * 0.28).sin()).abs() < 1e-12);
    assert!(matches!(chirp(timing(9), 0.0, 1.0, [0.0, 9.0], Sweep::Logarithmic), Err(SignalError::Parameter { .. })));
    assert!(matches!(chirp(timing(9), 0.0, 1.0, [1.0, 501.0], Sweep::Linear), Err(SignalError::Parameter { .. })));
    assert!(matches!(chirp(timing(0), 0.0, 1.0, [1.0, 2.0], Sweep::Linear), Err(SignalError::TooShort { .. })));
}

#[test]
fn stat_noise_has_the_deviation_asked_for() {
    let x = band_limited_noise(&mut Random::new(3), timing(100_000), 2.0, [0.0, 500.0]).unwrap().samples;
    let white = held_noise(&mut Random::new(3), timing(100_000), 0.0, 2.0, 0.0).unwrap().samples;
    for x in [x, white] {
        let moment = |p: i32| x.iter().map(|v| v.powi(p)).sum::<f64>() / x.len() as f64;
        assert!((moment(2) / 4.0 - 1.0).abs() < 0.02);
        assert!((moment(4) / 48.0 - 1.0).abs() < 0.05);
    }
    let narrow = band_limited_noise(&mut Random::new(3), timing(1000), 1.0, [10.2, 10.8]);
    assert!(matches!(narrow, Err(SignalError::Parameter { .. })));
    for band in [[-1.0, 5.0], [5.0, 4.0], [5.0, 600.0], [f64::NAN, 5.0]] {
        assert!(band_limited_noise(&mut Random::new(3), timing(1000), 1.0, band).is_err());
    }
    assert!(band_limited_noise(&mut Random::new(3), timing(0), 1.0, [1.0, 5.0]).is_err());
}

#[test]
fn exact_crest_factors() {
    let sine: Vec<f64> = (0..1000).map(|t| 1e200 * (TAU * f64::from(t) / 1000.0).sin()).collect();
    assert!((crest_factor(&sine).unwrap() - 2_f64.sqrt()).abs() < 1e-12);
    assert_eq!(crest_factor(&[2.0, -2.0]), Ok(1.0));
    assert_eq!(crest_factor(&[0.0; 3]), Err(SignalError::Constant));
    assert_eq!(crest_factor(&[]), Err(SignalError::TooShort { needed: 1, got: 0 }));
    assert_eq!(crest_factor(&[1.0, f64::INFINITY]), Err(SignalError::NonFinite { index: 1 }));
}

proptest! {
    #[test]
    fn prop_multisines_have_their_power(period in 10_usize..300, seed in 0_u64..1000, rms in 0.1_f64..10.0) {
        let harmonics: Vec<usize> = (1..=(period - 1) / 2).step_by(1 + seed as usize % 4).collect();
        for phases in [Phases::Schroeder, Phases::Random { seed }, Phases::LowCrest { iterations: 10 }] {
            let x = Multisine::flat(period, harmonics.clone(), rms, phases).generate(timing(period)).unwrap().samples;
            let power = x.iter().map(|v| v * v).sum::<f64>() / period as f64;
            prop_assert!((power / (rms * rms) - 1.0).abs() < 1e-9);
        }
    }
}
