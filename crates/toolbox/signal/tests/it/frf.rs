//! Nonparametric frequency responses: bias, honest variances, several inputs, bad input.
#![allow(clippy::print_stdout)]

use std::f64::consts::TAU;

use signal::excitation::Random;
use signal::filter::Section;
use signal::frf::{BlackmanTukey, Etfe, LocalKind, LocalModel, periodic_response, periodic_spectra, suited_response};
use signal::spectrum::{Welch, cross_spectrum};
use signal::{Complex64, SignalError, Sos};

const T: f64 = 0.01;

fn white(random: &mut Random, length: usize, deviation: f64) -> Vec<f64> {
    (0..length).map(|_| deviation * random.normal()).collect()
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

/// Resonance at 12 Hz, damping 0.5 %: it rings for about 2.7 s.
fn resonance() -> Sos {
    let angle = TAU * 12.0 * T;
    let radius = (-0.005 * angle).exp();
    Sos::new(vec![Section { b: [0.0, 0.1, 0.0], a: [-2.0 * radius * angle.cos(), radius * radius] }], T).unwrap()
}

/// Input and output from the middle of a longer run, so that the record starts and ends in motion.
fn record(random: &mut Random, length: usize) -> (Vec<f64>, Vec<f64>) {
    let system = resonance();
    let u = white(random, length + 3000, 1.0);
    let y = system.filter(&u, &mut system.state_at_rest());
    (u[3000..].to_vec(), y[3000..].to_vec())
}

/// Largest error relative to the peak of the response.
fn worst(freq_hz: &[f64], response: &[Complex64]) -> f64 {
    let peak = resonance().response(12.0).norm();
    let error = |(f, g): (&f64, &Complex64)| (g - resonance().response(*f)).norm() / peak;
    freq_hz.iter().zip(response).map(error).fold(0.0, f64::max)
}

#[test]
fn exact_local_models_are_free_of_leakage() {
    let (u, y) = record(&mut Random::new(3), 16_384);
    let rational = LocalModel::rational(2, 1).estimate(&[&u], &[&y], T).unwrap();
    let polynomial = LocalModel::polynomial(4, 1).estimate(&[&u], &[&y], T).unwrap().response;
    let welch = cross_spectrum(&u, &y, T, Welch::half_overlapping(1024)).unwrap();
    let [rational_error, polynomial_error, welch_error] = [
        worst(&rational.response.freq_hz, &rational.response.response),
        worst(&polynomial.freq_hz, &polynomial.response),
        worst(&welch.freq_hz[1..], &welch.response_h1()[1..]),
    ];
    assert!(rational_error < 1e-5 && polynomial_error < 0.01 && welch_error > 0.05);
    assert_eq!(rational.response.freq_hz.len(), 8191);
}

/// The polynomial off the resonance, where it is not biased, the rational at it: the scatter is the variance stated,
/// the noise that put in.
#[test]
fn stat_local_models_state_their_variance() {
    for (kind, at_resonance) in
        [(LocalKind::Polynomial, false), (LocalKind::Rational, true), (LocalKind::Rational, false)]
    {
        let model = LocalModel { kind, order: 2, half_width: 8, transient: true };
        let (mut scatter, mut stated, mut noise, mut count) = (0.0, 0.0, 0.0, 0);
        for seed in 0..100 {
            let mut random = Random::new(seed);
            let (u, y) = record(&mut random, 1024);
            let y = sum(&y, &white(&mut random, 1024, 0.03));
            let found = model.estimate(&[&u], &[&y], T).unwrap();
            let freq_hz = &found.response.freq_hz;
            let wanted = |k: &usize| {
                let distance = (freq_hz[*k] - 12.0).abs();
                if at_resonance { distance < 0.5 } else { distance > 4.0 && k.is_multiple_of(16) }
            };
            for k in (0..freq_hz.len()).filter(wanted) {
                scatter += (found.response.response[k] - resonance().response(freq_hz[k])).norm_sqr();
                stated += found.response.variance[k];
                noise += found.noise_density[k];
                count += 1;
            }
        }
        let (ratio, density) = (scatter / stated, noise / f64::from(count));
        let (low, high) = if kind == LocalKind::Rational { (0.9, 1.6) } else { (0.9, 1.1) };
        assert!(low < ratio && ratio < high, "{kind:?} {ratio}");
        assert!((density / (2.0 * T * 9e-4) - 1.0).abs() < 0.15, "{kind:?} {density}");
    }
}

#[test]
fn exact_local_models_of_two_inputs_and_outputs() {
    let mut random = Random::new(5);
    let (a, b) = (white(&mut random, 3000, 1.0), white(&mut random, 3000, 20.0));
    let filters = [[3.0, 8.0], [15.0, 30.0]].map(|row| row.map(|f| Sos::butterworth_lowpass(2, f, T).unwrap()));
    let through = |filter: &Sos, x: &[f64]| filter.filter(x, &mut filter.state_at_rest());
    let y: Vec<Vec<f64>> = filters.iter().map(|f| sum(&through(&f[0], &a), &through(&f[1], &b))).collect();
    for model in [LocalModel::polynomial(4, 2), LocalModel::rational(2, 2)] {
        let found = model.estimate(&[&a, &b], &[&y[0], &y[1]], T).unwrap().response;
        for (i, row) in filters.iter().enumerate() {
            for (j, filter) in row.iter().enumerate() {
                let pairs = found.response_of(i, j).into_iter().zip(&found.freq_hz);
                let error = pairs.map(|(g, f)| (g - filter.response(*f)).norm()).fold(0.0, f64::max);
                assert!(error < 2e-4, "{:?} {i} {j}: {error}", model.kind);
            }
        }
    }
    assert!(LocalModel::polynomial(2, 2).estimate(&[&a, &a], &[&b], T).is_err());
}

fn multisine(random: &mut Random, period: usize, harmonics: &[usize]) -> Vec<f64> {
    let phases: Vec<f64> = harmonics.iter().map(|_| TAU * random.uniform()).collect();
    let wave = |t: usize, h: usize, p: f64| (TAU * (h * t % period) as f64 / period as f64 + p).cos();
    (0..period).map(|t| harmonics.iter().zip(&phases).map(|(h, p)| wave(t, *h, *p)).sum()).collect()
}

/// Noise on input and output, correlated; the response of a filter in steady state.
#[test]
fn stat_periods_tell_the_noise_on_both_sides() {
    let harmonics: Vec<usize> = (1..40).step_by(2).collect();
    let filter = Sos::butterworth_lowpass(2, 10.0, T).unwrap();
    let (mut scatter, mut stated) = (0.0, 0.0);
    for seed in 0..150 {
        let mut random = Random::new(seed);
        let u = multisine(&mut random, 200, &harmonics).repeat(12);
        let y = filter.filter(&u, &mut filter.state_at_rest());
        let common = white(&mut random, u.len(), 0.5);
        let (u, y) = (sum(&u, &common), sum(&y, &common));
        let (u, y) = (sum(&u, &white(&mut random, u.len(), 0.5)), sum(&y, &white(&mut random, u.len(), 1.0)));
        let spectra = periodic_spectra(&[&u[400..], &y[400..]], 200, T, &harmonics).unwrap();
        assert_eq!((spectra.periods, spectra.mean.len(), spectra.covariance.len()), (10, 40, 80));
        let found = periodic_response(&[spectra], 1).unwrap().response;
        for k in 0..harmonics.len() {
            scatter += (found.response[k] - filter.response(found.freq_hz[k])).norm_sqr();
            stated += found.variance[k];
        }
    }
    let ratio = scatter / stated;
    assert!((ratio - 1.0).abs() < 0.08, "{ratio}");
}

#[test]
fn exact_periodic_response_of_two_inputs_and_realisations() {
    let mut random = Random::new(9);
    let harmonics = [1, 2, 5, 11];
    let [slow, fast] = [5.0, 20.0].map(|f| Sos::butterworth_lowpass(2, f, T).unwrap());
    let steady = |filter: &Sos, x: &[f64]| filter.filter(x, &mut filter.state_at_rest());
    let record = |random: &mut Random, gain: f64| {
        let [a, b] = [0, 1].map(|_| multisine(random, 100, &harmonics).repeat(30));
        let y: Vec<f64> = sum(&steady(&slow, &a), &steady(&fast, &b)).iter().map(|v| gain * v).collect();
        periodic_spectra(&[&a[2700..], &b[2700..], &y[2700..]], 100, T, &harmonics).unwrap()
    };
    let records: Vec<_> = [1.0, 1.0, 1.1, 1.1].map(|gain| record(&mut random, gain)).to_vec();
    let one = periodic_response(&records[..2], 2).unwrap();
    assert!(one.total_variance.is_none());
    for (k, f) in one.response.freq_hz.iter().enumerate() {
        assert!((one.response.response_of(0, 0)[k] - slow.response(*f)).norm() < 1e-9);
        assert!((one.response.response_of(0, 1)[k] - fast.response(*f)).norm() < 1e-9);
        assert!(one.response.variance[k] < 1e-20);
    }
    let both = periodic_response(&records, 2).unwrap();
    let expected = (0.05 * slow.response(both.response.freq_hz[0]).norm()).powi(2);
    assert!((both.total_variance.unwrap()[0] / expected - 1.0).abs() < 1e-6);
    assert!(periodic_response(&records[..3], 2).is_err());
}

#[test]
fn exact_etfe_of_periodic_data() {
    let filter = Sos::butterworth_lowpass(3, 8.0, T).unwrap();
    let u = multisine(&mut Random::new(1), 250, &[1, 3, 4, 10, 60]).repeat(10);
    let y = filter.filter(&u, &mut filter.state_at_rest());
    let found = Etfe { half_width: 0, period: Some(250) }.estimate(&u[1000..], &y[1000..], T).unwrap();
    assert_eq!(found.freq_hz.len(), 5);
    for (g, f) in found.response.iter().zip(&found.freq_hz) {
        assert!((g - filter.response(*f)).norm() < 1e-10);
    }
    assert!(found.variance.iter().all(|v| v.is_nan()));
}

/// 95 % circles hold the response, 90 % intervals the noise density, as often as they say; likewise the smoothed ETFE.
#[test]
fn stat_smoothed_estimates_state_their_variance() {
    let (mut inside, mut noise_inside, mut total) = (0, 0, 0);
    let (mut scatter, mut stated) = (0.0, 0.0);
    let filter = |f: f64| Complex64::cis(-TAU * f * T) + 0.5;
    for seed in 0..300 {
        let mut random = Random::new(seed);
        let u = white(&mut random, 2000, 2.0);
        let noise = white(&mut random, 2000, 0.7);
        let y: Vec<f64> = (1..2000).map(|t| u[t - 1] + 0.5 * u[t] + noise[t]).collect();
        let method = BlackmanTukey { lags: 40, freqs_hz: (1..10).map(|k| 5.0 * f64::from(k)).collect() };
        let found = method.estimate(&[&u[1..]], &y, T).unwrap();
        let intervals = found.noise.interval(0.9).unwrap();
        let smooth = Etfe { half_width: 20, period: None }.estimate(&u[1..], &y, T).unwrap();
        for k in 0..9 {
            let error = (found.response.response[k] - filter(found.response.freq_hz[k])).norm_sqr();
            inside += usize::from(error < 20_f64.ln() * found.response.variance[k]);
            let truth = 2.0 * T * 0.49;
            noise_inside += usize::from(intervals[k][0] < truth && truth < intervals[k][1]);
            total += 1;
            let bin = 100 * (k + 1) - 1;
            scatter += (smooth.response[bin] - filter(smooth.freq_hz[bin])).norm_sqr();
            stated += smooth.variance[bin];
        }
    }
    let [response, noise] = [inside, noise_inside].map(|n| n as f64 / f64::from(total));
    assert!((response - 0.95).abs() < 0.015, "{response}");
    assert!((noise - 0.9).abs() < 0.025, "{noise}");
    assert!((scatter / stated - 1.0).abs() < 0.08, "{}", scatter / stated);
}

#[test]
fn exact_spectral_analysis_of_two_inputs_and_of_none() {
    let mut random = Random::new(2);
    let (a, b) = (white(&mut random, 50_000, 1.0), white(&mut random, 50_000, 3.0));
    let y: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 2.0 * a - 0.5 * b).collect();
    let found = BlackmanTukey::new(20).estimate(&[&a, &b], &y, T).unwrap();
    for (k, values) in found.response.response.chunks(2).enumerate() {
        assert!((values[0] - 2.0).norm() < 1e-9 && (values[1] + 0.5).norm() < 1e-9, "{k}");
        assert!(found.noise.density[k] < 1e-9);
    }
    let alone = BlackmanTukey::new(20).estimate(&[], &a, T).unwrap();
    assert_eq!((alone.response.inputs, alone.noise.density.len()), (0, 128));
    assert!(alone.noise.density.iter().all(|p| (p / (2.0 * T) - 1.0).abs() < 0.15));
}

