//! Spectra over time, against theory.

use std::f64::consts::TAU;

use signal::excitation::Random;
use signal::spectrum::{SpectrogramBuilder, Welch, power_spectrum, spectrogram};
use signal::window::Window;
use signal::{SignalError, SignalView};

const SAMPLE_TIME_S: f64 = 1e-3;

fn view(samples: &[f64]) -> SignalView<'_> {
    SignalView::new(0.0, SAMPLE_TIME_S, samples).unwrap()
}

fn noise(count: usize) -> Vec<f64> {
    let mut random = Random::new(7);
    (0..count).map(|_| 3.0 + random.normal()).collect()
}

/// A sine on a line has its amplitude there, whatever the window, and a sixth of the lines away nothing.
#[test]
fn exact_a_sine_has_its_amplitude_in_its_line() {
    let x: Vec<f64> = (0..3000).map(|t| 10.0 + 2.5 * (TAU * 0.1 * f64::from(t) + 0.3).sin()).collect();
    for window in [Window::Hann, Window::Rectangular, Window::Hamming] {
        let found = spectrogram(view(&x), Welch { segment: 240, overlap: 120, window }, 6).unwrap();
        for column in &found.columns {
            let amplitudes = found.amplitudes(column);
            assert!((amplitudes[24] - 2.5).abs() < 1e-9, "{window:?}: {}", amplitudes[24]);
            assert!(amplitudes[64] < 1e-9, "{window:?}: {}", amplitudes[64]);
        }
    }
}

/// Without a window and an overlap the densities add up to the mean square about the segments' means (Parseval).
#[test]
fn exact_the_total_power_is_the_mean_square() {
    let x = noise(4000);
    let welch = Welch { segment: 250, overlap: 0, window: Window::Rectangular };
    let found = spectrogram(view(&x), welch, 16).unwrap();
    for (segment, column) in x.chunks(250).zip(&found.columns) {
        let mean = segment.iter().sum::<f64>() / 250.0;
        let square = segment.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 250.0;
        let power = column.iter().sum::<f64>() * found.freq_hz[1];
        assert!((power / square - 1.0).abs() < 1e-9, "{power} instead of {square}");
    }
}

#[test]
fn exact_the_mean_over_time_is_the_spectrum_of_welch() {
    let x = noise(5000);
    for segment in [128, 129] {
        let welch = Welch::half_overlapping(segment);
        let mean = spectrogram(view(&x), welch, 7).unwrap().mean().unwrap();
        let expected = power_spectrum(&x, SAMPLE_TIME_S, welch).unwrap();
        assert_eq!((&mean.freq_hz, &mean.degrees_of_freedom), (&expected.freq_hz, &expected.degrees_of_freedom));
        let largest = mean.density.iter().zip(&expected.density).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        assert!(largest < 1e-9, "{largest}");
    }
}

/// A sine whose frequency rises by 20 Hz a second is found where it is in the middle of each column.
#[test]
fn exact_the_line_follows_a_chirp() {
    let rate_hz_per_s = 20.0;
    let at = |t: f64| (TAU * (50.0 * t + 0.5 * rate_hz_per_s * t * t)).sin();
    let x: Vec<f64> = (0..10_000).map(|k| at(f64::from(k) * SAMPLE_TIME_S)).collect();
    let found = spectrogram(view(&x), Welch::half_overlapping(256), 1000).unwrap();
    assert_eq!(found.segments, [1; 77]);
    for (k, column) in found.columns.iter().enumerate() {
        let line = (0..column.len()).max_by(|a, b| column[*a].total_cmp(&column[*b])).unwrap();
        let middle_s = (k as f64 + 1.0) * 0.128;
        let expected_hz = 50.0 + rate_hz_per_s * middle_s;
        assert!((found.freq_hz[line] - expected_hz).abs() < 4.0, "{} instead of {expected_hz}", found.freq_hz[line]);
    }
}

#[test]
fn exact_a_missing_sample_costs_the_segments_with_it() {
    let mut x = noise(1000);
    let whole = spectrogram(view(&x), Welch::half_overlapping(100), 10).unwrap();
    x[555] = f64::NAN;
    let found = spectrogram(view(&x), Welch::half_overlapping(100), 10).unwrap();
    assert_eq!((whole.left_out, found.left_out), (0, 2));
    assert_eq!(found.segments.iter().sum::<usize>() + 2, whole.segments.iter().sum::<usize>());
    // The two begin at samples 500 and 550.
    assert_eq!(found.columns[..5], whole.columns[..5]);
    let none = spectrogram(view(&[f64::NAN; 200]), Welch::half_overlapping(100), 3).unwrap();
    assert!(none.mean().is_none() && none.columns.iter().flatten().all(|v| v.is_nan()));
}

#[test]
fn exact_pieces_give_the_same_as_the_whole() {
    let (x, welch) = (noise(3000), Welch { segment: 100, overlap: 0, window: Window::Hann });
    let whole = spectrogram(view(&x), welch, 5).unwrap();
    let mut builder = SpectrogramBuilder::new(welch, SAMPLE_TIME_S, 0.0, 3000, 5).unwrap();
    for (k, piece) in x.chunks(700).enumerate() {
        builder.add(SignalView::new(0.7 * k as f64, SAMPLE_TIME_S, piece).unwrap()).unwrap();
    }
    let pieces = builder.finish();
    assert_eq!(pieces.segments, whole.segments);
    assert!(pieces.columns.iter().flatten().zip(whole.columns.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn exact_bands_hold_the_largest_line() {
    let x: Vec<f64> = (0..2000).map(|t| (TAU * 0.105 * f64::from(t)).sin()).collect();
    let found = spectrogram(view(&x), Welch::half_overlapping(200), 4).unwrap();
    let bands = found.bands(250.0, 10);
    // 51 lines of 5 Hz in bands of 6.
    assert_eq!((bands.first_hz, bands.width_hz, bands.levels_db[0].len()), (-2.5, 30.0, 9));
    let largest = 10.0 * found.columns[1][21].log10();
    assert_eq!(bands.levels_db[1][3], largest);
    assert!(bands.levels_db[1].iter().all(|level| *level <= largest || level.is_nan()));
}

#[test]
fn regress_impossible_spectrograms_are_refused() {
    let x = noise(100);
    assert!(spectrogram(view(&x), Welch::half_overlapping(1), 3).is_err());
    assert!(spectrogram(view(&x), Welch::half_overlapping(10), 0).is_err());
    let short = spectrogram(view(&x), Welch::half_overlapping(101), 3);
    assert_eq!(short.unwrap_err(), SignalError::TooShort { needed: 101, got: 100 });
    let wrong = Welch { segment: 10, overlap: 10, window: Window::Hann };
    assert!(matches!(spectrogram(view(&x), wrong, 3), Err(SignalError::Parameter { .. })));
}
