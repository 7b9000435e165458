//! Intervals of nonparametric frequency responses.

use ident::distributions::interval;
use signal::excitation::Random;
use signal::frf::{BlackmanTukey, Etfe, FrequencyResponse, LocalModel};
use signal::spectrum::{Welch, cross_spectrum};

const GAIN: f64 = 2.0;
const LENGTH: usize = 2048;

/// The share of frequencies, but those at the ends, at which the interval of the real part holds the gain.
fn covered(response: &FrequencyResponse) -> f64 {
    let inner = response.freq_hz.len() / 20..response.freq_hz.len() * 19 / 20;
    let holds = |k: usize| {
        let error = (0.5 * response.variance[k]).sqrt();
        let (low, high) = interval(response.response[k].re, error, response.degrees_of_freedom[k], 0.95);
        (low..=high).contains(&GAIN)
    };
    inner.clone().filter(|k| holds(*k)).count() as f64 / inner.len() as f64
}

fn welch(u: &[f64], y: &[f64]) -> FrequencyResponse {
    let cross = cross_spectrum(u, y, 0.01, Welch::half_overlapping(128)).unwrap();
    let (response, variance) = (cross.response_h1(), cross.response_h1_variance());
    let degrees_of_freedom = vec![cross.degrees_of_freedom - 2.0; response.len()];
    FrequencyResponse { freq_hz: cross.freq_hz, outputs: 1, inputs: 1, response, variance, degrees_of_freedom }
}

/// White noise through a constant gain, in white noise: neighbouring frequencies share what they rest on, so that the
/// bounds are those of the records, not of the frequencies.
#[test]
fn stat_intervals_of_every_method_hold_the_response() {
    type Method = (&'static str, fn(&[f64], &[f64]) -> FrequencyResponse);
    let methods: [Method; 5] = [
        ("lpm", |u, y| LocalModel::polynomial(2, 1).estimate(&[u], &[y], 0.01).unwrap().response),
        ("lrm", |u, y| LocalModel::rational(2, 1).estimate(&[u], &[y], 0.01).unwrap().response),
        ("blackman-tukey", |u, y| BlackmanTukey::new(64).estimate(&[u], y, 0.01).unwrap().response),
        ("etfe", |u, y| Etfe { half_width: 5, period: None }.estimate(u, y, 0.01).unwrap()),
        ("welch", welch),
    ];
    for (name, method) in methods {
        let shares: Vec<f64> = (0..40)
            .map(|run| {
                let mut random = Random::new(run);
                let u: Vec<f64> = (0..LENGTH).map(|_| random.normal()).collect();
                let y: Vec<f64> = u.iter().map(|u| GAIN * u + 0.5 * random.normal()).collect();
                covered(&method(&u, &y))
            })
            .collect();
        let mean = shares.iter().sum::<f64>() / shares.len() as f64;
        let scatter = shares.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (shares.len() - 1) as f64;
        let error = (scatter / shares.len() as f64).sqrt();
        assert!((mean - 0.95).abs() < 0.01 + 3.0 * error, "{name}: {mean:.4} ± {error:.4} of 0.95");
    }
}