#[test]
fn exact_bad_records_are_refused() {
    let (u, mut y) = record(&mut Random::new(1), 200);
    let model = LocalModel::polynomial(2, 1);
    assert!(matches!(model.estimate(&[], &[&y], T), Err(SignalError::TooShort { .. })));
    assert!(matches!(model.estimate(&[&u[1..]], &[&y], T), Err(SignalError::LengthMismatch { .. })));
    assert!(matches!(model.estimate(&[&u[..20]], &[&y[..20]], T), Err(SignalError::TooShort { .. })));
    assert!(matches!(model.estimate(&[&vec![1.0; 200]], &[&y], T), Err(SignalError::NotExcited { .. })));
    let narrow = LocalModel { half_width: 2, ..model };
    assert!(matches!(narrow.estimate(&[&u], &[&y], T), Err(SignalError::Parameter { .. })));
    assert!(matches!(Etfe::default().estimate(&[0.0; 200], &y, T), Err(SignalError::NotExcited { .. })));
    assert!(matches!(Etfe::default().estimate(&[], &[], T), Err(SignalError::TooShort { .. })));
    let tukey = BlackmanTukey::new(20);
    assert!(matches!(tukey.estimate(&[&[1.0; 200]], &y, T), Err(SignalError::NotExcited { .. })));
    assert!(matches!(tukey.estimate(&[&u], &y, 0.0), Err(SignalError::SampleTime { .. })));
    assert!(matches!(BlackmanTukey::new(500).estimate(&[&u], &y, T), Err(SignalError::TooShort { .. })));
    assert!(matches!(periodic_spectra(&[&u], 101, T, &[]), Err(SignalError::TooShort { .. })));
    assert!(matches!(periodic_spectra(&[&u], 50, T, &[25]), Err(SignalError::Parameter { .. })));
    assert!(matches!(periodic_response(&[], 1), Err(SignalError::TooShort { .. })));
    y[7] = f64::NAN;
    assert!(matches!(model.estimate(&[&u], &[&y], T), Err(SignalError::NonFinite { index: 7 })));
    assert!(matches!(periodic_spectra(&[&y], 50, T, &[]), Err(SignalError::NonFinite { .. })));
}

