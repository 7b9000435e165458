//! Periodic parts: sinusoids below a bin, harmonic series, whole periods.

use std::f64::consts::TAU;

use signal::SignalError;
use signal::excitation::{Multisine, Phases, Prbs, Random, Timing};
use signal::periodicity::{detect_period, find_sinusoids, fit_harmonics};

const T: f64 = 1e-3;

fn tones(length: usize, tones: &[[f64; 3]]) -> Vec<f64> {
    let value = |t: usize| tones.iter().map(|[f, a, p]| a * (TAU * f * t as f64 * T + p).cos()).sum::<f64>();
    (0..length).map(value).collect()
}

fn noisy(x: &[f64], random: &mut Random, deviation: f64) -> Vec<f64> {
    x.iter().map(|v| v + deviation * random.normal()).collect()
}

#[test]
fn exact_sinusoids_are_found_below_a_bin() {
    let truth = [[50.123, 3.0, 1.0], [53.7, 1.0, -2.0], [200.456, 0.01, 0.3]];
    let found = find_sinusoids(&tones(1000, &truth).iter().map(|v| v + 7.0).collect::<Vec<_>>(), T, 3, 1e-3).unwrap();
    assert_eq!(found.len(), 3);
    for (line, [freq, amplitude, phase]) in found.iter().zip(truth) {
        // The mean removed is not quite that of the offset: tones do not fit the record.
        assert!((line.freq_hz - freq).abs() < 2e-4, "{line:?}");
        assert!((line.amplitude - amplitude).abs() < 1e-3, "{line:?}");
        assert!((line.phase_rad - phase).abs() < 0.05, "{line:?}");
    }
}

/// The errors are as large as stated, and noise alone shows a line as often as said.
#[test]
fn stat_sinusoids_state_their_deviations() {
    let (runs, mut errors, mut alarms) = (200, [0.0; 3], 0);
    for seed in 0..runs {
        let mut random = Random::new(seed);
        let truth = [77.77 + random.uniform(), 0.7, 0.4];
        let x = noisy(&tones(600, &[truth]), &mut random, 1.0);
        let found = find_sinusoids(&x, T, 1, 0.01).unwrap()[0];
        errors[0] += ((found.freq_hz - truth[0]) / found.freq_deviation_hz).powi(2);
        errors[1] += ((found.amplitude - truth[1]) / found.amplitude_deviation).powi(2);
        errors[2] += ((found.phase_rad - truth[2]) / found.phase_deviation_rad).powi(2);
        let alone = noisy(&[0.0; 600], &mut random, 1.0);
        alarms += find_sinusoids(&alone, T, 1, 0.1).unwrap().len();
    }
    for error in errors {
        assert!((error / runs as f64 - 1.0).abs() < 0.35, "{errors:?}");
    }
    let rate = alarms as f64 / runs as f64;
    assert!((0.04..0.25).contains(&rate), "{rate}");
}

#[test]
fn exact_fundamental_from_all_its_harmonics() {
    let truth = [[10.2345, 0.1, 0.5], [20.469, 2.0, 1.0], [30.7035, 1.0, -1.0]];
    let x: Vec<f64> = tones(5000, &truth).iter().map(|v| v + 3.0).collect();
    let series = fit_harmonics(&x, T, 10.2, 3).unwrap();
    assert!((series.freq_hz - 10.2345).abs() < 1e-7, "{}", series.freq_hz);
    assert!(series.explained > 1.0 - 1e-9);
    for (line, [_, amplitude, phase]) in series.amplitudes.iter().zip(truth) {
        assert!((line.norm() - amplitude).abs() < 1e-6 && (line.arg() - phase).abs() < 1e-5);
    }
    assert!(matches!(fit_harmonics(&tones(5000, &truth), T, 0.1, 3), Err(SignalError::Parameter { .. })));
    assert!(matches!(fit_harmonics(&tones(5000, &truth), T, 200.0, 3), Err(SignalError::Parameter { .. })));
    assert!(matches!(fit_harmonics(&tones(5000, &truth), T, 10.0, 0), Err(SignalError::Parameter { .. })));
}

#[test]
fn exact_periods_of_excitations() {
    let timing = Timing { sample_time_s: T, length: 2500 };
    let multisine = Multisine::flat(480, (1..60).collect(), 1.0, Phases::Random { seed: 3 });
    let odd = Multisine::flat(480, (1..60).step_by(2).collect(), 1.0, Phases::Random { seed: 4 });
    for x in [multisine, odd].map(|m| m.generate(timing).unwrap().samples) {
        let found = detect_period(&x, 1e-6).unwrap().unwrap();
        assert_eq!((found.period, found.periods), (480, 5));
        assert!(found.unrepeated < 1e-9);
        let found = detect_period(&noisy(&x, &mut Random::new(1), 0.2), 0.1).unwrap().unwrap();
        assert_eq!(found.period, 480);
        assert!((found.unrepeated - 0.04 / 1.04).abs() < 0.01, "{found:?}");
    }
    let prbs = Prbs { order: 8, hold: 3, levels: [0.0, 5.0], seed: 9 };
    let found = detect_period(&prbs.generate(timing).unwrap().samples, 1e-6).unwrap().unwrap();
    assert_eq!(found.period, prbs.period());
    assert_eq!(detect_period(&noisy(&[0.0; 2500], &mut Random::new(2), 1.0), 0.1), Ok(None));
    // One period and a half are not two.
    assert_eq!(detect_period(&prbs.generate(timing).unwrap().samples[..1100], 1e-6), Ok(None));
    let mut walk = noisy(&[0.0; 2500], &mut Random::new(2), 1.0);
    (1..2500).for_each(|t| walk[t] += walk[t - 1]);
    assert_eq!(detect_period(&walk, 1e-3), Ok(None));
}

#[test]
fn exact_bad_records_are_refused() {
    assert_eq!(detect_period(&[1.0; 100], 0.1), Err(SignalError::Constant));
    assert!(matches!(detect_period(&[1.0, 2.0], 0.1), Err(SignalError::TooShort { .. })));
    assert!(matches!(detect_period(&[1.0, f64::NAN, 2.0, 3.0], 0.1), Err(SignalError::NonFinite { index: 1 })));
    assert!(matches!(detect_period(&tones(99, &[[9.0, 1.0, 0.0]]), 0.9), Err(SignalError::Parameter { .. })));
    assert_eq!(find_sinusoids(&[1.0; 100], T, 3, 0.1), Err(SignalError::Constant));
    assert!(matches!(find_sinusoids(&[1.0; 10], T, 3, 0.1), Err(SignalError::TooShort { .. })));
    assert!(matches!(find_sinusoids(&[1.0; 100], -1.0, 3, 0.1), Err(SignalError::SampleTime { .. })));
    assert!(matches!(fit_harmonics(&[1.0; 100], T, 50.0, 3), Err(SignalError::Constant)));
}