/// Resonance at 8 Hz with this damping, over a zero, and its gain at the top.
fn resonance_at_8_hz(damping: f64) -> (Sos, f64) {
    let angle = TAU * 8.0 * T;
    let radius = (-damping * angle).exp();
    let section = Section {
        b: [0.0, 1.0, 0.4],
        a: [-2.0 * radius * (angle * (1.0 - damping * damping).sqrt()).cos(), radius * radius],
    };
    let system = Sos::new(vec![section], T).unwrap();
    let top = (700..900).map(|k| system.response(0.01 * f64::from(k)).norm()).fold(0.0, f64::max);
    (system, top)
}

/// The record of a resonance with noise of a tenth of the output, which remembers each sample by four fifths.
fn resonant(damping: f64, length: usize, seed: u64) -> (Vec<f64>, Vec<f64>, Sos, f64) {
    let (system, top) = resonance_at_8_hz(damping);
    let mut random = Random::new(seed);
    let u = white(&mut random, length + 3000, 1.0);
    let clean = system.filter(&u, &mut system.state_at_rest());
    let size = (clean[3000..].iter().map(|y| y * y).sum::<f64>() / length as f64).sqrt();
    let mut noise = 0.0;
    let mut next = || {
        noise = 0.8 * noise + 0.6 * 0.1 * size * random.normal();
        noise
    };
    let y = clean[3000..].iter().map(|y| y + next()).collect();
    (u[3000..].to_vec(), y, system, top)
}

/// Local polynomials flatten a resonance that is narrower than their window.
#[test]
fn regress_a_narrow_resonance_is_followed() {
    for (damping, length) in [(0.005, 4000), (0.05, 400)] {
        let (mut within, mut all) = (0, 0);
        for seed in 0..20 {
            let (u, y, system, _) = resonant(damping, length, seed);
            let found = suited_response(&[&u], &y, T).unwrap();
            assert_eq!(found.kind, LocalKind::Rational, "{damping} {seed}");
            assert!((found.missed_hz.unwrap() - 8.0).abs() < 1.5, "{damping} {seed}: {:?}", found.missed_hz);
            let response = &found.estimate.response;
            for (freq_hz, (low, high)) in response.freq_hz.iter().zip(response.magnitude_interval(0, 0, 0.95)) {
                if (freq_hz - 8.0).abs() < 0.6 {
                    let truth = system.response(*freq_hz).norm();
                    (all, within) = (all + 1, within + usize::from(low <= truth && truth <= high));
                }
            }
        }
        println!("{damping} {length}: {within} of {all}");
        assert!(within as f64 > 0.88 * all as f64, "{damping} {length}: {within} of {all}");
    }
}

/// Where polynomials follow the response they remain.
#[test]
fn stat_smooth_responses_keep_their_polynomials() {
    let mut false_alarms = 0;
    for seed in 500..800 {
        let mut random = Random::new(seed);
        let length = [300, 600, 1200][seed as usize % 3];
        let low = Sos::butterworth_lowpass(2, 20.0, T).unwrap();
        let u = white(&mut random, length + 500, 1.0);
        let clean = low.filter(&u, &mut low.state_at_rest());
        let y: Vec<f64> = clean[500..].iter().map(|y| y + 0.1 * random.normal()).collect();
        false_alarms += usize::from(suited_response(&[&u[500..]], &y, T).unwrap().missed_hz.is_some());
    }
    println!("{false_alarms} of 300");
    assert!(false_alarms <= 6, "{false_alarms}");
}
